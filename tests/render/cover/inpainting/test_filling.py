"""A hole in the ground gets its texture, its lines and its light, and nothing of the things that stand on it."""

import cv2
import numpy as np
import pytest

from ashe_live.render.cover.inpainting.filling import BLEED_SIDES, filled

SIZE, SIDE_PX = 352, 64.0
AXIS = np.arange(SIZE) - (SIZE - 1) / 2
X, Y = np.meshgrid(AXIS, AXIS)
HOLE = np.maximum(np.abs(X), np.abs(Y)) < 0.7 * SIDE_PX
BESIDE = (np.maximum(np.abs(X), np.abs(Y)) > 0.9 * SIDE_PX) & (np.maximum(np.abs(X), np.abs(Y)) < 1.8 * SIDE_PX)
PAPER = 0.8


def _ground(contrast: float = 0.08) -> np.ndarray:
    """(n, n, 3) linear RGB of speckled stone, the blobs some pixels wide."""
    noise = np.random.default_rng(5).normal(size=(SIZE, SIZE))
    blobs = cv2.GaussianBlur(noise, (0, 0), 1.5)
    return np.clip(0.4 + contrast * blobs[..., None] / blobs.std() * (1.0, 0.9, 0.8), 0.05, 0.9).astype(np.float32)


def _filled(ground: np.ndarray, is_source: np.ndarray | None = None) -> np.ndarray:
    with_sheet = np.where(HOLE[..., None], np.float32(PAPER), ground)
    found = filled(with_sheet, HOLE, ~HOLE if is_source is None else is_source, SIDE_PX)
    assert found is not None
    far = np.maximum(np.abs(X), np.abs(Y)) > (0.7 + BLEED_SIDES) * SIDE_PX + 1
    np.testing.assert_array_equal(found[far], ground[far])
    return found


def test_texture_in_the_hole_is_neither_smoother_nor_rougher() -> None:
    found = _filled(_ground())
    fine = np.sqrt(found).mean(axis=2) - cv2.GaussianBlur(np.sqrt(found).mean(axis=2), (0, 0), 2.0)
    assert fine[HOLE].std() == pytest.approx(fine[BESIDE].std(), rel=0.15)
    assert found[HOLE].mean() == pytest.approx(found[BESIDE].mean(), rel=0.03)


def test_ground_that_is_rougher_here_than_elsewhere_is_so_in_the_hole() -> None:
    """Patches come from anywhere, and what is blended is smoother."""
    square = np.maximum(np.abs(X), np.abs(Y))
    grain = cv2.GaussianBlur(np.random.default_rng(5).normal(size=(SIZE, SIZE)), (0, 0), 1.0)
    contrast = np.where(square < 1.3 * SIDE_PX, 0.06, 0.035)
    ground = np.clip(0.4 + (contrast * grain / grain.std())[..., None], 0.05, 0.9)
    found = np.sqrt(_filled(np.repeat(ground, 3, axis=2).astype(np.float32))).mean(axis=2)
    fine = found - cv2.GaussianBlur(found, (0, 0), 2.0)
    ring = (square > 0.8 * SIDE_PX) & (square < 1.15 * SIDE_PX)
    assert 0.75 < fine[HOLE].std() / fine[ring].std() < 1.1


def test_light_that_falls_off_goes_on_falling_off() -> None:
    slope = (1 + 0.3 * X / SIZE)[..., None].astype(np.float32)
    found = _filled(_ground(0.02) * slope)
    smooth = cv2.GaussianBlur(found / slope, (0, 0), 8.0)
    assert smooth[HOLE].mean() == pytest.approx(0.4, rel=0.02)
    assert np.abs(smooth[HOLE].mean(axis=-1) - 0.4).max() < 0.03


def test_a_joint_is_not_interrupted() -> None:
    across = 0.3 * X + np.sqrt(1 - 0.3**2) * Y - 12
    joint = np.clip(3.5 - np.abs(across), 0, 1)[..., None].astype(np.float32)
    truth = _ground(0.02) * (1 - 0.6 * joint)
    found = _filled(truth)
    along = cv2.GaussianBlur(found.mean(axis=2), (0, 0), 1.0)
    on = HOLE & (np.abs(across) < 1)
    assert np.percentile(along[on], 98) < 0.26  # 0.16 on the joint, 0.4 beside it
    assert found[HOLE & (np.abs(across) > 8)].mean() == pytest.approx(0.4, rel=0.05)


def test_a_joint_has_the_grain_that_it_has_beside_the_hole() -> None:
    """It was a smooth stroke there: what both sides show along it is the same all along."""
    on = np.abs(Y - 12) < 6
    truth = _ground(0.02) * (1 - 0.4 * on[..., None]).astype(np.float32)
    found = np.log(_filled(truth).mean(axis=2))
    fine = found - cv2.GaussianBlur(found, (0, 0), 2.0)
    middle = np.abs(Y - 12) < 3
    beside = middle & (np.abs(X) > 0.8 * SIDE_PX) & (np.abs(X) < 1.8 * SIDE_PX)
    assert fine[HOLE & middle].std() == pytest.approx(fine[beside].std(), rel=0.3)


@pytest.mark.parametrize("seed", [7, 8, 9])
def test_patches_of_grain_have_no_seams_between_them(seed: int) -> None:
    noise = np.random.default_rng(seed).normal(size=(SIZE, SIZE))
    streaks = cv2.GaussianBlur(noise, (0, 0), 12.0, sigmaY=1.5)
    ground = np.repeat(np.clip(0.4 + 0.05 * streaks[..., None] / streaks.std(), 0.05, 0.9), 3, axis=2)
    along_grain = np.abs(np.diff(_filled(ground.astype(np.float32)).mean(axis=2), axis=1))
    far_inside, beside = np.abs(AXIS) < 0.5 * SIDE_PX, AXIS < -SIDE_PX
    assert along_grain[np.ix_(far_inside, far_inside[:-1])].mean(axis=0).max() < 3 * along_grain[:, beside[:-1]].mean()


@pytest.mark.parametrize("seed", [7, 8, 9])
def test_the_cover_of_pebbles_meets_those_beside_it(seed: int) -> None:
    """No patch continues them all; but the picture has no step along the cover's border."""
    noise = np.random.default_rng(seed).normal(size=(SIZE, SIZE))
    pebbles = cv2.GaussianBlur(noise, (0, 0), 5.0)
    ground = np.repeat(np.clip(0.4 + 0.1 * pebbles[..., None] / pebbles.std(), 0.05, 0.9), 3, axis=2)
    found = _filled(ground.astype(np.float32)).mean(axis=2)
    inside = cv2.distanceTransform((~HOLE).astype(np.uint8), cv2.DIST_L2, 5) < BLEED_SIDES * SIDE_PX
    steps, crosses = np.abs(np.diff(found, axis=1)), inside[:, 1:] != inside[:, :-1]
    assert steps[crosses].mean() < 1.8 * steps[:, AXIS[:-1] < -SIDE_PX].mean()


def test_no_piece_of_a_joint_that_passes_by_is_copied() -> None:
    """It would lie in the hole's texture, cut off at both ends."""
    across = Y + 0.2 * X + 0.95 * SIDE_PX
    joint = np.clip(3.5 - np.abs(across), 0, 1)[..., None].astype(np.float32)
    found = _filled(_ground(0.02) * (1 - 0.6 * joint))
    smooth = cv2.GaussianBlur(found.mean(axis=2), (0, 0), 1.0)
    assert smooth[HOLE].min() > 0.3  # 0.16 on the joint, 0.36 beside it


def test_no_dark_thing_that_stands_beside_is_copied() -> None:
    ground = _ground(0.02)
    thing = (np.abs(X - 1.1 * SIDE_PX) < 0.3 * SIDE_PX) & (np.abs(Y) < 0.4 * SIDE_PX)
    ground[thing] = 0.06
    assert _filled(ground)[HOLE].min() > 0.25


def test_a_highlight_that_reaches_the_sheet_has_no_edge_there() -> None:
    """It is not copied, as an object is not; but its light goes on, and does not end where the sheet was."""
    middle = 1.1 * SIDE_PX
    light = 1 + 0.8 * np.exp(-((X - middle) ** 2 + Y**2) / (2 * (0.45 * SIDE_PX) ** 2))
    truth = _ground(0.02) * light[..., None].astype(np.float32)
    found = cv2.GaussianBlur(_filled(truth), (0, 0), 4.0) / cv2.GaussianBlur(truth, (0, 0), 4.0)
    inside = (np.abs(X - 0.7 * SIDE_PX) < 3) & (np.abs(Y) < 0.3 * SIDE_PX)
    np.testing.assert_allclose(found[inside].mean(), 1.0, atol=0.06)
    far = HOLE & (X < 0)
    np.testing.assert_allclose(found[far].mean(), 1.0, atol=0.06)


@pytest.mark.parametrize("brightness", [0.9, 0.05])
def test_a_thing_beside_the_sheet_sheds_no_light_into_the_hole(brightness: float) -> None:
    truth = _ground(0.02)
    truth[(np.abs(X - 1.2 * SIDE_PX) < 0.38 * SIDE_PX) & (np.abs(Y) < 0.4 * SIDE_PX)] = brightness
    inside = (X > 0.5 * SIDE_PX) & (X < 0.7 * SIDE_PX) & (np.abs(Y) < 0.3 * SIDE_PX)
    np.testing.assert_allclose(_filled(truth)[inside].mean(), 0.4, atol=0.02)


@pytest.mark.parametrize("colour", [(0.1, 0.5, 0.05), (0.3, 0.05, 0.02)])
def test_a_coloured_thing_nearby_does_not_tint_what_is_filled_in(colour: tuple[float, ...]) -> None:
    truth = _ground(0.02)
    truth[np.hypot(X - 1.95 * SIDE_PX, Y) < 0.7 * SIDE_PX] = colour
    inside = (X > 0.3 * SIDE_PX) & (X < 0.7 * SIDE_PX) & (np.abs(Y) < 0.4 * SIDE_PX)
    np.testing.assert_allclose(_filled(truth)[inside].mean(axis=0), 0.4, atol=0.005)


def test_without_a_whole_patch_of_ground_there_is_none() -> None:
    with_sheet = np.full((SIZE, SIZE, 3), PAPER, np.float32)
    nowhere = np.zeros((SIZE, SIZE), bool)
    assert filled(with_sheet, HOLE, nowhere, SIDE_PX) is None
