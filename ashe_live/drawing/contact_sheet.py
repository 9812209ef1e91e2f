"""Lays pictures out as labelled thumbnails: a clip at a glance, for those without a display."""

from collections.abc import Sequence

import numpy as np
import PIL.Image
from PIL import ImageDraw

from ashe_live.core.arrays import Image
from ashe_live.drawing.colours import INK_BGR, PAPER_BGR
from ashe_live.files.fonts import lettering

GAP_PX = 8
LABEL_HEIGHT_PX, INDENT_PX = 24, 2
FONT_SIZE_PX = 16
TALLEST = 4.0  # of a thumbnail's height over the width: taller pictures become narrower, or a sheet would have no end


def contact_sheet(
    images_bgr: Sequence[Image], labels: Sequence[str], columns: int = 4, thumbnail_width_px: int = 320
) -> Image:
    """(h, w, 3) uint8 BGR: each (h, w, 3) uint8 image over its label, row by row. Raises ValueError without images.

    A label wider than its thumbnail goes on below.
    """
    # Pillow calls the channels red, green and blue, and treats them alike: they can stay in OpenCV's order.
    if not images_bgr or len(images_bgr) != len(labels) or columns < 1:
        raise ValueError(f"{len(images_bgr)} images with {len(labels)} labels make no sheet of {columns} columns")
    thumbnails = [_thumbnail(image, thumbnail_width_px) for image in images_bgr]
    wrapped = [_wrapped(label, thumbnail_width_px - 2 * INDENT_PX) for label in labels]
    label_height = LABEL_HEIGHT_PX * max(map(len, wrapped))
    columns = min(columns, len(thumbnails))
    rows = -(-len(thumbnails) // columns)
    cell_width = thumbnail_width_px + GAP_PX
    cell_height = max(thumbnail.height for thumbnail in thumbnails) + label_height + GAP_PX
    sheet = PIL.Image.new("RGB", (columns * cell_width + GAP_PX, rows * cell_height + GAP_PX), PAPER_BGR)
    draw = ImageDraw.Draw(sheet)
    for number, (thumbnail, lines) in enumerate(zip(thumbnails, wrapped, strict=True)):
        row, column = divmod(number, columns)
        left, top = GAP_PX + column * cell_width, GAP_PX + row * cell_height
        sheet.paste(thumbnail, (left, top))
        for below, line in enumerate(lines):
            middle = top + thumbnail.height + LABEL_HEIGHT_PX * (below + 0.5)
            text, font = lettering(line, FONT_SIZE_PX)
            draw.text((left + INDENT_PX, middle), text, INK_BGR, font, anchor="lm")
    return np.array(sheet)


def _wrapped(label: str, width_px: int) -> list[str]:
    """The lines of a label, one at least, each no wider than `width_px` unless a single word is."""
    lines = [""]
    for word in label.split():
        longer = f"{lines[-1]} {word}".lstrip()
        text, font = lettering(longer, FONT_SIZE_PX)
        if lines[-1] and font.getlength(text) > width_px:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines


def _thumbnail(image_bgr: Image, width_px: int) -> PIL.Image.Image:
    height, width = image_bgr.shape[:2]
    scale = min(width_px / width, TALLEST * width_px / height)
    size = max(1, round(scale * width)), max(1, round(scale * height))
    return PIL.Image.fromarray(np.ascontiguousarray(image_bgr)).resize(size, PIL.Image.Resampling.LANCZOS)
