"""Pictures laid out as a sheet."""

import numpy as np
import pytest

from ashe_live.drawing.contact_sheet import contact_sheet


def test_every_picture_is_in_its_cell_over_its_label() -> None:
    colours = [(250, 10, 10), (10, 250, 10), (10, 10, 250), (250, 250, 10), (10, 250, 250)]
    images = [np.full((48, 64, 3), colour, np.uint8) for colour in colours]
    sheet = contact_sheet(images, [f"frame {i}" for i in range(5)], columns=3, thumbnail_width_px=64)
    cell_height, cell_width = (sheet.shape[0] - 8) // 2, (sheet.shape[1] - 8) // 3
    for i, colour in enumerate(colours):
        top, left = 8 + i // 3 * cell_height, 8 + i % 3 * cell_width
        np.testing.assert_array_equal(sheet[top + 24, left + 32], colour)
        assert sheet[top + 48 : top + 72, left : left + 64].max() > 200, "ink"
    assert sheet[8 + cell_height :, 8 + 2 * cell_width :].max() < 50, "the sixth cell is empty"


def test_contact_sheet_of_nothing_is_wrong_use() -> None:
    with pytest.raises(ValueError, match="no sheet"):
        contact_sheet([], [])
