"""Contact: the share of the sky that the model hides from the ground around it, and from which side it does.

It is a shadow even without any sun, and where the model's sides are lit it is where their light falls.

Ambient occlusion by its definition: the mean of the shadows that many lights spread over the sky would cast, each
with the weight of its cosine (Langer and Buelthoff, "Depth discrimination from shading under diffuse lighting", 2000).
Drawn once a model, a direction at a time; of one that moves each in another pose, so that it is the mean over them.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.preset import FAST
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.lighting import Lighting, Sun
from ashe_live.render.lights.shadow_maps import ShadowMaps

DIRECTIONS = 48
DEPTHS = replace(FAST, shadow_map_size=128, soft_on_model=False, pcf_radius=1)
PATCH_SIZE = 96  # texels a side
BLUR_TEXELS = 1.5  # of a Gaussian that merges the single directions' shadows
REACH_HEIGHTS = 0.75  # how far the patch goes beyond the model's bounds, in heights of the model
MIN_HEIGHT_RATIO = 0.1  # of the model's width: a flat model still has a patch
NO_LIGHT = (0.0, 0.0, 0.0)
FADE = 0.3  # share of the patch's side along which the darkening ends


class ContactPatch:
    """A texture of the ground around a model: hidden share of the sky, and its mean direction's x and y times that."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, model: GpuModel) -> None:
        lower, upper = model.placed.bounds
        reach = REACH_HEIGHTS * max(upper[2], MIN_HEIGHT_RATIO * float((upper - lower)[:2].max()))
        # (2, 2) least, largest x, y; metres, marker frame
        self.bounds: Float = np.array([lower[:2] - reach, upper[:2] + reach])
        self._ctx = ctx
        self._model = model
        self._depth_map = ShadowMaps(ctx, DEPTHS)
        self._program = programs.get("contact", **self._depth_map.constants | {"lights": 1, "casters": 1})
        self._rectangle = ctx.vertex_array(self._program, [])
        self._texture = ctx.texture((PATCH_SIZE, PATCH_SIZE), 4, dtype="f2")
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer([self._texture])

    def draw(self) -> Iterator[None]:
        """Draws the patch of a model that is uploaded, a direction each step."""
        self._framebuffer.clear()
        duration_s = self._model.placed.model.duration_s
        for number, direction in enumerate(sky_directions(DIRECTIONS)):
            self._model.pose(duration_s * number / DIRECTIONS)
            light = Sun(direction, NO_LIGHT, NO_LIGHT, 0.0)
            self._depth_map.render((self._model,), Lighting((light,), NO_LIGHT, NO_LIGHT))
            self._depth_map.bind(self._program)
            # All patches share one program: another may have used it between two steps.
            set_uniforms(self._program, weight=1.0 / DIRECTIONS, patch_bounds=tuple(self.bounds.ravel()))
            self._framebuffer.use()
            self._ctx.enable_only(moderngl.BLEND)
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE
            self._rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
            yield
        self._depth_map.release()
        occlusion = np.frombuffer(self._texture.read(), dtype=np.float16).reshape(PATCH_SIZE, PATCH_SIZE, 4)
        smooth = cv2.GaussianBlur(occlusion.astype(np.float32), (0, 0), BLUR_TEXELS)
        self._texture.write(np.ascontiguousarray(smooth, dtype=np.float16))

    def bind(self, program: moderngl.Program) -> None:
        """Gives `program` the patch and where it is."""
        self._texture.use(UNIT_OF["contact"])
        set_uniforms(program, patch_bounds=tuple(self.bounds.ravel()))

    def release(self) -> None:
        self._depth_map.release()
        for held in (self._framebuffer, self._texture, self._rectangle):
            held.release()


def sky_directions(count: int) -> Float:
    """(count, 3) unit vectors above the plane whose density follows the cosine to z; a golden-angle spiral."""
    share = (np.arange(count) + 0.5) / count
    azimuth = np.arange(count) * (math.pi * (3 - math.sqrt(5)))
    flat = np.sqrt(share)
    return np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sqrt(1 - share)])
