"""PLY: vertices and polygons, with the colours, normals and texture coordinates that programs write into it."""

from collections.abc import Iterator

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb
from ashe_live.models.assembly.geometry import RawMesh
from ashe_live.models.formats.mtl import pictured
from ashe_live.models.formats.ply_elements import HEADER_END, Element, Lists, elements_of
from ashe_live.models.formats.polygons import triangulated
from ashe_live.models.formats.words import full_intensity
from ashe_live.models.material import UNKNOWN, Material
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import Notes
from ashe_live.models.parsing.pictures import Pictures

PLACES, NORMALS = ("x", "y", "z"), ("nx", "ny", "nz")
UVS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
COLOURS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"))
CORNERS = ("vertex_indices", "vertex_index")
TEXTURE = b"comment TextureFile "
CORNER_UVS = "texcoord"  # MeshLab's: two numbers for each corner of a face


def read_ply(content: bytes, folder: Folder, notes: Notes) -> Iterator[RawMesh]:
    """Raises UserError for a texture that cannot be read, MalformedError for what is not as its header says."""
    material = _material(content, folder, notes)
    elements = elements_of(content)
    vertices, faces = elements.get("vertex"), elements.get("face")
    if vertices is None or faces is None or not faces.count:
        notes.add("strips of triangles are left out" if "tristrips" in elements else "points and lines are left out")
        return
    places = _columns(vertices, PLACES)
    if places is None:
        raise MalformedError("its vertices have no x, y and z")
    lists = _corner_lists(faces, len(places))
    corners = lists.values.astype(np.int64)
    triangles = triangulated(places, corners, lists.counts)
    uvs = _uvs(vertices) if material.uv_sets else None
    normals, colours = _columns(vertices, NORMALS), _colours(vertices)
    of_corners = _corner_uvs(faces, lists) if material.uv_sets else None
    of_faces = _colours(faces)
    if of_corners is None and of_faces is None:
        yield RawMesh(places, corners[triangles], material, normals, uvs, colours=colours)
        return
    # Each triangle has something of its own, and so corners of its own.
    each = triangles.ravel()
    which = corners[each]
    if of_faces is not None:
        colours = of_faces[np.repeat(np.arange(len(lists.counts)), lists.counts)[each]]
    elif colours is not None:
        colours = colours[which]
    yield RawMesh(
        vertices=places[which],
        triangles=np.arange(len(each)).reshape(-1, 3),
        material=material,
        normals=None if normals is None else normals[which],
        uvs=of_corners[each] if of_corners is not None else None if uvs is None else uvs[which],
        colours=colours,
    )


def _material(content: bytes, folder: Folder, notes: Notes) -> Material:
    header = HEADER_END.split(content, 1)[0].splitlines()
    names = [line.removeprefix(TEXTURE) for line in header if line.startswith(TEXTURE)]
    if not names:
        return UNKNOWN
    if len(set(names)) > 1:
        notes.add(f"one of its {len(set(names))} textures is drawn, on all of it")
    name = names[0].decode(errors="replace").strip()
    texels = Pictures(folder, notes).named(name, covers=True)
    return UNKNOWN if texels is None else pictured(UNKNOWN, texels)


def _corner_lists(faces: Element, vertices: int) -> Lists:
    """The vertices that each face names, of as many as there are."""
    lists = next((faces.lists[name] for name in CORNERS if name in faces.lists), None)
    if lists is None:
        raise MalformedError("its faces name no vertices")
    corners = lists.values.astype(np.int64)
    if len(corners) and not (corners.min() >= 0 and corners.max() < vertices):
        named = corners.min() if corners.min() < 0 else corners.max()
        raise MalformedError(f"a face names vertex {named} of {vertices}")
    return lists


def _columns(element: Element, names: tuple[str, ...]) -> Float | None:
    """(n, names); None where one of them is missing."""
    is_there = element.numbers.keys() >= set(names)
    return np.column_stack([element.numbers[name] for name in names]) if is_there else None


def _uvs(vertices: Element) -> Float | None:
    return next((uvs for names in UVS if (uvs := _columns(vertices, names)) is not None), None)


def _corner_uvs(faces: Element, corners: Lists) -> Float | None:
    """(corners, 2) where every face has two numbers for each of its own."""
    given = faces.lists.get(CORNER_UVS)
    if given is None or not np.array_equal(given.counts, 2 * corners.counts):
        return None
    return given.values.reshape(-1, 2)


def _colours(element: Element) -> Float | None:
    """(n, 4) linear; opaque where the file says nothing of alpha."""
    for names in COLOURS:
        if (rgb := _columns(element, names)) is not None:
            shares = rgb / _whole(element.kinds[names[0]], rgb)
            name = "alpha" if "alpha" in element.numbers else "a"
            alpha = element.numbers.get(name)
            opaque = np.ones(len(rgb)) if alpha is None else alpha / _whole(element.kinds[name], alpha)
            return np.column_stack([linear_from_srgb(np.clip(shares, 0, 1)), np.clip(opaque, 0, 1)])
    return None


def _whole(kind: str, values: Float) -> float:
    """The value of full intensity: of integers the largest number of the type, and 255 for those of four bytes, in
    which programs write those of one.
    """
    if kind[0] == "f":
        return full_intensity(values)
    return 255.0 if kind[1] == "4" else float(np.iinfo(np.dtype(kind)).max)
