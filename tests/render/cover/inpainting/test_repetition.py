"""Patterns continue across a hole; grounds without one are told from them."""

import cv2
import numpy as np
import pytest

from ashe_live.render.cover.inpainting.filling import filled
from ashe_live.render.cover.inpainting.repetition import pattern_of

SIZE, SIDE_PX = 352, 64.0
AXIS = np.arange(SIZE) - (SIZE - 1) / 2
X, Y = np.meshgrid(AXIS, AXIS)
HOLE = np.maximum(np.abs(X), np.abs(Y)) < 0.7 * SIDE_PX
TURN = np.radians(24.0)
U, V = np.cos(TURN) * X + np.sin(TURN) * Y, np.cos(TURN) * Y - np.sin(TURN) * X


def _speckled(brightness: np.ndarray, contrast: float = 0.02) -> np.ndarray:
    """(n, n, 3) linear RGB of ground with this brightness (n, n)."""
    blobs = cv2.GaussianBlur(np.random.default_rng(5).normal(size=(SIZE, SIZE)), (0, 0), 1.5)
    return np.clip((brightness + contrast * blobs / blobs.std())[..., None] * (1.0, 0.9, 0.8), 0.02, 0.9).astype(
        np.float32
    )


def _checks(period: float) -> np.ndarray:
    """(n, n) dark and light squares, the edges a pixel wide."""
    waves = np.sin(2 * np.pi * U / period) * np.sin(2 * np.pi * V / period)
    return np.asarray(0.3 + 0.15 * np.clip(waves * period / np.pi, -1, 1))


def _tiles(period: float, shift: float = 0.0) -> np.ndarray:
    """(n, n) tiles with joints of three pixels, each row moved by a part of the period."""
    along = U + shift * period * np.floor(V / period)
    from_middle = np.maximum(np.abs(V % period - period / 2), np.abs(along % period - period / 2))
    return np.asarray(0.4 - 0.25 * np.clip(2.0 - period / 2 + from_middle, 0, 1))


def _contrast(ground: np.ndarray) -> np.ndarray:
    roots = np.sqrt(ground)
    level = cv2.GaussianBlur(roots, (0, 0), 0.5 * SIDE_PX)
    return np.asarray(np.where(HOLE[..., None], 0, roots / level - 1), np.float32)


@pytest.mark.parametrize(
    "pattern",
    [_checks(45.0), _checks(26.0), _tiles(70.0), _tiles(60.0, 0.5)],
    ids=["checks", "small", "tiles", "bricks"],
)
def test_a_pattern_goes_on_in_the_hole(pattern: np.ndarray) -> None:
    truth = _speckled(pattern)
    found = filled(np.where(HOLE[..., None], np.float32(0.8), truth), HOLE, ~HOLE, SIDE_PX)
    assert found is not None
    there, wanted = (cv2.GaussianBlur(each.mean(axis=2), (0, 0), 1.5)[HOLE] for each in (found, truth))
    assert np.corrcoef(there, wanted)[0, 1] > 0.9


@pytest.mark.parametrize("is_seen", [X > -30, (X > -30) & (Y > -30)], ids=["beside an edge", "in a corner"])
@pytest.mark.parametrize("period", [30.3, 40.0])
def test_a_pattern_goes_on_in_step_to_a_part_of_a_pixel(period: float, is_seen: np.ndarray) -> None:
    """Of ground on one side alone: shifts of opposite ones would be wrong by as much in opposite directions.

    The pixels in which shifts are found are 2.5 of the picture's. In the corner some of the hole is reached by the
    third step of the pattern only.
    """
    phase = 2 * np.pi / period
    wanted = 0.3 * np.sin(phase * X) * np.sin(phase * Y)
    contrast = np.repeat(np.where(HOLE, 0, wanted)[..., None], 3, axis=2).astype(np.float32)
    pattern = pattern_of(contrast, is_seen & ~HOLE, HOLE, SIDE_PX)
    assert pattern is not None
    there = pattern.is_there & HOLE
    assert there.sum() > 0.98 * HOLE.sum()
    excess = (pattern.contrast[..., 0] - wanted)[there]
    for along, across in ((X, Y), (Y, X)):
        slope = (0.3 * phase * np.cos(phase * along) * np.sin(phase * across))[there]
        assert abs(excess @ slope) < 0.03 * (slope @ slope), "moved by so many pixels"


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("period", [52.0, 68.0])
def test_a_pattern_is_found_among_shadows(period: float, seed: int) -> None:
    """By chance far shifts may look more alike than near ones, as they are told by little ground."""
    rng = np.random.default_rng(seed)
    shade = np.ones((SIZE, SIZE), np.float32)
    for _ in range(5):
        middle, axes, turn = rng.uniform(-170, 170, 2), rng.uniform((25, 15), (60, 30)), rng.uniform(0, np.pi)
        along = (X - middle[0]) * np.cos(turn) + (Y - middle[1]) * np.sin(turn)
        across = (Y - middle[1]) * np.cos(turn) - (X - middle[0]) * np.sin(turn)
        shade[np.square(along / axes[0]) + np.square(across / axes[1]) < 1] = 0.4
    in_picture = (X < 140) & (Y - 0.5 * X < 150)
    contrast = _contrast(_speckled(_checks(period)) * shade[..., None])
    assert pattern_of(contrast, ~HOLE & in_picture, HOLE, SIDE_PX) is not None


def test_where_tiles_differ_there_is_no_seam_between_those_that_are_copied() -> None:
    clouds = cv2.GaussianBlur(np.random.default_rng(3).normal(size=(SIZE, SIZE)), (0, 0), 9.0)
    period = 45.0
    truth = _speckled(_tiles(period) + 0.04 * clouds / clouds.std(), contrast=0.002)
    found = filled(np.where(HOLE[..., None], np.float32(0.8), truth), HOLE, ~HOLE, SIDE_PX)
    assert found is not None
    on_tile = np.maximum(np.abs(V % period - period / 2), np.abs(U % period - period / 2)) < 0.35 * period
    fine = [cv2.Laplacian(np.sqrt(each).mean(axis=2), cv2.CV_32F)[HOLE & on_tile] for each in (found, truth)]
    assert np.percentile(np.abs(fine[0]), 99.5) < 2 * np.percentile(np.abs(fine[1]), 99.5)


def test_a_thing_on_the_pattern_does_not_get_into_the_hole() -> None:
    truth = _speckled(_checks(45.0))
    with_thing = truth.copy()
    with_thing[150:190, 250:290] = (0.25, 0.5, 0.3)
    pattern = pattern_of(_contrast(with_thing), ~HOLE, HOLE, SIDE_PX)
    assert pattern is not None
    assert pattern.is_there[HOLE].mean() > 0.95
    contrast, wanted = (
        cv2.GaussianBlur(each.mean(axis=2), (0, 0), 1.5)[HOLE] for each in (pattern.contrast, np.sqrt(truth))
    )
    assert np.corrcoef(contrast, wanted)[0, 1] > 0.9


@pytest.mark.parametrize(
    "brightness",
    [
        np.full((SIZE, SIZE), 0.4),
        0.4 - 0.25 * np.clip(2.5 - np.abs(V - 12), 0, 1),  # a single joint
        0.4
        + 0.05
        * cv2.GaussianBlur(np.random.default_rng(2).normal(size=(SIZE, 1)), (0, 0), 2.0)
        * np.ones(SIZE),  # grain
    ],
    ids=["speckles", "joint", "grain"],
)
def test_what_does_not_repeat_in_two_directions_is_no_pattern(brightness: np.ndarray) -> None:
    assert pattern_of(_contrast(_speckled(brightness)), ~HOLE, HOLE, SIDE_PX) is None
