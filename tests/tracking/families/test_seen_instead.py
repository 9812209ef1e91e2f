"""What is said of a picture in which the followed marker is not found."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.families.seen_instead import ALL_BLACK, ALL_WHITE, SeenInstead, seen_instead

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
        assert seen_instead(exposed(table, times)) == SeenInstead((SEVEN,))
    spotlit = np.zeros_like(table)
    spotlit[150:330, 230:410] = table[150:330, 230:410]
    assert seen_instead(spotlit) == SeenInstead((SEVEN,))
    mirrored = np.ascontiguousarray(spotlit[:, ::-1])
    assert seen_instead(mirrored) == SeenInstead(mirrored=(SEVEN,))


def test_where_no_marker_can_be_seen_for_it_the_exposure_is_named(table: Image) -> None:
    assert seen_instead(exposed(table, 0.01)) == SeenInstead(fault=ALL_BLACK)
    table[table < 100] = 100  # as veiling glare does with ink
    assert seen_instead(exposed(table, 3.0)) == SeenInstead(fault=ALL_WHITE)


def test_a_picture_of_other_things_is_neither_black_nor_white(table: Image) -> None:
    """Nor is one half of which is, such as a document on a dark table."""
    bare = np.full_like(table, 120)
    half = bare.copy()
    half[:240] = 255
    half[240:400] = 0
    for picture in (bare, half):
        assert seen_instead(picture) == SeenInstead()
