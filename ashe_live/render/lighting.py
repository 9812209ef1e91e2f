"""How a light estimate shades: sky and sun, balanced as the real shadow was measured."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.types import DirectionalLight

RGB = tuple[float, float, float]

# Shadowed over lit ground where it was not measured: a clear noon's sky gives about this share.
ASSUMED_SHADOW_RATIO = 0.4
# A sun this low lights level ground too little to be balanced by its strength alone.
MIN_BALANCED_SINE = 0.2
# What ordinary ground sends back of the light that falls on it.
GROUND_ALBEDO = 0.35
OVERHEAD: Float = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Lighting:
    """Irradiances over pi, in units of what fully lit level ground gets: white there has radiance 1."""

    to_light: Float  # (3,) unit, marker frame
    has_sun: bool
    sky: RGB  # on level ground; the same as the shadow's ratio where there is a sun
    sun: RGB  # across its direction
    bounce: RGB  # from the ground, on a surface that faces it


def lighting_of(light: DirectionalLight | None) -> Lighting:
    """Sky and sun from the shadow's ratio r: the sky gives r of level ground's light, the sun 1 - r.

    Without a light, or with one below the horizon, the sky gives all: no sun is invented.
    """
    if light is None or light.to_light_marker[2] <= 0:
        return Lighting(OVERHEAD, False, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), _rgb(np.full(3, GROUND_ALBEDO)))
    measured = light.shadow_rgb_ratio
    ratio = np.full(3, ASSUMED_SHADOW_RATIO) if measured is None else np.clip(measured, 0.0, 1.0)
    sine = float(light.to_light_marker[2])
    sun = (1 - ratio) / max(sine, MIN_BALANCED_SINE)
    level = ratio + sun * sine
    return Lighting(light.to_light_marker, True, _rgb(ratio), _rgb(sun), _rgb(GROUND_ALBEDO * level))


def _rgb(values: Float) -> RGB:
    red, green, blue = (float(value) for value in values)
    return red, green, blue
