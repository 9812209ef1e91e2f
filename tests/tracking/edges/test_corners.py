"""Sub-pixel corners: measured against squares whose true corners are known."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.tracking.edges.corners import refined_corners
from tests.tracking.conftest import exposed

TILTED = np.array([(60.3, 50.7), (150.8, 62.2), (160.4, 140.1), (48.9, 128.6)])


def drawn(corners_px: Float, dark: int = 20, light: int = 230, blur_px: float = 0.8) -> Image:
    """A dark quadrilateral on a light ground, blurred in linear light; pixel centres at integers."""
    fine = 16
    image = np.full((200 * fine, 220 * fine), light, dtype=np.uint8)
    cv2.fillConvexPoly(image, np.round((corners_px + 0.5) * fine - 0.5).astype(np.int32), dark)
    return exposed(image, (220, 200), blur_px).round().astype(np.uint8)


@pytest.mark.parametrize("samples", [16, 64])
@pytest.mark.parametrize("blur_px", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("off_by_px", [0.0, 1.0])
def test_corners_are_found_to_a_sixteenth_of_a_pixel_or_of_the_blur(
    samples: int, blur_px: float, off_by_px: float
) -> None:
    moved = TILTED + off_by_px * np.array([(1, 1), (-1, 1), (1, -1), (-1, -1)])
    found = refined_corners(drawn(TILTED, blur_px=blur_px), moved, samples)
    assert np.abs(found - TILTED).max() < 0.06 * max(1.0, blur_px)


def test_grey_values_do_not_move_the_corners() -> None:
    for dark, light in ((0, 255), (90, 130), (200, 255)):
        assert np.abs(refined_corners(drawn(TILTED, dark, light), TILTED + 0.7, 32) - TILTED).max() < 0.15


def test_an_edge_that_is_partly_hidden_is_still_found() -> None:
    image = drawn(TILTED)
    image[40:75, 90:115] = 128
    assert np.abs(refined_corners(image, TILTED + 0.5, 32) - TILTED).max() < 0.3


def test_the_edge_of_thin_paper_is_not_taken_for_the_square() -> None:
    """White paper that ends a few pixels outside, on a ground as dark as the square."""
    image = drawn(TILTED)
    centre = TILTED.mean(axis=0)
    paper = np.zeros(image.shape, dtype=np.uint8)
    cv2.fillConvexPoly(paper, np.round(centre + (TILTED - centre) * 1.15).astype(np.int32), 255)
    image = np.asarray(cv2.GaussianBlur(np.where(paper > 0, image, 20).astype(np.uint8), (0, 0), 0.6), dtype=np.uint8)
    assert np.abs(refined_corners(image, TILTED + 1.0, 32) - TILTED).max() < 0.2


@pytest.mark.parametrize("value", [0, 128, 255])
def test_where_there_is_no_edge_the_corners_stay(value: int) -> None:
    image = np.full((200, 220), value, dtype=np.uint8)
    assert refined_corners(image, TILTED, 32) == pytest.approx(TILTED, abs=1e-9)


def test_corners_that_are_no_square_stay() -> None:
    line = np.array([(0, 0), (1, 1), (2, 2), (3, 3)]) * 10.0
    assert np.array_equal(refined_corners(drawn(TILTED), line, 32), line)
    broken = np.full((4, 2), np.nan)
    assert np.isnan(refined_corners(drawn(TILTED), broken, 32)).all()


def test_corners_outside_the_picture_are_no_error() -> None:
    assert np.isfinite(refined_corners(drawn(TILTED), TILTED + 500, 32)).all()
