"""OBJ: places, texture coordinates, normals, and polygons of them in groups of one material each.

http://paulbourke.net/dataformats/obj/
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb
from ashe_live.models.assembly.geometry import RawMesh
from ashe_live.models.formats.mtl import read_mtl
from ashe_live.models.formats.mtl_lines import plain_name, text_of, without_comment
from ashe_live.models.formats.polygons import triangulated
from ashe_live.models.formats.words import full_intensity, numbers_in, with_plain_nan
from ashe_live.models.material import NO_COORDINATES, UNKNOWN, Material
from ashe_live.models.parsing.folder import Folder, MissingFileError
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import NAME_CHARACTERS, WITHOUT_COORDINATES, Notes
from ashe_live.models.parsing.pictures import Pictures
from ashe_live.process.messages import printable

Indices = NDArray[np.int64]
NAMED = ("vertex", "texture coordinate", "normal")
NUMBERED = (b"v", b"vt", b"vn", b"f")
COMMENTS = re.compile(rb"(?:\A|(?<=[\r\n]))[ \t]*+#[^\r\n]*")  # whole lines of them, which no backslash continues
CONTINUED = re.compile(rb"\\(?:\r\n?|\n)")


@dataclass(slots=True)
class _Lines:
    """A file's lines by what they say, without their first word."""

    values: tuple[list[bytes], list[bytes], list[bytes]] = field(default_factory=lambda: ([], [], []))
    faces: list[bytes] = field(default_factory=list)
    before: list[tuple[int, int, int]] = field(default_factory=list)  # how many values came before each face
    materials: list[int] = field(default_factory=list)  # of each face: a place in `names`
    names: dict[bytes, int] = field(default_factory=dict)
    libraries: list[bytes] = field(default_factory=list)
    has_lines: bool = False
    has_curves: bool = False


def read_obj(content: bytes, folder: Folder, notes: Notes) -> Iterator[RawMesh]:
    """One mesh for each material. Raises UserError for what it names and cannot be read, MalformedError for no OBJ."""
    lines = _sorted(CONTINUED.sub(b" ", COMMENTS.sub(b"", content)))
    if lines.has_lines:
        notes.add("points and lines are left out")
    if lines.has_curves:
        notes.add("curves and curved surfaces are left out")
    if not lines.faces:
        return
    materials = _materials(lines, folder, notes)
    places, colours = _places(lines.values[0])
    uvs, normals = (_table(values, width) for values, width in zip(lines.values[1:], (2, 3), strict=True))
    corners, counts = _corners(lines, (len(places), len(uvs), len(normals)))
    faces = np.asarray(lines.materials)
    names = list(lines.names)
    if colours is not None and any(materials.get(names[number], UNKNOWN) is not UNKNOWN for number in set(faces)):
        notes.add("the colours of its vertices are multiplied with those of its materials")
    for number in np.unique(faces):
        some = faces == number
        triangles = triangulated(places, corners[np.repeat(some, counts), 0], counts[some])
        own, material = corners[np.repeat(some, counts)], materials.get(names[number], UNKNOWN)
        if material.maps and (own[:, 1] < 0).any():
            notes.add(WITHOUT_COORDINATES)
        yield _mesh(own, triangles, (places, uvs, normals), colours, material)


def _sorted(content: bytes) -> _Lines:
    found = _Lines()
    places, uvs, normals = found.values
    material = found.names.setdefault(b"", 0)
    for line in content.splitlines():
        key, _, rest = line.strip().replace(b"\t", b" ").partition(b" ")
        if key in NUMBERED and b"#" in rest:
            rest = with_plain_nan(rest).partition(b"#")[0]  # without a comment; in names # is a character
        if key == b"v":
            places.append(rest)
        elif key == b"f":
            found.faces.append(rest)
            found.before.append((len(places), len(uvs), len(normals)))
            found.materials.append(material)
        elif key == b"vt":
            uvs.append(rest)
        elif key == b"vn":
            normals.append(rest)
        elif key == b"usemtl":
            material = found.names.setdefault(rest.strip(), len(found.names))
        elif key == b"mtllib":
            found.libraries.append(without_comment(rest.strip()).strip(b'"'))
        elif key in (b"l", b"p"):
            found.has_lines = True
        elif key in (b"curv", b"surf"):
            found.has_curves = True
    return found


def _materials(lines: _Lines, folder: Folder, notes: Notes) -> dict[bytes, Material]:
    """The materials by the names that the OBJ uses; of several libraries with one name the first counts."""
    pictures = Pictures(folder, notes)
    found: dict[str, Material] = {}

    is_any_missing = False
    for library in lines.libraries:
        try:
            contents = {library: folder.get(text_of(library))}
        except MissingFileError:
            # Several names may stand on one line, and one name may hold spaces.
            there = {name: _there(folder, name) for name in library.replace(b'"', b" ").split()}
            contents = {name: content for name, content in there.items() if content is not None}
            missing = [name for name, content in there.items() if content is None]
            is_any_missing |= bool(missing)
            for gone in missing if contents else [library] * bool(missing):
                said = printable(text_of(gone), NAME_CHARACTERS)
                notes.add(f"its materials {said} are missing: it is drawn as plain plastic")
        for path, content in contents.items():
            beside = text_of(path).replace("\\", "/").rpartition("/")[0]
            for name, material in read_mtl(folder.model, content, pictures, beside, notes).items():
                found.setdefault(name, material)
    wanted = {name: text_of(name) for name in lines.names}
    plain = {plain_name(name): material for name, material in reversed(found.items())}
    for said in filter(None, wanted.values()):
        if said not in found and plain_name(said) in plain:
            found[said] = plain[plain_name(said)]
    used = set(lines.materials)
    unknown = [said for name, said in wanted.items() if said and said not in found and lines.names[name] in used]
    if lines.libraries and not is_any_missing and unknown:
        said = printable(unknown[0], NAME_CHARACTERS)
        notes.add(f"its material {said} is in none of its libraries: it is drawn as plain plastic")
    return {name: found[said] for name, said in wanted.items() if said in found}


def _there(folder: Folder, name: bytes) -> bytes | None:
    try:
        return folder.get(text_of(name))
    except MissingFileError:
        return None


def _places(lines: list[bytes]) -> tuple[Float, Float | None]:
    """(n, 3), and linear colours (n, 4) where every line goes on with them, as some programs write."""
    table = _table(lines, 3)
    if table.shape[1] < 6:
        return table[:, :3], None
    # Of seven numbers the fourth is the weight of a curve's point.
    encoded = np.clip(table[:, -3:] / full_intensity(table[:, -3:]), 0, 1)
    return table[:, :3], np.column_stack([linear_from_srgb(encoded), np.ones(len(table))])


def _table(lines: list[bytes], least: int) -> Float:
    """(n, at least `least`) numbers of lines that have as many each, or the first `least` of each."""
    if not lines:
        return np.empty((0, least))
    counts = {len(line.split()) for line in lines}
    if len(counts) == 1 and min(counts) >= least:
        return numbers_in(b" ".join(lines)).reshape(len(lines), -1)
    short = [(line.split() + [b"0"] * least)[:least] for line in lines]  # a coordinate may be left out of vt
    return numbers_in(b" ".join(word for words in short for word in words)).reshape(-1, least)


def _corners(lines: _Lines, there: tuple[int, int, int]) -> tuple[Indices, Indices]:
    """(k, 3) places of each face's corners in v, vt and vn, -1 for none; and how many corners each face has."""
    counts = np.fromiter((len(face.split()) for face in lines.faces), np.int64, len(lines.faces))
    if counts.min() < 1:
        raise MalformedError("a face has no corners")
    words = b" ".join(lines.faces).split()
    indices = _parsed(words)
    before = np.repeat(np.asarray(lines.before, dtype=np.int64), counts, axis=0)
    # From 1 on, or from the last one backwards; 0 stands for none.
    absolute = np.where(indices < 0, before + indices, indices - 1)
    is_outside = (absolute >= there) | ((indices < 0) & (absolute < 0))
    is_outside[:, 0] |= absolute[:, 0] < 0
    if is_outside.any():
        row, column = np.argwhere(is_outside)[0]
        raise MalformedError(f"a face names {NAMED[column]} {indices[row, column]} of {there[column]:,}")
    # A face lies on a picture with all of its corners, or not at all.
    is_bare = np.logical_or.reduceat(absolute[:, 1] < 0, np.cumsum(counts) - counts)
    absolute[np.repeat(is_bare, counts), 1] = -1
    return absolute, counts


def _parsed(words: list[bytes]) -> Indices:
    """(k, 3) numbers of corners such as 1, 1/2, 1//3 and 1/2/3; 0 for what is left out."""
    slashes = words[0].count(b"/")
    text = b" ".join(words)
    is_same = all(word.count(b"/") == slashes for word in words)
    if is_same and slashes < 3 and (b"//" not in text or text.count(b"//") == len(words)):
        numbers = numbers_in(text.replace(b"//", b"/0/").replace(b"/", b" "))
        if len(numbers) == (slashes + 1) * len(words):
            table = np.zeros((len(words), 3))
            table[:, : slashes + 1] = numbers.reshape(len(words), -1)
            return _whole(table)
    rows = [[*word.split(b"/"), b"", b""][:3] for word in words]
    return _whole(numbers_in(b" ".join(part or b"0" for row in rows for part in row)).reshape(-1, 3))


def _whole(numbers: Float) -> Indices:
    if not (np.abs(numbers) < 2**53).all() or (numbers != np.floor(numbers)).any():
        raise MalformedError("a face names a vertex by what is no whole number")
    return numbers.astype(np.int64)


def _mesh(
    corners: Indices, triangles: Indices, tables: tuple[Float, Float, Float], colours: Float | None, material: Material
) -> RawMesh:
    """A mesh of the corners (k, 3) of one material's faces; each combination of indices becomes a vertex."""
    places, uvs, normals = tables
    _, first, vertex = np.unique(_keys(corners), return_index=True, return_inverse=True)
    used = corners[first]
    has_uvs, has_normals = used[:, 1] >= 0, bool((used[:, 2] >= 0).all())
    return RawMesh(
        vertices=places[used[:, 0]],
        triangles=vertex[triangles],
        material=material,
        normals=normals[used[:, 2], :3] if has_normals else None,
        # One mesh of a material may have coordinates, and another none.
        uvs=np.where(has_uvs[:, None], uvs[used[:, 1], :2], NO_COORDINATES) if has_uvs.any() else None,
        colours=None if colours is None else colours[used[:, 0]],
    )


def _keys(corners: Indices) -> Indices:
    """(k,) one number for each row (k, 3), the same for the same."""
    sizes = corners.max(axis=0) + 2
    keys = corners[:, 0]
    for column in (1, 2):
        # As many as there are rows, so that products stay small.
        _, keys = np.unique(keys * sizes[column] + corners[:, column] + 1, return_inverse=True)
    return keys
