"""Steadies the colour of shadows in channels in which the ground that they were measured on is dark.

A shadow's ratio is a property of the light, and is the same on paper and on terracotta. But in a channel in which the
ground is dark, shadow and lit ground differ by less than the light that a lens scatters, and their ratio is noise.
"""

from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination, Light

# Light that a lens scatters into a shadow, linear, over the display's white: 1 % of a ground of 0.2.
UNCERTAIN = 0.002
# Standard deviation of the logarithm of a channel's ratio about the others': shadows are about as much bluer under a
# blue sky.
SPREAD = 0.3


def steadied(illumination: Illumination) -> tuple[tuple[Light, ...], Float | None]:
    """The lights and the ambient ratio (3,), towards one for all channels where the ground shows too little."""
    ground, ambient = illumination.ground_rgb, illumination.ambient_rgb_ratio
    if ground is None:
        return illumination.lights, ambient
    lights = tuple(
        light
        if light.shadow_rgb_ratio is None
        else replace(light, shadow_rgb_ratio=steadied_ratio(light.shadow_rgb_ratio, ground))
        for light in illumination.lights
    )
    return lights, None if ambient is None else steadied_ratio(ambient, ground)


def steadied_ratio(ratio: Float, ground_rgb: Float) -> Float:
    """(3,) the likeliest ratios, of measured ones on ground of such a linear colour in the picture.

    Logarithms are normal: the measured with its variance about the true one, and that with SPREAD about a common one.
    """
    known = np.clip(ratio, 1e-3, 1.0)
    logs = np.log(known)
    variance = np.square(UNCERTAIN / np.maximum(ground_rgb * known, 1e-6))
    weights = 1 / (variance + SPREAD**2)
    common = float((weights * logs).sum() / weights.sum())
    share = SPREAD**2 / (SPREAD**2 + variance)
    return np.asarray(np.exp(common + share * (logs - common)), np.float64)
