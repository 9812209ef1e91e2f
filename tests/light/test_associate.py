"""Which of what stands out is shadow, on painted scenes whose ratio of shadow to light is known."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.light.associate import AssociateSteps, Split, classified, splits
from ashe_live.light.ground import GroundSteps, LitGround, fit_lit_ground, unlit_mask
from ashe_live.light.log_colour import CHROMA_WEIGHT, DARKEST, linear_rgb, log_opponent
from ashe_live.light.shift import shadow_ratio, shadow_shifts
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, Caster, Painted, overlap, paint

SIZE = (320, 240)
STEPS = AssociateSteps()


def stages_before(scene: Painted) -> tuple[LitGround, Mask, Mask]:
    is_ground = scene.beside_sheet
    ground = fit_lit_ground(scene.tracked.frame.image_bgr, is_ground, GroundSteps())
    assert ground is not None
    return ground, unlit_mask(ground, is_ground, 40), is_ground


def explained(scene: Painted) -> list[Split]:
    ground, unlit, is_ground = stages_before(scene)
    return splits(ground, unlit, is_ground, STEPS)


def opponent(red: float, green: float, blue: float) -> Float:
    """(3,) of the logs of a linear RGB colour, or of a ratio of two."""
    return np.array([(red + green + blue) / 3, CHROMA_WEIGHT * (red - blue), CHROMA_WEIGHT * (red + blue - 2 * green)])


def log_opponent_of(linear_rgb: Float) -> Float:
    return opponent(*np.log(linear_rgb + DARKEST))


def shift_of(ratio_rgb: Float) -> Float:
    """On a ground so light that nothing is lost in the dark."""
    return opponent(*np.log(ratio_rgb))


def ground_of(colour: Float) -> LitGround:
    """A ground of this one log-opponent colour (3,)."""
    one = np.ones(1, np.float32)
    return LitGround(np.zeros((1, 1, 3)), np.zeros((5, 3)), colour[None], np.eye(3)[None], one, one, one)


def goodness(split: Split, scene: Painted) -> float:
    return min(overlap(split.object_mask, scene.body), overlap(split.shadow_mask, scene.shadow))


def test_log_opponent_colours_are_those_of_the_picture():
    image = np.random.default_rng(1).integers(0, 256, (6, 8, 3)).astype(np.uint8)
    expected = LINEAR_FROM_SRGB_8BIT[image[..., ::-1]]
    np.testing.assert_allclose(linear_rgb(log_opponent(image, smoothing_px=0)), expected, atol=1e-6)


@pytest.mark.parametrize("ratio", [(1.0, 1.0, 1.0), (0.2, 0.3, 0.45), (0.05, 0.05, 0.05), (0.9, 0.8, 0.7)])
@pytest.mark.parametrize("level", [255, 128, 64])
def test_a_shift_is_a_ratio_on_grounds_light_and_dark(ratio, level):
    lit_rgb = np.array([0.9, 1.0, 0.7]) * LINEAR_FROM_SRGB_8BIT[level]
    lit, shaded = (log_opponent_of(rgb) for rgb in (lit_rgb, lit_rgb * ratio))
    np.testing.assert_allclose(shadow_ratio(ground_of(lit), shaded - lit), ratio, rtol=1e-6)


def test_a_shadow_is_never_brighter_than_its_ground():
    lit, brighter = (log_opponent_of(np.array(rgb)) for rgb in ((0.4, 0.4, 0.4), (0.6, 0.5, 0.3)))
    assert (shadow_ratio(ground_of(lit), brighter - lit) <= 1).all()


def test_the_shift_of_a_picture_is_the_ratio_it_was_shaded_by():
    scene = paint(BOX, size=SIZE, noise_levels=0.3)
    empty = paint(size=SIZE, noise_levels=0.3)
    inner = cv2.erode(scene.shadow.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    shaded, lit = (log_opponent(s.tracked.frame.image_bgr)[inner].mean(axis=0) for s in (scene, empty))
    np.testing.assert_allclose(shadow_ratio(ground_of(lit), shaded - lit), SHADOW_RATIO, rtol=0.03)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_true_shift_is_among_those_voted_for(ground, caster):
    fitted, unlit, _ = stages_before(paint(caster, ground=ground, size=SIZE))
    shifts = shadow_shifts(fitted, unlit, STEPS.shifts)
    assert 1 <= len(shifts) <= STEPS.shifts
    off = min(np.abs(shadow_ratio(fitted, shift) / SHADOW_RATIO - 1).max() for shift in shifts)
    # Each brick has its own brightness, so that its shadow has one as well.
    assert off < (0.2 if ground == "bricks" else 0.1)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_one_explanation_is_the_true_one(ground, caster):
    scene = paint(caster, ground=ground, size=SIZE)
    best = max(explained(scene), key=lambda split: goodness(split, scene))
    assert overlap(best.object_mask, scene.body) > 0.8
    assert overlap(best.shadow_mask, scene.shadow) > 0.7


@pytest.mark.parametrize("ground", ["plain", "checkered"])
def test_an_explanation_gives_no_pixel_twice_and_none_of_the_sheet(ground):
    scene = paint(BOX, ground=ground, size=SIZE)
    found = explained(scene)
    assert found
    for split in found:
        assert not (split.object_mask & split.shadow_mask).any()
        assert split.object_mask.any()
        assert split.shadow_mask.any()
        assert not (split.shadow_mask & scene.sheet).any()
        assert np.isfinite(split.shift).all()


def test_an_object_as_dark_as_its_shadow_is_told_apart_by_colour():
    scene = paint(Caster(rgb=(0.16, 0.05, 0.02)), size=SIZE)
    best = max(explained(scene), key=lambda split: goodness(split, scene))
    assert goodness(best, scene) > 0.7


def test_of_two_casters_each_is_explained_or_both_together():
    left, right = Caster(at=(0.1, 0.06)), Caster("cylinder", at=(0.16, -0.12), rgb=(0.1, 0.25, 0.5))
    both = paint(left, right, size=SIZE)
    found = explained(both)
    for caster in (left, right):
        alone = paint(caster, size=SIZE)
        assert max(goodness(split, scene) for split in found for scene in (alone, both)) > 0.6


def test_classifying_mends_a_spoilt_split():
    scene = paint(CYLINDER, ground="checkered", size=SIZE)
    ground, _, is_ground = stages_before(scene)
    kernel = np.ones((5, 5), np.uint8)
    body = cv2.erode(scene.body.astype(np.uint8), kernel) > 0
    shadow = cv2.erode(scene.shadow.astype(np.uint8), kernel) > 0
    spoilt = Split(body, shadow, shift_of(SHADOW_RATIO))
    mended = classified(ground.colours, ground, spoilt, is_ground, 2)
    assert overlap(mended.object_mask, scene.body) > max(0.9, overlap(body, scene.body))
    assert overlap(mended.shadow_mask, scene.shadow) > max(0.8, overlap(shadow, scene.shadow))


def test_without_anything_unlit_there_is_no_explanation():
    ground, unlit, is_ground = stages_before(paint(size=SIZE))
    nothing = np.zeros_like(unlit)
    assert shadow_shifts(ground, nothing, 5) == []
    assert splits(ground, nothing, is_ground, STEPS) == []
    few = nothing.copy()
    few[100, 100:110] = True
    assert splits(ground, few, is_ground, STEPS) == []


def test_masks_without_sense_break_nothing():
    """Everything unlit, specks, one line: explanations are whole or left out."""
    ground, _, is_ground = stages_before(paint(BOX, ground="striped", size=SIZE))
    specks = np.random.default_rng(2).random(is_ground.shape)
    line = np.zeros_like(is_ground)
    line[100:103] = True
    for unlit in (np.ones_like(is_ground), specks < 0.5, specks < 0.02, line):
        for split in splits(ground, unlit, is_ground, STEPS):
            assert split.object_mask.any()
            assert split.shadow_mask.any()
    for body, shadow in ((~is_ground, is_ground), (line & False, line & False), (line, line & False)):
        again = classified(ground.colours, ground, Split(body, shadow, shift_of(SHADOW_RATIO)), is_ground, 2)
        assert again.object_mask.shape == is_ground.shape


def test_the_same_picture_gives_the_same_explanations():
    scene = paint(BOX, ground="striped", size=SIZE)
    first = explained(scene)
    cv2.setRNGSeed(77)
    again = explained(scene)
    assert len(first) == len(again) > 0
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.object_mask, b.object_mask)
        np.testing.assert_array_equal(a.shadow_mask, b.shadow_mask)
        np.testing.assert_array_equal(a.shift, b.shift)
