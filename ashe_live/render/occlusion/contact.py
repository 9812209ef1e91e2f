"""Contact: the share of the sky that the model hides from the ground around it, and from which side it does.

It is a shadow even without any sun, and where the model's sides are lit it is where their light falls.
"""

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.adding import draw_added

PATCH_SIZE = 104  # texels a side
BLUR_TEXELS = 1.5  # of a Gaussian that merges the single directions' shadows
LEAST_BLUR_TEXELS = 0.1  # which changes nothing: OpenCV chooses a blur of its own for none
REACH_HEIGHTS = 1.0  # how far the patch goes beyond the model's bounds, in heights of the model
MIN_HEIGHT_RATIO = 0.1  # of the model's width: a flat model still has a patch
FADE = 0.2  # share of the patch's side along which the darkening ends


class ContactPatch:
    """A texture of the ground around a model: hidden share of the sky, and its mean direction's x and y times that."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, model: GpuModel) -> None:
        lower, upper = model.placed.bounds
        reach = REACH_HEIGHTS * max(upper[2], MIN_HEIGHT_RATIO * float((upper - lower)[:2].max()))
        # (2, 2) least, largest x, y; metres, marker frame
        self.bounds: Float = np.array([lower[:2] - reach, upper[:2] + reach])
        texel = float((self.bounds[1] - self.bounds[0]).max()) / PATCH_SIZE
        # No wider than the model is high: beside what is flat nothing is hidden.
        self._blur_texels = float(np.clip(upper[2] / texel, LEAST_BLUR_TEXELS, BLUR_TEXELS))
        self._ctx = ctx
        self._programs = programs
        self._rectangle: moderngl.VertexArray | None = None
        self._texture = ctx.texture((PATCH_SIZE, PATCH_SIZE), 4, dtype="f2")
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer([self._texture])
        self._framebuffer.clear()

    def add(self, depth_map: ShadowMaps, weight: float) -> None:
        """Adds what the model hides of the directions, above the horizon, from which `depth_map` shows it.

        weight: of a direction straight above, as a share of the sky; others have it times their sine.
        """
        program = self._programs.get("contact", **depth_map.constants)
        depth_map.bind(program)
        # All patches share one program: another may have used it between two steps.
        set_uniforms(program, weight=weight, patch_bounds=tuple(self.bounds.ravel()))
        if self._rectangle is None:
            self._rectangle = self._ctx.vertex_array(program, [])
        draw_added(self._ctx, self._framebuffer, self._rectangle)

    def smoothed(self) -> NDArray[np.float16]:
        """(PATCH_SIZE, PATCH_SIZE, 4) what was added, once every direction was."""
        occlusion = np.frombuffer(self._texture.read(), dtype=np.float16).reshape(PATCH_SIZE, PATCH_SIZE, 4)
        return cv2.GaussianBlur(occlusion.astype(np.float32), (0, 0), self._blur_texels).astype(np.float16)

    def fill(self, smooth: NDArray[np.float16]) -> None:
        """Has it hold what `smoothed` gave."""
        self._texture.write(np.ascontiguousarray(smooth))

    def bind(self, program: moderngl.Program) -> None:
        """Gives `program` the patch and where it is."""
        self._texture.use(UNIT_OF["contact"])
        set_uniforms(program, patch_bounds=tuple(self.bounds.ravel()))

    def release(self) -> None:
        for held in (self._framebuffer, self._texture, self._rectangle):
            if held is not None:
                held.release()
