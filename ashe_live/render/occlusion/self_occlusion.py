"""Self-occlusion: what a model's parts hide of sky and ground from one another, as an attribute of its vertices.

An openness is the share of the light from the even sky above, or from the even ground below, that reaches a surface
past the model. Of both sides of the surface, as thin parts are seen from both. It is found at points spread over the
surface, each a texel of the textures that are drawn into, and fitted to the vertices from there.
"""

from collections.abc import Iterator, Sequence

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import Mesh
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.lights.shadow_maps import ShadowMaps
from ashe_live.render.occlusion.surface_samples import LEAST_AREA, SurfaceSamples, samples_on

SAMPLES = 8_000  # points on a model, besides one on each triangle
ROW = 1024  # texels in a row of the textures, each of a point
# Weight of a point inside another part, from where nothing is seen: points that are seen count far more.
LEAST_WEIGHT = 0.01
LEAST_LIGHT = 0.01  # least light of an even sky or ground by which the hidden part of it is divided


class SelfOcclusion:
    """Measures how much of sky and ground is hidden from meshes that stand together, by what the depth maps show."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, meshes: Sequence[Mesh]) -> None:
        self._programs = programs
        per_area = SAMPLES / max(sum(float(mesh.areas.sum()) for mesh in meshes), LEAST_AREA)
        self._samples: list[SurfaceSamples] = [samples_on(mesh, per_area) for mesh in meshes]
        self._moves = any(mesh.motion is not None for mesh in meshes)
        self._count = sum(len(samples.corners) for samples in self._samples)
        self._size = ROW, -(-self._count // ROW)
        self._places, self._normals, self._hidden = (ctx.texture(self._size, 4, dtype="f4") for _ in range(3))
        for texture in (self._places, self._normals):
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._framebuffer = ctx.framebuffer([self._hidden])
        self._framebuffer.clear()
        self._rectangle = WholeRectangle(ctx)
        self._upward = self._pose(0.0)

    def add(self, depth_map: ShadowMaps, weight: float, time_s: float) -> None:
        """Adds what is hidden of the directions from which `depth_map` shows the model, as it is at that time."""
        if self._moves:
            self._pose(time_s)
        program = self._programs.get("occlusion/self_occlusion", all_block=1, **depth_map.constants)
        depth_map.bind(program)
        self._places.use(UNIT_OF["sample_places"])
        self._normals.use(UNIT_OF["sample_normals"])
        set_uniforms(program, weight=weight)
        self._rectangle.fill(self._framebuffer, program, adds=True)

    def openness(self) -> Iterator[Float]:
        """(n, 4) in [0, 1] of the vertices of each mesh, as `_openness`, once every direction was added."""
        hidden = np.frombuffer(self._hidden.read(), np.float32).reshape(-1, 4)[: self._count].astype(np.float64)
        begin = 0
        for samples in self._samples:
            own = slice(begin, begin + len(samples.corners))
            yield _openness(samples, hidden[own], self._upward[own])
            begin = own.stop

    def release(self) -> None:
        for held in (self._framebuffer, self._places, self._normals, self._hidden, self._rectangle):
            held.release()

    def _pose(self, time_s: float) -> Float:
        """Fills the textures with where the points are then; (n,) the normals' z."""
        both = [samples.places_and_normals(time_s) for samples in self._samples]
        for texture, parts in ((self._places, [each[0] for each in both]), (self._normals, [each[1] for each in both])):
            texels = np.zeros((self._size[0] * self._size[1], 4), np.float32)
            texels[: self._count, :3] = np.concatenate(parts)
            texture.write(texels)
        return np.concatenate([normals[:, 2] for _, normals in both]).astype(np.float64)


def _openness(samples: SurfaceSamples, hidden: Float, upward: Float) -> Float:
    """(m, 4) of a mesh's vertices: of sky and ground in front of the surface, and of both behind it.

    hidden: (n, 4) shares of all light from around that are hidden at the points, in the same order.
    upward: (n,) the normals' z.
    """
    found = [np.ones(len(samples.mesh.vertices))] * 4
    for side, z in ((0, upward), (2, -upward)) if samples.mesh.material.double_sided else ((0, upward),):
        of_sky, of_ground = 0.5 + 0.5 * z, 0.5 - 0.5 * z
        seen = samples.areas * np.maximum(1 - hidden[:, side] - hidden[:, side + 1], LEAST_WEIGHT)
        for light, column in ((of_sky, side), (of_ground, side + 1)):
            open_share = 1 - hidden[:, column] / np.maximum(light, LEAST_LIGHT)
            found[column] = samples.fitted(np.clip(open_share, 0.0, 1.0), seen * np.maximum(light, LEAST_LIGHT))
    return np.column_stack(found)
