"""A model on the graphics card."""

from dataclasses import dataclass

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import LinearRGBA, Mesh
from ashe_live.models.placement import PlacedModel

GL_SRGB8_ALPHA8 = 0x8C43
WHITE_TEXEL = np.full((1, 1, 4), 255, dtype=np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class GpuPart:
    """One mesh in buffers: position 3f, normal 3f, uv 2f, colour 4f."""

    vertices: moderngl.Buffer
    indices: moderngl.Buffer
    texture: moderngl.Texture
    base_colour: LinearRGBA
    double_sided: bool
    shaded: moderngl.VertexArray
    depth_only: moderngl.VertexArray


class GpuModel:
    """A placed model's buffers and textures, for the program that shades it and the one that fills depth maps."""

    def __init__(
        self, ctx: moderngl.Context, placed: PlacedModel, shading: moderngl.Program, depth: moderngl.Program
    ) -> None:
        self.placed = placed
        self.points: Float = np.concatenate([part.vertices for part in placed.model.parts]).astype(np.float64)
        self.parts = tuple(_upload(ctx, part, shading, depth) for part in placed.model.parts)

    def render_depth(self) -> None:
        for part in self.parts:
            part.depth_only.render()

    def release(self) -> None:
        for part in self.parts:
            for held in (part.shaded, part.depth_only, part.vertices, part.indices, part.texture):
                held.release()


def _upload(ctx: moderngl.Context, mesh: Mesh, shading: moderngl.Program, depth: moderngl.Program) -> GpuPart:
    count = len(mesh.vertices)
    uvs = mesh.uvs if mesh.uvs is not None else np.zeros((count, 2), np.float32)
    colours = mesh.colours if mesh.colours is not None else np.ones((count, 4), np.float32)
    vertices = ctx.buffer(np.hstack([mesh.vertices, mesh.normals, uvs, colours]).astype(np.float32))
    indices = ctx.buffer(mesh.triangles)
    shaded_layout = (vertices, "3f 3f 2f 4f", "in_position", "in_normal", "in_uv", "in_colour")
    return GpuPart(
        vertices,
        indices,
        _texture(ctx, mesh),
        mesh.base_colour,
        mesh.double_sided,
        ctx.vertex_array(shading, [shaded_layout], indices),
        ctx.vertex_array(depth, [(vertices, "3f 36x", "in_position")], indices),
    )


def _texture(ctx: moderngl.Context, mesh: Mesh) -> moderngl.Texture:
    texels = mesh.base_texture if mesh.base_texture is not None else WHITE_TEXEL
    height, width = texels.shape[:2]
    texture = ctx.texture((width, height), 4, np.ascontiguousarray(texels[::-1]), internal_format=GL_SRGB8_ALPHA8)
    if min(width, height) > 1:
        texture.build_mipmaps()
        texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
    return texture
