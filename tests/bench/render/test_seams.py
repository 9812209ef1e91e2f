"""Seams are counted where they are, and borders and joints are none."""

import numpy as np
import pytest

from ashe_live.bench.render.seams import seam_pixels

WHERE = np.ones((60, 80), bool)


def _ground() -> np.ndarray:
    picture = np.full((60, 80, 3), 150, np.uint8)
    picture[:, 40:] = 60  # a shadow: its border is no seam
    return picture


@pytest.mark.parametrize("level", [200, 20])
def test_a_line_of_a_pixel_between_two_shadows_is_counted(level: int) -> None:
    picture = _ground()
    picture[10:50, 60] = level
    assert 30 <= seam_pixels(picture, (_ground(),), WHERE) <= 130


def test_neither_a_shadows_border_nor_what_the_photo_shows_too_is_one() -> None:
    assert seam_pixels(_ground(), (np.full((60, 80, 3), 150, np.uint8),), WHERE) == 0
    jointed = _ground()
    jointed[30] = 20
    assert seam_pixels(jointed, (_ground(), jointed), WHERE) == 0
