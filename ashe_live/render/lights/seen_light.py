"""The irradiances of an illumination, with what the picture shows that it was seen in: white, and the open sky."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination
from ashe_live.render.camera.white import light_on_print, white_of
from ashe_live.render.lights.lighting import RGB, Lighting, lighting_of
from ashe_live.render.lights.open_sky import open_sky
from ashe_live.render.lights.shadow_colour import steadied


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
