"""How large a model may be, told from its file's own numbers before anything is allocated for them."""

import re
from dataclasses import dataclass
from pathlib import Path

from PIL import Image as PillowImage

from ashe_live.errors import UserError

MAX_FILE_BYTES = 200_000_000  # of the model's file, and of all others that it names together
MAX_NAMED_FILES = 1_000
MAX_TRIANGLES = 2_000_000
MAX_VERTICES = 3 * MAX_TRIANGLES
MAX_PARTS = 10_000  # meshes, as often as they are drawn
MAX_SURFACES = 1_000  # each is a call of the driver in every pass of every frame
MAX_GROUPS = 1_000  # an OBJ's materials, a text STL's solids: each is looked for among all others
MAX_LINES = 4 * MAX_TRIANGLES  # of a text PLY
MAX_NODES = 20_000  # of a scene
MAX_MATERIALS = 10_000  # in an MTL file, which several models may share
MAX_OBJ_LINES = 3 * MAX_VERTICES + MAX_TRIANGLES  # places, texture coordinates, normals, faces
MAX_DEPTH = 200  # of nodes within nodes
MAX_TEXTURE_PX = 2048  # a side; larger pictures are reduced to it
MAX_PICTURE_TEXELS = 8192 * 8192  # of one picture in the file
MAX_DECODED_TEXELS = 5 * MAX_PICTURE_TEXELS  # of all pictures in the file, before they are reduced
MAX_MODEL_TEXELS = 16 * 2048 * 2048  # of all maps together, as reduced
# Pillow knows more, among them one that is a program and runs.
PICTURE_FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TGA", "TIFF", "GIF")

STL_HEADER_BYTES, STL_TRIANGLE_BYTES = 84, 50  # of binary STL
STL_FIRST_BYTES = 1000  # within which text STL has its first facet
PLY_FACES = re.compile(rb"element\s+face\s+(\d+)")
# A line may go on after a backslash. Possessive, as the stack of a long line would be larger than the line.
OBJ_FACES = re.compile(rb"^f(?:[^\n\\]++|\\\r?\n|\\)*+", re.MULTILINE)
OBJ_MATERIALS = re.compile(rb"^usemtl[^\n]*", re.MULTILINE)
SPACES = b" \t\v\f\r"
# What text is split at: str.splitlines.
LINE_ENDS = (b"\n", b"\r", b"\v", b"\f", b"\x1c", b"\x1d", b"\x1e", b"\xc2\x85", b"\xe2\x80\xa8", b"\xe2\x80\xa9")
PLY_HEADER_BYTES = 65536  # within which a PLY says how many faces it has


def check_text(path: Path, content: bytes) -> None:
    """Raises UserError if an .obj, .ply or .stl is too large by its own numbers."""
    suffix = path.suffix.lower()
    if suffix == ".ply":
        header = content[:PLY_HEADER_BYTES]
        found = PLY_FACES.search(header)
        check_triangles(path, int(found[1]) if found else 0)
        if b"ascii" in header:
            _check(path, sum(content.count(end) for end in LINE_ENDS), MAX_LINES, "lines")
    elif suffix == ".obj":
        _check(path, content.count(b"\n"), MAX_OBJ_LINES, "lines")
        check_triangles(path, _obj_triangles(content))
        _check(path, len(set(OBJ_MATERIALS.findall(content))), MAX_GROUPS, "materials")
    elif is_text_stl(content):
        lower = content.lower()
        check_triangles(path, lower.count(b"vertex") // 3)
        _check(path, lower.count(b"endsolid"), MAX_GROUPS, "solids")
    else:
        check_triangles(path, (len(content) - STL_HEADER_BYTES) // STL_TRIANGLE_BYTES)


def is_text_stl(content: bytes) -> bool:
    """Binary files may begin with "solid" and name facets as well; they have as many triangles as they say.

    The same four bytes of text, taken for a number, are of more triangles than any file has.
    """
    first = content[:STL_FIRST_BYTES].lower()
    triangles = int.from_bytes(content[STL_HEADER_BYTES - 4 : STL_HEADER_BYTES], "little")
    is_long_enough = len(content) >= STL_HEADER_BYTES + triangles * STL_TRIANGLE_BYTES
    return first.lstrip()[:5] == b"solid" and b"facet" in first and not is_long_enough


def _obj_triangles(content: bytes) -> int:
    """Number of triangles of an OBJ's polygons, which are counted one by one only if there could be too many."""
    if len(content) - len(content.translate(None, SPACES)) <= MAX_TRIANGLES:
        return content.count(b"\nf ")
    faces = (found[0] for found in OBJ_FACES.finditer(content))
    return sum(max(len(face) - len(face.translate(None, SPACES)) - 2, 1) for face in faces)


def check_triangles(path: Path, triangles: int) -> None:
    _check(path, triangles, MAX_TRIANGLES, "triangles")


def check_surfaces(path: Path, surfaces: int) -> None:
    """Meshes of different materials, and blended ones."""
    _check(path, surfaces, MAX_SURFACES, "surfaces of different materials")


@dataclass(frozen=True, slots=True)
class GltfAmounts:
    """Each counted as often as it is read, used or drawn, whichever is more: what is shared is large in few bytes."""

    triangles: int
    vertices: int
    parts: int  # primitives of meshes
    bytes: int  # of the parts of buffers, or of the arrays made from them
    nodes: int  # of the scene
    depth: int  # of nodes within nodes


def check_gltf(path: Path, amounts: GltfAmounts) -> None:
    """Raises UserError when one of them is too large."""
    check_triangles(path, amounts.triangles)
    _check(path, amounts.vertices, MAX_VERTICES, "vertices")
    _check(path, amounts.parts, MAX_PARTS, "parts")
    _check(path, amounts.nodes, MAX_NODES, "nodes")
    _check(path, amounts.depth, MAX_DEPTH, "nodes within nodes")
    _check(path, amounts.bytes, MAX_FILE_BYTES, "bytes of arrays")


def _check(path: Path, count: int, most: int, what: str) -> None:
    if count > most:
        raise UserError(f"the model file {path} has {count:,} {what}", f"reduce it to {most:,} or fewer")


def check_materials(path: Path, materials: int) -> None:
    """Raises UserError for more materials than one file may define."""
    if materials > MAX_MATERIALS:
        raise UserError(
            f"a material file of the model file {path} holds more than {MAX_MATERIALS:,} materials",
            "export it with fewer",
        )


def check_picture(path: Path, picture: PillowImage.Image) -> None:
    """Raises UserError for a picture that is too large, by its header, before it is decoded."""
    if picture.format not in PICTURE_FORMATS:
        raise UserError(
            f"a texture of the model file {path} is in the format {picture.format}", "save it as PNG or JPEG"
        )
    check_size(path, *picture.size)


def check_size(path: Path, width: int, height: int) -> None:
    """Raises UserError for a picture of these many texels if it is too large."""
    if width * height > MAX_PICTURE_TEXELS:
        raise too_large(path, f"of {width} x {height}")


def too_large(path: Path, size: str) -> UserError:
    return UserError(f"the model file {path} has a texture {size} texels", "reduce it to 8192 x 8192 or fewer")


def check_decoded(path: Path, texels: int) -> None:
    """Before the last of them are decoded, which takes their number's time, however few bytes hold them."""
    if texels > MAX_DECODED_TEXELS:
        raise UserError(
            f"the textures of the model file {path} have more than {MAX_DECODED_TEXELS:,} texels in their files",
            "reduce them to 2048 x 2048 each",
        )


def check_texels(path: Path, texels: int) -> None:
    if texels > MAX_MODEL_TEXELS:
        raise UserError(
            f"the textures of the model file {path} have {texels:,} texels together",
            f"reduce them to {MAX_MODEL_TEXELS:,} or fewer",
        )
