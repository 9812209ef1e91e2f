"""Corners that nobody can read are followed by what moves as the marker does, not by what moves before it."""

import cv2
import numpy as np
import pytest

from ashe_live.tracking.edges.flow import flowed_corners

CORNERS = np.array([(120.0, 90.0), (230.0, 96.0), (222.0, 190.0), (114.0, 182.0)])


def printed() -> np.ndarray:
    """A marker on paper, on a table with a grain."""
    rng = np.random.default_rng(3)
    ground = cv2.GaussianBlur(rng.uniform(90, 170, (300, 400)), (0, 0), 2)
    picture = np.asarray(150 + 4 * (ground - 130), np.float32)
    cells = np.full((10, 10), 235, np.float32)
    cells[1:9, 1:9] = 30
    cells[2:8, 2:8] = rng.choice([30, 235], (6, 6))
    big = cv2.resize(cells, (400, 400), interpolation=cv2.INTER_NEAREST)
    square = np.array([(40, 40), (360, 40), (360, 360), (40, 360)], np.float32) - 0.5
    H = cv2.getPerspectiveTransform(square, CORNERS.astype(np.float32))
    onto = cv2.warpPerspective(big, H, (400, 300), flags=cv2.INTER_AREA)
    inside = cv2.warpPerspective(np.ones_like(big), H, (400, 300)) > 0.5
    picture[inside] = onto[inside]
    return cv2.GaussianBlur(picture, (0, 0), 0.7)


def with_hand(picture: np.ndarray, right: float, down: float) -> np.ndarray:
    """A thing with a grain of its own before the marker's right part."""
    grain = cv2.GaussianBlur(np.random.default_rng(8).uniform(0, 255, (300, 400)), (0, 0), 2).astype(np.float32)
    hand = 120 + 3 * (grain - 127)
    mask = np.zeros((300, 400), np.float32)
    cv2.ellipse(mask, (215, 150), (50, 60), 20, 0, 360, 1.0, -1, cv2.LINE_AA)
    shift = np.array([(1.0, 0.0, right), (0.0, 1.0, down)])
    hand, mask = (cv2.warpAffine(each, shift, (400, 300)) for each in (hand, mask))
    return picture * (1 - mask) + hand * mask


def bgr(picture: np.ndarray, seed: int) -> np.ndarray:
    noisy = picture + np.random.default_rng(seed).normal(0, 1.5, picture.shape)
    return np.dstack([np.clip(np.round(noisy), 0, 255).astype(np.uint8)] * 3)


@pytest.mark.parametrize("down", [-7.0, -4.0, 3.0, 6.0])
@pytest.mark.parametrize("right", [-6.0, -3.0, 2.0, 4.0, 8.0])
def test_a_hand_that_moves_before_a_still_marker_moves_no_corner(right, down) -> None:
    still = printed()
    for seed in range(2):
        before, now = bgr(with_hand(still, 0, 0), 2 * seed), bgr(with_hand(still, right, down), 2 * seed + 1)
        corners = flowed_corners(before, now, CORNERS)
        assert corners is not None
        assert np.abs(corners - CORNERS).max() < 1.0


def test_a_marker_that_comes_nearer_and_turns_is_followed() -> None:
    turn = cv2.getRotationMatrix2D((170.0, 140.0), 3.0, 1.03) + np.array([(0, 0, 4.0), (0, 0, -3.0)])
    moved = cv2.warpAffine(printed(), turn, (400, 300), borderMode=cv2.BORDER_REFLECT)
    corners = flowed_corners(bgr(printed(), 0), bgr(moved, 1), CORNERS)
    assert corners is not None
    np.testing.assert_allclose(corners, CORNERS @ turn[:, :2].T + turn[:, 2], atol=0.4)


def test_a_marker_that_tilts_fast_is_followed_as_well() -> None:
    middle = CORNERS.mean(axis=0)
    tilt = np.diag([1.0, 0.9])
    shift = middle - tilt @ middle
    moved = cv2.warpAffine(printed(), np.column_stack([tilt, shift]), (400, 300), borderMode=cv2.BORDER_REFLECT)
    corners = flowed_corners(bgr(printed(), 0), bgr(moved, 1), CORNERS)
    assert corners is not None
    np.testing.assert_allclose(corners, CORNERS @ tilt.T + shift, atol=0.6)
