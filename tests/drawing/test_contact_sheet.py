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


def test_a_long_label_is_read_to_its_end_below_its_picture() -> None:
    images = [np.full((48, 200, 3), 90, np.uint8)] * 2
    short, long = "regions 2", "none: the shadow seems to leave the picture: show its far end"
    sheet = contact_sheet(images, [long, short], columns=2, thumbnail_width_px=200)
    of_long, of_short = (sheet[8 + 48 : -8, left : left + 200] for left in (8, 8 + 208))
    assert len(of_long) > 2 * 24
    assert of_long[24:48].max() > 200, "the label goes on"
    assert sheet[:, 208 : 208 + 8].max() < 50, "and not into the next cell"
    assert of_short[24:].max() < 50


def test_a_very_tall_picture_is_shown_whole_and_makes_no_endless_sheet() -> None:
    tall = np.zeros((40_000, 4, 3), np.uint8)
    tall[-400:] = tall[:400] = (0, 0, 255)
    sheet = contact_sheet([tall, np.full((48, 64, 3), 90, np.uint8)], ["tall", "wide"], thumbnail_width_px=64)
    assert len(sheet) < 10 * 64
    column = sheet[:, 8]
    reds = np.flatnonzero(column[:, 2].astype(int) - column[:, 0] > 100)
    assert reds.min() == 8, "its top"
    assert reds.max() == 8 + 4 * 64 - 1, "and its bottom"


def test_contact_sheet_of_nothing_is_wrong_use() -> None:
    with pytest.raises(ValueError, match="no sheet"):
        contact_sheet([], [])
