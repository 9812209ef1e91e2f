"""Lines of the ground go on beneath what is covered, where both sides show them, and nowhere else."""

import cv2
import numpy as np
import pytest

from ashe_live.render.cover.inpainting.straight_lines import straight_lines

SIZE, SIDE_PX = 352, 64.0
CONTRAST = 0.12
AXIS = np.arange(SIZE) - (SIZE - 1) / 2
X, Y = np.meshgrid(AXIS, AXIS)
HOLE = np.maximum(np.abs(X), np.abs(Y)) < 0.75 * SIDE_PX


def _line(direction_deg: float, offset_px: float, width_px: float = 6.0) -> np.ndarray:
    """(n, n) 1 on a line, with soft borders."""
    angle = np.radians(direction_deg)
    across = X * np.sin(angle) + Y * np.cos(angle) - offset_px
    return np.clip(0.5 + width_px / 2 - np.abs(across), 0, 1)


def _detail(line: np.ndarray, seed: int = 0) -> np.ndarray:
    texture = np.random.default_rng(seed).normal(0, 0.01, (SIZE, SIZE, 3))
    return np.where(HOLE[..., None], 0, texture - CONTRAST * line[..., None]).astype(np.float32)


@pytest.mark.parametrize("direction", [0.0, 7.3, 45.0, 90.0, 128.6, 171.0])
@pytest.mark.parametrize("offset", [0.0, -22.0])
def test_a_line_is_continued_where_it_goes(direction: float, offset: float) -> None:
    line = _line(direction, offset)
    found = straight_lines(_detail(line), HOLE, ~HOLE, SIDE_PX)
    on, off = HOLE & (line == 1), HOLE & (_line(direction, offset, 14.0) == 0)
    assert found[on].mean() == pytest.approx(-CONTRAST, rel=0.2)
    assert np.abs(found[off]).mean() < 0.1 * CONTRAST


@pytest.mark.parametrize("beside_deg", [-1.5, 1.5])
def test_a_seam_is_continued_where_it_goes_beside_grain_of_nearly_its_direction(beside_deg: float) -> None:
    seam = _line(beside_deg, 8.0, 4.0)
    grain = np.max([_line(0.0, offset, 5.0) for offset in (-40.0, -30.0, -20.0, -10.0, 24.0, 34.0)], axis=0)
    found = straight_lines(_detail(np.maximum(seam, 0.5 * grain)), HOLE, ~HOLE, SIDE_PX)
    assert found[HOLE & (seam == 1)].mean() == pytest.approx(-CONTRAST, rel=0.25)


def test_lines_that_cross_are_not_twice_as_dark() -> None:
    first, second = _line(20.0, 5.0), _line(110.0, -8.0)
    found = straight_lines(_detail(np.maximum(first, second)), HOLE, ~HOLE, SIDE_PX)
    for line in (first, second):
        assert found[HOLE & (line == 1)].mean() == pytest.approx(-CONTRAST, rel=0.2)
    assert found[HOLE & (first == 1) & (second == 1)].mean() == pytest.approx(-CONTRAST, rel=0.2)


def test_what_one_side_alone_shows_is_not_continued() -> None:
    one_sided = _line(0.0, 0.0) * (X < 0)
    found = straight_lines(_detail(one_sided), HOLE, ~HOLE, SIDE_PX)
    assert np.abs(found[HOLE]).mean() < 0.02 * CONTRAST


@pytest.mark.parametrize("seed", range(5))
def test_texture_is_no_line(seed: int) -> None:
    found = straight_lines(_detail(np.zeros((SIZE, SIZE)), seed), HOLE, ~HOLE, SIDE_PX)
    assert np.abs(found[HOLE]).mean() < 0.002


def test_nothing_is_drawn_where_no_ground_is_seen() -> None:
    found = straight_lines(np.zeros((SIZE, SIZE, 3), np.float32), HOLE, np.zeros_like(HOLE), SIDE_PX)
    assert not found.any()


def test_broad_grain_is_continued_in_its_own_direction_alone() -> None:
    """Its shading, seen askew, looks like wide bands; drawn, they would cross the grain."""
    direction = np.radians(10.0)
    turn, middle = cv2.getRotationMatrix2D((SIZE, SIZE), 10, 1), slice(SIZE // 2, SIZE // 2 + SIZE)
    shares = []
    for seed in range(6):
        noise = np.random.default_rng(seed).normal(size=(2 * SIZE, 2 * SIZE))
        turned = cv2.warpAffine(cv2.GaussianBlur(noise, (0, 0), 60, sigmaY=6), turn, noise.shape)[middle, middle]
        found = straight_lines(_detail(-0.5 * turned / turned.std(), seed), HOLE, ~HOLE, SIDE_PX).mean(axis=2)
        down, right = np.gradient(found)
        along = right * np.cos(direction) - down * np.sin(direction)
        over = right * np.sin(direction) + down * np.cos(direction)
        shares.append(np.square(along[HOLE]).sum() / np.square(over[HOLE]).sum())
    assert np.mean(shares) < 0.045  # 0.06 with bands that cross it
