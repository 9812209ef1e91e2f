"""Textures in Basis Universal (KTX 2), read where `opengl_basisu` is installed, which is the extra `ktx2`."""

import importlib.util
from pathlib import Path

import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.models.parsing.limits import MAX_TEXTURE_PX, check_size
from ashe_live.models.parsing.malformed import MalformedError

LEFT_OUT = (
    "textures compressed as Basis Universal (KTX2) are left out: pip install 'ashe-live[ktx2]' reads them, "
    "or export them as PNG, JPEG or WebP"
)


def is_readable() -> bool:
    """Whether the decoder is there."""
    return importlib.util.find_spec("opengl_basisu") is not None


def texels_of(model: Path, content: bytes, name: str) -> Image:
    """(h, w, 4) uint8, the first stored level no side of which is longer than MAX_TEXTURE_PX, or else the smallest.

    Raises UserError when it is too large, MalformedError naming `name` when it is damaged.
    """
    import opengl_basisu  # a megabyte of tables, for the few files that need them

    try:
        texture = opengl_basisu.open(content)
        size = texture.width, texture.height
        check_size(model, *size)
        longest = [max(size) >> level for level in range(texture.levels)]
        level = next((level for level, side in enumerate(longest) if side <= MAX_TEXTURE_PX), texture.levels - 1)
        texels = np.asarray(texture.transcode("rgba8", level=level).data, dtype=np.uint8)
    except (ValueError, RuntimeError, IndexError) as error:
        raise MalformedError(f"its {name} cannot be read as Basis Universal") from error
    if texels.ndim != 3 or texels.shape[2] != 4:
        raise MalformedError(f"its {name} is no picture of four channels")
    return texels
