"""Writes a picture as PNG, whole or not at all."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import PIL.Image
from PIL.PngImagePlugin import PngInfo

from ashe_live.core import arguments
from ashe_live.core.arrays import GivenImage
from ashe_live.files.writing import written_whole

# A little larger than Pillow's 6, in a fifth of the time: the viewer waits for it.
COMPRESSION = 1
RGB_OF_BGR = (2, 1, 0, 3)


def write_png(
    path: str | Path,
    image_bgr: GivenImage,
    overwrite: bool = False,
    texts: Mapping[str, str] | None = None,
    beside: bool = False,
) -> Path:
    """Writes (h, w, 3) uint8 BGR, or (h, w, 4) BGRA with straight alpha, as PNG; returns the path of the file.

    overwrite: replaces a file that is there.
    texts: are stored in it by keyword, in chunks of the kind iTXt (PNG specification, 11.3.3.4).
    beside: where a file is at `path` that stays, this one is written beside it, as `NAME-2` and so on.

    Raises UserError when `path` exists (with neither of the two) or cannot be written, ValueError for a name that says
    that it is no PNG and for another array, TypeError for what is no array.
    """
    target = arguments.path(path, "path")
    if target.suffix.lower() not in (".png", ""):
        raise ValueError(f"path is {target.name!r}, and what is written is PNG: name it .png")
    arguments.picture(image_bgr, "image_bgr", (3, 4))
    info = PngInfo()
    for keyword, text in (texts or {}).items():
        info.add_itxt(keyword, text)
    picture = PIL.Image.fromarray(np.ascontiguousarray(image_bgr[:, :, RGB_OF_BGR[: image_bgr.shape[2]]]))
    with written_whole(target, overwrite, beside) as file:
        picture.save(file.stream, format="PNG", pnginfo=info, compress_level=COMPRESSION)
    return file.path
