"""Writes a picture as PNG, whole or not at all."""

from pathlib import Path

import cv2

from ashe_live.core.arrays import Image
from ashe_live.core.output_files import check_output, written_whole


def write_png(path: str | Path, image_bgr: Image, overwrite: bool = False) -> None:
    """Writes (h, w, 3) uint8. Raises UserError when `path` exists (without `overwrite`) or cannot be written."""
    path = Path(path)
    check_output(path, overwrite)
    encoded_well, png = cv2.imencode(".png", image_bgr)
    if not encoded_well:
        raise ValueError(f"an image of shape {image_bgr.shape} cannot be a PNG")
    with written_whole(path) as partial:
        partial.write_bytes(png.tobytes())
