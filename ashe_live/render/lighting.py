"""Sky and sun irradiances for shading, from the measured ratios of the real shadows."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.types import Light

RGB = tuple[float, float, float]

MAX_LIGHTS = 4
# Of shadowed over lit ground where it was not measured: about the share of a clear sky at noon.
ASSUMED_SHADOW_RATIO = 0.4
SUN_ANGULAR_SIZE_RAD = math.radians(0.53)
# Below this sine of the elevation a sun's irradiance is no longer raised to match its share on level ground.
MIN_BALANCED_SINE = 0.2
LEAST_REST = 0.5  # of the product of the shadows' ratios
LEAST_NEARER = 0.4  # of the light's elevation above its own radius; lower lights' penumbrae are cut off
# The albedo of ground whose colour is not known, and the largest that is accepted.
GROUND_ALBEDO = 0.35
MAX_ALBEDO = 0.9


@dataclass(frozen=True, slots=True, eq=False)
class Sun:
    """One directional light. Units as in Lighting."""

    to_light: Float  # (3,) unit, marker frame, above the horizon
    ground_share: RGB  # share of the light on level ground, which its shadow takes away
    irradiance: RGB  # on a surface that faces it
    angular_size_rad: float  # diameter

    def penumbra_m(self, height_m: float) -> float:
        """Width, across the light, of the outer half of the penumbra on the ground of a point `height_m` above it."""
        sine = float(self.to_light[2])
        spread = math.tan(self.angular_size_rad / 2)
        # Outwards it falls on ground that is farther away; under a light that reaches down to the horizon, for ever.
        nearer = 1 - spread * math.sqrt(1 - min(sine, 1.0) ** 2) / sine
        return spread * height_m / sine / max(nearer, LEAST_NEARER)


@dataclass(frozen=True, slots=True, eq=False)
class Lighting:
    """Irradiances over pi, in units in which fully lit level ground receives 1, so that white ground has radiance 1."""

    suns: tuple[Sun, ...]  # strongest first, MAX_LIGHTS at most
    sky: RGB  # on level ground; with the suns' shares it makes 1
    bounce: RGB  # from the ground, on a surface that faces it

    @property
    def irradiances(self) -> Float:
        """(n, 3) of the suns, on surfaces that face them."""
        return np.array([sun.irradiance for sun in self.suns])

    @property
    def ground_shares(self) -> Float:
        """(n, 3) shares of the suns in the light on level ground."""
        return np.array([sun.ground_share for sun in self.suns])


def lighting_of(
    lights: tuple[Light, ...],
    ambient_rgb_ratio: Float | None = None,
    ground_albedo: Float | None = None,
) -> Lighting:
    """Sky and suns from the shadows' ratios: a light whose shadow has the ratio r gives 1 - r of level ground's light.

    Where ratios and ambient (3,) contradict each other, the ambient holds and the suns share the rest. Lights below
    the horizon give nothing; without any the sky gives all: no sun is invented. What a surface gets from below is the
    ground's own light, of its own colour (3,).
    """
    albedo = np.full(3, GROUND_ALBEDO) if ground_albedo is None else np.clip(ground_albedo, 0.0, MAX_ALBEDO)
    lights = tuple(light for light in lights if light.to_light_marker[2] > 0)[:MAX_LIGHTS]
    if not lights:
        return Lighting((), (1.0, 1.0, 1.0), _rgb(albedo))
    shares = np.array([_ground_share(light, len(lights)) for light in lights])
    total = shares.sum(axis=0)
    # Shares that sum to more than 1 were measured wrongly; the product of the shadows' ratios bounds what is left.
    rest = np.maximum(1 - total, LEAST_REST * (1 - shares).prod(axis=0))
    sky = np.clip(rest if ambient_rgb_ratio is None else ambient_rgb_ratio, 0.0, 1.0)
    shares *= np.divide(1 - sky, total, out=np.zeros(3), where=total > 0)
    sines = np.array([light.to_light_marker[2] for light in lights])
    across = shares / np.maximum(sines, MIN_BALANCED_SINE)[:, None]
    level = sky + sines @ across
    suns = tuple(
        Sun(light.to_light_marker, _rgb(share), _rgb(irradiance), light.angular_size_rad or SUN_ANGULAR_SIZE_RAD)
        for light, share, irradiance in zip(lights, shares, across, strict=True)
    )
    return Lighting(suns, _rgb(sky), _rgb(albedo * level))


def _ground_share(light: Light, count: int) -> Float:
    """(3,) share of one of `count` lights in the light on level ground."""
    if light.shadow_rgb_ratio is None:
        return np.full(3, (1 - ASSUMED_SHADOW_RATIO) / count)
    return 1 - np.clip(light.shadow_rgb_ratio, 0.0, 1.0)


def _rgb(values: Float) -> RGB:
    red, green, blue = (float(value) for value in values)
    return red, green, blue
