"""The model's depth as the light sees it, fitted to the model and drawn anew only when model or light change.

Lance Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978. The frustum depends on the model and the
light alone, so the shadow's edges stand still while the camera moves.
"""

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import light_view, orthographic, transform_points
from ashe_live.render.geometry import GpuModel
from ashe_live.render.programs import set_uniforms

# A side never narrower than this share of the longest: a flat model seen edge on still has a map.
MIN_EXTENT_RATIO = 1e-3

UNIT_FROM_CLIP: Float = np.array([[0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5], [0, 0, 0, 1]])


class ShadowMap:
    """One directional light's depth map of `size` texels a side, to be filtered with `pcf_radius`."""

    def __init__(self, ctx: moderngl.Context, program: moderngl.Program, size: int, pcf_radius: int) -> None:
        self.renders = 0
        self.texel_m = 0.0  # the larger side of a texel across the light, metres
        self._size = size
        # Empty texels at the border: what lies outside the map is lit.
        self._margin = pcf_radius + 2
        self._ctx = ctx
        self._program = program
        self._texture = ctx.depth_texture((size, size))
        self._texture.compare_func = "<="
        self._texture.filter = moderngl.LINEAR, moderngl.LINEAR
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = ctx.framebuffer(depth_attachment=self._texture)
        self._content: tuple[GpuModel, bytes] | None = None
        self._shadow_from_marker = np.eye(4)

    def render(self, model: GpuModel, to_light: Float) -> None:
        """Draws the map for a unit direction (3,) in the marker frame, unless it holds that already."""
        content = (model, to_light.tobytes())
        if self._content is not None and self._content[0] is model and self._content[1] == content[1]:
            return
        clip_from_marker = self._fitted(model.points, to_light)
        self._shadow_from_marker = UNIT_FROM_CLIP @ clip_from_marker
        self._framebuffer.use()
        self._framebuffer.clear(depth=1.0)
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        set_uniforms(self._program, clip_from_marker=clip_from_marker)
        model.render_depth()
        self._content = content
        self.renders += 1

    def bind(self, program: moderngl.Program, unit: int) -> None:
        """Gives `program` what shadow.glsl reads."""
        self._texture.use(unit)
        set_uniforms(
            program,
            shadow_map=unit,
            shadow_from_marker=self._shadow_from_marker,
            shadow_map_size=float(self._size),
        )

    def forget(self) -> None:
        """Drops the reference to the model that was drawn last."""
        self._content = None

    def release(self) -> None:
        self.forget()
        self._framebuffer.release()
        self._texture.release()

    def _fitted(self, points: Float, to_light: Float) -> Float:
        """(4, 4) light's clip space from the marker frame, as tight as the margin allows."""
        view = light_view(to_light)
        seen = transform_points(view, points)
        lower, upper = seen.min(axis=0), seen.max(axis=0)
        centre, extent = (lower + upper) / 2, upper - lower
        extent = np.maximum(extent, MIN_EXTENT_RATIO * extent.max())
        extent *= self._size / (self._size - 2 * self._margin)
        self.texel_m = float(extent[:2].max()) / self._size
        return orthographic(centre - extent / 2, centre + extent / 2) @ view
