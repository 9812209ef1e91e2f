"""The real object in the scene: hides what is behind it, casts its shadow, takes the model's shadow."""

import math

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.models.mesh import Indices
from ashe_live.render.framing import Framing
from ashe_live.render.lighting import Lighting
from ashe_live.render.programs import Programs, set_uniforms
from ashe_live.render.shadow_maps import ShadowMaps
from ashe_live.render.video import Video

AROUND, UPWARDS = 48, 25
GL_DEPTH_CLAMP = 0x864F


class RealObject:
    """A proxy on the graphics card; casts shadows as a Caster."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, proxy: Proxy) -> None:
        self.proxy = proxy
        self.points, triangles = support_surface(proxy)
        self._ctx = ctx
        self._programs = programs
        self._vertices = ctx.buffer(self.points.astype(np.float32))
        self._indices = ctx.buffer(triangles)
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def render_depth(self, clip_from_marker: Float) -> None:
        program = self._programs.get("depth")
        set_uniforms(program, clip_from_marker=clip_from_marker)
        self._array(program).render()

    def draw(self, framing: Framing, video: Video, lighting: Lighting, shadows: ShadowMaps) -> None:
        """Its depth, and in its place the video, darker where the model keeps a sun from it."""
        if shadows.model_shades_real:
            program = self._programs.get("caster", **shadows.constants | {"casters": 1})
        else:
            program = self._programs.get("depth")
        video.bind(0)
        shadows.bind(program)
        set_uniforms(
            program,
            clip_from_marker=framing.clip_from_marker,
            video=0,
            viewport=tuple(float(value) for value in framing.viewport),
            **lighting.uniforms(),
        )
        self._ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        # Near and far enclose the model and its shadow; the object may stand before and behind both.
        self._ctx.enable_direct(GL_DEPTH_CLAMP)
        framebuffer = self._ctx.fbo
        framebuffer.color_mask = (shadows.model_shades_real,) * 4
        framebuffer.use()
        self._array(program).render()
        framebuffer.color_mask = (True,) * 4
        framebuffer.use()
        self._ctx.disable_direct(GL_DEPTH_CLAMP)

    def release(self) -> None:
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()
        self._vertices.release()
        self._indices.release()

    def _array(self, program: moderngl.Program) -> moderngl.VertexArray:
        if program not in self._arrays:
            layout = [(self._vertices, "3f", "in_position")]
            self._arrays[program] = self._ctx.vertex_array(program, layout, self._indices)
        return self._arrays[program]


def support_surface(proxy: Proxy) -> tuple[Float, Indices]:
    """(n, 3) points and (m, 3) triangles, counter-clockwise from outside, of a convex hull of spheroids.

    A grid on the unit sphere, each direction moved to the hull's farthest point along it: exact where the hull is
    round, and its corners are hit by all directions that they are farthest in.
    """
    # Half a step off the axes, in which boxes have their faces.
    azimuth = (np.arange(AROUND) + 0.5) * (2 * math.pi / AROUND)
    sine = np.sin(np.linspace(-math.pi / 2, math.pi / 2, UPWARDS))[:, None]
    flat = np.sqrt(1 - np.minimum(sine**2, 1.0))
    directions = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), sine + 0 * azimuth], axis=-1).reshape(-1, 3)
    centre, radius, half = np.split(proxy.spheroids_marker, (3, 4), axis=1)
    axes = np.concatenate([radius, radius, half], axis=1)
    reach = np.linalg.norm(axes * directions[:, None], axis=2)
    farthest = (directions @ centre.T + reach).argmax(axis=1)
    at = np.arange(len(directions))
    length = np.maximum(reach[at, farthest], np.finfo(np.float64).tiny)[:, None]
    points = centre[farthest] + axes[farthest] ** 2 * directions / length
    corner = np.arange((UPWARDS - 1) * AROUND).reshape(-1, AROUND)
    right = np.roll(corner, -1, axis=1)
    quads = np.stack([corner, right, right + AROUND, corner, right + AROUND, corner + AROUND], axis=-1)
    return points, quads.reshape(-1, 3).astype(np.uint32)
