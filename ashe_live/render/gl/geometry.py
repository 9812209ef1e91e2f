"""A model on the graphics card, uploaded in steps small enough for one picture each."""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import moderngl
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image
from ashe_live.models.albedo import mean_albedo
from ashe_live.models.material import SRGB_MAPS, Alpha
from ashe_live.models.mesh import Mesh
from ashe_live.models.placement import PlacedModel
from ashe_live.models.roundness import stands_for_round
from ashe_live.render.gl.map_layout import layout_constants, layout_uniforms
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.texture_units import UNIT_OF

GL_RGBA8, GL_SRGB8_ALPHA8 = 0x8058, 0x8C43
STEP_BYTES = 1 << 20  # about what a software rasteriser uploads in a millisecond
MOST_SORTED = 20_000  # triangles, which takes 2 ms
SORTED_AGAIN = 0.01  # movement of the eye over its distance, after which triangles are sorted again
OPENNESS = "in_openness"  # bytes that stand for 0 to 1, in a buffer of their own, as they are known last


class GpuPart:
    """One mesh, in buffers of position 3f, normal 3f and, where it has them, one or two uv 2f and colour 4f.

    The positions and normals of a mesh that moves have a buffer of their own, and so has the openness of every mesh.
    """

    def __init__(self, ctx: moderngl.Context, mesh: Mesh, number: int) -> None:
        """`number`: other parts of the model have others."""
        self.mesh = mesh
        self.number = number
        self.material = mesh.material
        self.centre: Float = mesh.vertices.mean(axis=0, dtype=np.float64)  # (3,) metres, the model's own frame
        self.maps: dict[str, moderngl.Texture] = {}
        columns = {
            "in_position": mesh.vertices,
            "in_normal": mesh.normals,
            "in_uv": mesh.uvs,
            "in_more_uv": mesh.more_uvs,
            "in_colour": mesh.colours,
        }
        self._columns = {name: values for name, values in columns.items() if values is not None}
        self.is_rounded = stands_for_round(mesh)
        self.has_clear_vertices = mesh.colours is not None and bool((mesh.colours[:, 3] < 1).any())
        picture = mesh.material.base_map if mesh.material.alpha is Alpha.BLEND else None
        # Whether a blended part's picture or its vertices' colours let some places be seen through.
        self.has_clear_places = self.has_clear_vertices or (picture is not None and bool((picture[..., 3] < 255).any()))
        self.greatest_opacity = mesh.greatest_opacity if mesh.material.alpha is Alpha.BLEND else 1.0
        self._ctx = ctx
        self._pieces: list[_Piece] = []
        self._arrays: dict[moderngl.Program, list[moderngl.VertexArray]] = {}
        self._sorted_from: Float | None = None

    def upload(self) -> Iterator[None]:
        """Uploads in steps of at most about STEP_BYTES, as a driver may clear memory before it hands it out."""
        row_bytes = 4 * sum(values.shape[1] for values in self._columns.values())
        triangles_at_once = max(1, STEP_BYTES // (3 * row_bytes))
        triangles = self.mesh.triangles
        is_small = len(self.mesh.vertices) * row_bytes <= STEP_BYTES and triangles.nbytes <= STEP_BYTES
        at_once = len(triangles) if is_small else triangles_at_once
        for first in range(0, len(triangles), at_once):
            piece = triangles[first : first + at_once]
            used, indices = (slice(None), piece) if is_small else np.unique(piece, return_inverse=True)
            attributes = [
                (names, self._ctx.buffer(np.hstack([self._columns[name][used] for name in names])))
                for names in self._together
            ]
            count = len(self.mesh.vertices[used])
            attributes.append(((OPENNESS,), self._ctx.buffer(np.full((count, 4), 255, np.uint8))))
            self._pieces.append(_Piece(used, attributes, self._ctx.buffer(indices.astype(np.uint32))))
            yield

    @property
    def _together(self) -> list[tuple[str, ...]]:
        """Names of attributes, grouped by buffer; the first group is what a motion changes."""
        names = tuple(self._columns)
        return [names] if self.mesh.motion is None else [each for each in (names[:2], names[2:]) if each]

    def pose(self, time_s: float) -> None:
        """Moves the mesh, which must be uploaded, to where it is at `time_s`, if it moves at all."""
        if self.mesh.motion is not None:
            both = np.hstack(self.mesh.motion.at(time_s))
            for piece in self._pieces:
                piece.attributes[0][1].write(np.ascontiguousarray(both[piece.used]))

    def set_openness(self, openness: NDArray[np.uint8]) -> None:
        """Sets the vertices' openness (n, 4), 255 for open, as SelfOcclusion finds it. The mesh must be uploaded."""
        for piece in self._pieces:
            piece.attributes[-1][1].write(np.ascontiguousarray(openness[piece.used]))

    def sort(self, eye: Float) -> bool:
        """Puts the triangles in order, far before near as seen from `eye` (3,), metres, the mesh's own frame.

        False where they keep theirs, as they are too many, or move.
        """
        if len(self._pieces) != 1 or self.mesh.motion is not None or len(self.mesh.triangles) > MOST_SORTED:
            return False
        near = SORTED_AGAIN * float(np.linalg.norm(eye - self.centre))
        if self._sorted_from is None or float(np.linalg.norm(eye - self._sorted_from)) > near:
            self._sorted_from = eye
            middles = self.mesh.vertices[self.mesh.triangles].mean(axis=1)
            order = np.argsort(-np.square(middles - eye).sum(axis=1), kind="stable")
            self._pieces[0].indices.write(np.ascontiguousarray(self.mesh.triangles[order], np.uint32))
        return True

    def draw(self, program: moderngl.Program) -> None:
        """Draws with the vertex attributes that `program` reads; its uniforms are set by the caller."""
        if program not in self._arrays:
            self._arrays[program] = [self._array(program, piece) for piece in self._pieces]
        for array in self._arrays[program]:
            array.render()

    def release(self) -> None:
        for array in itertools.chain.from_iterable(self._arrays.values()):
            array.release()
        for piece in self._pieces:
            for held in (piece.indices, *(buffer for _, buffer in piece.attributes)):
                held.release()
        self._arrays.clear()
        self._pieces.clear()

    def _array(self, program: moderngl.Program, piece: "_Piece") -> moderngl.VertexArray:
        content = []
        for names, buffer in piece.attributes:
            # Attributes that the program does not read are skipped.
            read = [name for name in names if isinstance(program.get(name, None), moderngl.Attribute)]
            if read:
                content.append((buffer, " ".join(self._format(name, name in read) for name in names), *read))
        return self._ctx.vertex_array(program, content, piece.indices)

    def _format(self, name: str, is_read: bool) -> str:
        """The format of an attribute in a row of its buffer, as moderngl writes it."""
        if name == OPENNESS:
            return "4f1"
        width = self._columns[name].shape[1]
        return f"{width}f" if is_read else f"{4 * width}x"


class _Piece(NamedTuple):
    """Some of a mesh's triangles."""

    used: slice | NDArray[np.integer]  # of the mesh's vertices
    attributes: list[tuple[tuple[str, ...], moderngl.Buffer]]  # by their names in a row of the buffer
    indices: moderngl.Buffer


class TextureKey(NamedTuple):
    """Maps with the same key share one texture."""

    texels: int  # id of the array: a picture that several parts use is one array
    is_srgb: bool
    repeats: tuple[bool, bool]
    is_sharp: bool


class GpuModel:
    """A placed model's buffers and textures; it can be drawn once every step of `upload` has been taken."""

    def __init__(self, ctx: moderngl.Context, placed: PlacedModel, programs: Programs) -> None:
        self.placed = placed
        self.points = placed.outline
        self.albedo = mean_albedo(placed.model)
        self.parts: list[GpuPart] = []
        self._ctx = ctx
        self._programs = programs
        self._textures: dict[TextureKey, moderngl.Texture] = {}
        self._posed_s: float | None = None

    @property
    def is_clear(self) -> bool:
        """Whether parts of it stop only a share of the light."""
        return any(part.material.alpha is Alpha.BLEND for part in self.parts)

    def pose(self, time_s: float) -> None:
        """Moves all parts that move to where they are at `time_s`."""
        if self._posed_s != time_s:
            self._posed_s = time_s
            for part in self.parts:
                part.pose(time_s)

    def upload(self) -> Iterator[None]:
        """Uploads in steps of at most STEP_BYTES, or of one texture's mipmaps."""
        for mesh in self.placed.model.parts:
            part = GpuPart(self._ctx, mesh, len(self.parts))
            self.parts.append(part)
            yield from part.upload()
            for name, texels in mesh.material.maps.items():
                layout = mesh.material.layout(name)
                key = TextureKey(id(texels), name in SRGB_MAPS, layout.repeats, layout.is_sharp)
                if key not in self._textures:
                    yield from self._fill(key, texels)
                part.maps[name] = self._textures[key]

    def render_depth(self, clip_from_marker: Float) -> None:
        """Draws into the bound depth buffer; of surfaces with holes or partial transparency only a part."""
        for part in self.parts:
            material = part.material
            has_holes = material.alpha is not Alpha.OPAQUE
            is_by_picture = has_holes and "base_map" in part.maps
            program = self._programs.get(
                "lights/depth",
                base_map=is_by_picture,
                vertex_colours=has_holes and part.has_clear_vertices,
                **{material.alpha.name: has_holes},
                **(layout_constants(part.mesh) if is_by_picture else {}),
            )
            if is_by_picture:
                part.maps["base_map"].use(UNIT_OF["base_map"])
                set_uniforms(program, **layout_uniforms(part.mesh))
            set_uniforms(
                program,
                clip_from_marker=clip_from_marker,
                base_alpha=material.base_colour[3],
                alpha_cutoff=material.alpha_cutoff,
            )
            if part.mesh.faces_inwards:
                self._ctx.enable(moderngl.CULL_FACE)
            part.draw(program)
            self._ctx.disable(moderngl.CULL_FACE)

    def release(self) -> None:
        for part in self.parts:
            part.release()
        for texture in self._textures.values():
            texture.release()
        self.parts.clear()
        self._textures.clear()

    def _fill(self, key: TextureKey, texels: Image) -> Iterator[None]:
        height, width = texels.shape[:2]
        internal_format = GL_SRGB8_ALPHA8 if key.is_srgb else GL_RGBA8
        texture = self._ctx.texture((width, height), 4, internal_format=internal_format)
        self._textures[key] = texture
        texture.repeat_x, texture.repeat_y = key.repeats
        rows = max(1, STEP_BYTES // (4 * width))
        for bottom in range(0, height, rows):
            band = texels[::-1][bottom : bottom + rows]
            texture.write(np.ascontiguousarray(band), viewport=(0, bottom, width, len(band)))
            yield
        if max(width, height) > 1:
            texture.build_mipmaps()
            near = moderngl.NEAREST if key.is_sharp else moderngl.LINEAR
            texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, near
            yield
