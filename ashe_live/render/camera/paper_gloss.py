"""The gloss of printed paper: opposite a light, paper and ink are brighter than their albedo."""

import math
from collections.abc import Iterable

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.render.lights.lighting import LEAST_LAMP_DISTANCE, ShadingLight

MIRRORED = 0.04  # of light that falls straight on paper or toner, whose refractive index is 1.5; as in model/glass.glsl
# GGX, perceptual: of uncoated paper, a broad sheen. Chosen on rendered pictures (docs/rendering/light.md).
ROUGHNESS = 0.7


def mirrored_by_paper(lights: Iterable[ShadingLight], to_eye: Float, place: Float) -> Float:
    """(3,) radiance of level paper at `place` (3,), metres, marker frame, by what it mirrors of the lights.

    Beyond the part of even light that paper mirrors, which albedos include. White in the light at the marker's centre
    has 1. `to_eye`: (3,) unit.
    """
    mirrored = np.zeros(3)
    for light in lights:
        (towards,) = light.towards(place[None])
        distance = max(float(np.linalg.norm(towards)), LEAST_LAMP_DISTANCE)
        excess = max(0.0, _brdf(to_eye, towards / distance) - MIRRORED)
        mirrored += np.array(light.irradiance) * (excess * max(float(towards[2]), 0.0) / distance**3)
    return mirrored


def _brdf(to_eye: Float, to_light: Float) -> float:
    """GGX with Schlick's Fresnel factor, times pi, of a surface that faces +z (model/brdf.glsl)."""
    between = to_eye + to_light
    between /= max(float(np.linalg.norm(between)), 1e-9)
    n_v, n_l, n_h = max(float(to_eye[2]), 1e-3), max(float(to_light[2]), 1e-3), float(between[2])
    a2 = ROUGHNESS**4
    distribution = a2 / ((n_h * a2 - n_h) * n_h + 1) ** 2
    visibility = 0.5 / (n_l * math.sqrt(n_v**2 * (1 - a2) + a2) + n_v * math.sqrt(n_l**2 * (1 - a2) + a2))
    grazing = (1 - max(float(to_eye @ between), 0.0)) ** 5
    return distribution * visibility * (MIRRORED + (1 - MIRRORED) * grazing)
