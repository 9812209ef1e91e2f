"""The irradiances of an illumination, with what the picture shows that it was seen in: white, and the open sky."""

from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination, Light
from ashe_live.render.camera.white import light_on_print, white_of
from ashe_live.render.lights.lighting import RGB, Lighting, lighting_of
from ashe_live.render.lights.open_sky import open_sky

# Light that a lens scatters into a shadow, linear, over the display's white: 1 % of a ground of 0.2.
SCATTERED = 0.002
# Standard deviation of the logarithm of a channel's ratio about the others': shadows are about as much bluer under a
# blue sky.
RATIO_SPREAD = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class SeenLight:
    """An illumination in the frame of the marker as it lay in the picture it was seen in, and what is read there."""

    lighting: Lighting
    ambient: Float | None  # (3,) as Illumination.ambient_rgb_ratio, of the open sky
    albedo: Float | None  # (3,) of the ground
    white_rgb: RGB | None  # that white, fully lit, has in it

    @staticmethod
    def of(illumination: Illumination) -> "SeenLight":
        """Reads the picture, if there is one, which must have a marker."""
        seen_in, body, ground_rgb = illumination.seen_in, illumination.real_object, illumination.ground_rgb
        lights, ambient = steadied(illumination)
        albedo = white_rgb = None
        if seen_in is not None:
            white_rgb = white_of(seen_in, light_on_print(seen_in, lighting_of(lights, ambient), body))
        if ground_rgb is not None and seen_in is not None and white_rgb is not None:
            white = np.array(white_rgb)
            albedo = ground_rgb / white
            if body is not None and _was_seen_in_shadow(illumination):
                ambient = open_sky(seen_in, body, lighting_of(lights, ambient, albedo), white)
        return SeenLight(lighting_of(lights, ambient, albedo, illumination.sky_slope_rgb), ambient, albedo, white_rgb)

    def lighting_now(self, illumination: Illumination) -> Lighting:
        """The irradiances of `illumination`, whose `as_read` this is: by another place of the marker, or by hand."""
        lights, ambient = steadied(illumination)
        before = None if illumination.as_read is None else illumination.as_read.ambient_rgb_ratio
        if self.ambient is not None and before is not None and illumination.ambient_rgb_ratio is not None:
            # On a tilted sheet it is another share of all light.
            ambient = self.ambient * illumination.ambient_rgb_ratio / np.maximum(before, 1e-6)
        return lighting_of(lights, ambient, self.albedo, illumination.sky_slope_rgb)


def lighting_in(illumination: Illumination) -> Lighting:
    """The irradiances with which a model is drawn in an illumination; `Photometry` keeps them."""
    if illumination.as_read is None:
        return SeenLight.of(illumination).lighting
    return SeenLight.of(illumination.as_read).lighting_now(illumination)


def _was_seen_in_shadow(illumination: Illumination) -> bool:
    """Whether the sky's share is that which was read in the shadow of the real object, in one light.

    A known body's answer is that of the open sky, and a lamp's intensity says what the sky has at the marker's centre.
    """
    assert illumination.seen_in is not None
    is_read = [
        light.shadow_rgb_ratio is not None and light.intensity_rgb_ratio is None and light.to_light_marker[2] > 0
        for light in illumination.lights
    ]
    return is_read == [True] and illumination.seen_in.pose.body is None


def steadied(illumination: Illumination) -> tuple[tuple[Light, ...], Float | None]:
    """The lights and the ambient ratio (3,), towards one for all channels where the ground shows too little.

    A shadow's ratio is a property of the light, and is the same on paper and on terracotta. But in a channel in which
    the ground is dark, shadow and lit ground differ by less than the light that a lens scatters, and their ratio is
    noise.
    """
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

    Logarithms are normal: the measured with its variance about the true one, and that with RATIO_SPREAD about a common
    one.
    """
    known = np.clip(ratio, 1e-3, 1.0)
    logs = np.log(known)
    variance = np.square(SCATTERED / np.maximum(ground_rgb * known, 1e-6))
    weights = 1 / (variance + RATIO_SPREAD**2)
    common = float((weights * logs).sum() / weights.sum())
    share = RATIO_SPREAD**2 / (RATIO_SPREAD**2 + variance)
    return np.asarray(np.exp(common + share * (logs - common)), np.float64)
