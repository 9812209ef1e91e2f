"""The real object's proxy: it occludes what is behind it, casts its shadow, and receives the model's."""

from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.models.assembly.shading_normals import corner_normals
from ashe_live.render.gl.framing import Framing
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.lights.ground_shadows import GroundShadows
from ashe_live.render.lights.lighting import Lighting
from ashe_live.render.lights.seen.shadow_maps import SeenShadowMaps
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.drawn_body_maker import ReadBody

GL_DEPTH_CLAMP = 0x864F


class RealObject:
    """A proxy on the graphics card, which is a ShadowCaster.

    It casts the shadows of the body as it was fitted, with which the shadow in the picture agrees; on the ground they
    are where the picture clearly shows them. It is drawn where the object's outline is.
    """

    is_clear = False

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: Programs,
        proxy: Proxy,
        seen_in: TrackedFrame | None,
        read: ReadBody,
    ) -> None:
        """`seen_in`: a frame that shows the object where the proxy stands. `read`: what it says of it."""
        self.proxy, self.seen_in = proxy, seen_in
        self.points, triangles = proxy.surface()
        self.drawn_points, drawn_triangles = read.surface
        self._programs = programs
        self._ctx = ctx
        self._casting = _Surface(ctx, self.points, triangles)
        self._drawn = _Surface(ctx, *_creased(self.drawn_points, drawn_triangles))
        self.seen_shadows = SeenShadowMaps(ctx, read.shadows)

    def render_depth(self, clip_from_marker: Float) -> None:
        program = self._programs.get("lights/depth")
        set_uniforms(program, clip_from_marker=clip_from_marker)
        self._casting.array(program).render()

    def draw(
        self,
        framing: Framing,
        lighting: Lighting,
        shadows: ShadowMaps,
        ground_shadows: GroundShadows,
        is_shaded: bool = True,
    ) -> None:
        """Draws its depth and, where the model shades it, the fraction of light that it loses.

        `is_shaded`: whether models cast shadows.
        """
        program = self._programs.get("lights/depth")
        is_shaded = is_shaded and shadows.model_shades_real
        if is_shaded:
            casters = {"casters": shadows.group_count + 1}  # itself is the last one
            program = self._programs.get("catchers/real_object", **shadows.constants | casters)
            shadows.bind(program)
            ground_shadows.bind(program)
            set_uniforms(
                program,
                sky=lighting.sky,
                ground_bounce=lighting.bounce,
                light_ground_share=lighting.ground_shares,
                light_irradiance=lighting.irradiances,
            )
        set_uniforms(program, clip_from_marker=framing.clip_from_marker)
        self._ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        # Near and far enclose the model and its shadow; the object may stand before and behind both.
        self._ctx.enable_direct(GL_DEPTH_CLAMP)
        framebuffer = self._ctx.fbo
        framebuffer.color_mask = _for_both_layers(is_shaded)
        framebuffer.use()
        self._drawn.array(program).render()
        framebuffer.color_mask = _for_both_layers(True)
        framebuffer.use()
        self._ctx.disable_direct(GL_DEPTH_CLAMP)

    def draw_silhouette(self, framing: Framing) -> None:
        """Draws 1 wherever it is in the picture into the framebuffer that is bound, whatever is in front of it."""
        program = self._programs.get("catchers/silhouette")
        set_uniforms(program, clip_from_marker=framing.clip_from_marker)
        self._ctx.enable_only(moderngl.CULL_FACE)
        self._ctx.enable_direct(GL_DEPTH_CLAMP)
        self._drawn.array(program).render()
        self._ctx.disable_direct(GL_DEPTH_CLAMP)

    def release(self) -> None:
        self._casting.release()
        self._drawn.release()
        self.seen_shadows.release()


class _Surface:
    """Triangles on the graphics card."""

    def __init__(
        self, ctx: moderngl.Context, points: Float, triangles: NDArray[np.uint32], normals: Float32 | None = None
    ) -> None:
        """`points`: (n, 3), metres, marker frame. `normals`: (n, 3) unit, of these, for programs that take them."""
        self._ctx = ctx
        vertices = points if normals is None else np.concatenate([points, normals], axis=1)
        self._has_normals = normals is not None
        # A mesh's arrays may lie in memory in any order.
        self._vertices = ctx.buffer(np.ascontiguousarray(vertices, np.float32))
        self._indices = ctx.buffer(np.ascontiguousarray(triangles))
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def release(self) -> None:
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()
        self._vertices.release()
        self._indices.release()

    def array(self, program: moderngl.Program) -> moderngl.VertexArray:
        if program not in self._arrays:
            wants_normals = program.get("in_normal", None) is not None
            names = ("in_position", "in_normal") if wants_normals else ("in_position",)
            layout = "3f 3f" if wants_normals else "3f 12x" if self._has_normals else "3f"
            self._arrays[program] = self._ctx.vertex_array(program, [(self._vertices, layout, *names)], self._indices)
        return self._arrays[program]


def _creased(points: Float, triangles: NDArray[np.uint32]) -> tuple[Float, NDArray[np.uint32], Float32]:
    """The surface with a vertex for each triangle's corner, and their unit normals, smooth but at the body's edges."""
    corners = np.arange(triangles.size, dtype=np.uint32).reshape(-1, 3)
    return points[triangles.ravel()], corners, corner_normals(points.astype(np.float32), triangles)


def _for_both_layers(is_written: bool) -> Any:  # moderngl's stub knows masks of one attachment
    return ((is_written,) * 4,) * 2
