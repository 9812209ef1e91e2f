"""How large a model may be, told from its file's own numbers before anything is allocated for them."""

import re
from pathlib import Path

from PIL import Image as PillowImage

from ashe_live.errors import UserError

MAX_FILE_BYTES = 200_000_000
MAX_TRIANGLES = 2_000_000
MAX_TEXTURE_PX = 2048  # a side; larger pictures are reduced to it
MAX_PICTURE_TEXELS = 8192 * 8192  # of one picture in the file
MAX_MODEL_TEXELS = 16 * 2048 * 2048  # of all maps together, as reduced

STL_HEADER_BYTES, STL_TRIANGLE_BYTES = 84, 50
PLY_FACES = re.compile(rb"element\s+face\s+(\d+)")
HEADER_BYTES = 65536


def stated_triangles(suffix: str, content: bytes) -> int:
    """How many triangles the content of an .obj, .ply or .stl says that it has, at least."""
    if suffix == ".ply":
        found = PLY_FACES.search(content[:HEADER_BYTES])
        return int(found[1]) if found else 0
    if suffix == ".stl":
        is_text = content.lstrip().startswith(b"solid") and b"facet" in content[:HEADER_BYTES]
        return 0 if is_text else (len(content) - STL_HEADER_BYTES) // STL_TRIANGLE_BYTES
    return content.count(b"\nf ")


def check_triangles(path: Path, triangles: int) -> None:
    if triangles > MAX_TRIANGLES:
        raise UserError(
            f"the model file {path} has {triangles:,} triangles", f"reduce it to {MAX_TRIANGLES:,} or fewer"
        )


def check_accessor(path: Path, elements: int) -> None:
    if elements > 3 * MAX_TRIANGLES:
        raise UserError(f"the model file {path} has {elements:,} vertices", "export it again")


def check_picture(picture: PillowImage.Image) -> None:
    """Of a picture whose header is read and whose texels are not."""
    width, height = picture.size
    if width * height > MAX_PICTURE_TEXELS:
        raise UserError(f"a texture of the model has {width} x {height} texels", "reduce it to 8192 x 8192 or fewer")


def check_texels(texels: int) -> None:
    if texels > MAX_MODEL_TEXELS:
        raise UserError(
            f"the model's textures have {texels:,} texels together", f"reduce them to {MAX_MODEL_TEXELS:,} or fewer"
        )
