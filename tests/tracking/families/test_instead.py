"""What is said of a picture in which the followed marker is not found."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.tracking.families.instead import TOO_BRIGHT, TOO_DARK, Instead, shown_instead
from ashe_live.tracking.families.markers import parse_marker

SEVEN = "aruco:4x4_50:7"


@pytest.fixture
def table() -> Image:
    """A print on grey paper, with noise as a camera's."""
    grey = np.full((480, 640), 190, np.uint8)
    grey[170:310, 250:390] = parse_marker(SEVEN).bitmap(140)
    noise = np.random.default_rng(3).normal(0, 3, (480, 640, 1))
    return np.clip(cv2.cvtColor(cv2.GaussianBlur(grey, (0, 0), 0.8), cv2.COLOR_GRAY2BGR) + noise, 0, 255).astype(
        np.uint8
    )


def exposed(picture: Image, times: float) -> Image:
    return np.clip(picture * times, 0, 255).astype(np.uint8)


def test_a_marker_comes_before_the_exposure(table: Image) -> None:
    """It is read at a tenth of its brightness, and is in the way of no one where all around it is black."""
    for times in (1.0, 0.12):
        assert shown_instead(exposed(table, times)) == Instead((SEVEN,))
    spotlit = np.zeros_like(table)
    spotlit[150:330, 230:410] = table[150:330, 230:410]
    assert shown_instead(spotlit) == Instead((SEVEN,))
    mirrored = np.ascontiguousarray(spotlit[:, ::-1])
    assert shown_instead(mirrored) == Instead(mirrored=(SEVEN,))


def test_where_no_marker_can_be_seen_for_it_the_exposure_is_named(table: Image) -> None:
    assert shown_instead(exposed(table, 0.01)) == Instead(fault=TOO_DARK)
    table[table < 100] = 100  # as veiling glare does with ink
    assert shown_instead(exposed(table, 3.0)) == Instead(fault=TOO_BRIGHT)


def test_a_picture_of_other_things_is_neither_black_nor_white(table: Image) -> None:
    """Nor is one half of which is, such as a document on a dark table."""
    bare = np.full_like(table, 120)
    half = bare.copy()
    half[:240] = 255
    half[240:400] = 0
    for picture in (bare, half):
        assert shown_instead(picture) == Instead()
