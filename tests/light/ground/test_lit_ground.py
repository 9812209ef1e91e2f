"""The lit ground on painted scenes: what stands out is the object and its shadow, whatever the ground's pattern."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.light.ground.lit_ground import fit_lit_ground, ground_colours, lit_rgb, unlit_mask
from ashe_live.light.ground.preset import GroundPreset
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, overlap, paint
from tests.light.synthetic_masks import camera_towards

SIZE = (320, 240)
LEAST_PX = 40
PRESET = GroundPreset()


def unlit_of(image_bgr: Image, is_ground: Mask) -> Mask:
    ground = fit_lit_ground(image_bgr, is_ground, PRESET)
    assert ground is not None
    return unlit_mask(ground, is_ground, LEAST_PX)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_object_and_shadow_stand_out(ground, caster):
    scene = paint(caster, ground=ground, size=SIZE)
    unlit = unlit_of(scene.tracked.frame.image_bgr, scene.beside_sheet)
    assert overlap(unlit, scene.body | scene.shadow) > 0.8


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("ground", GROUNDS)
def test_nothing_stands_out_of_an_empty_ground(ground, seed):
    scene = paint(ground=ground, size=SIZE, seed=seed)
    assert unlit_of(scene.tracked.frame.image_bgr, scene.beside_sheet).mean() < 0.005


def test_soft_shadows_stand_out():
    scene = paint(CYLINDER, size=SIZE, penumbra_px=2)
    unlit = unlit_of(scene.tracked.frame.image_bgr, scene.beside_sheet)
    assert overlap(unlit, scene.body | scene.shadow) > 0.75


def test_what_is_not_ground_is_neither_looked_at_nor_found():
    """With the sky in view, and whatever is printed on the sheet."""
    scene = paint(BOX, size=SIZE, T_cam_marker=camera_towards((0.08, 0.0), 0.5, 15.0))
    image = np.array(scene.tracked.frame.image_bgr)
    is_ground = scene.beside_sheet
    is_ground[: SIZE[1] // 3] = False
    unlit = unlit_of(image, is_ground)
    assert unlit.any()
    assert not (unlit & ~is_ground).any()
    # The first colours are smoothed over a pixel or two.
    inner = cv2.erode((~is_ground).astype(np.uint8), np.ones((15, 15), np.uint8), borderValue=1) > 0
    image[inner] = np.random.default_rng(0).integers(0, 256, (np.count_nonzero(inner), 3))
    np.testing.assert_array_equal(unlit_of(image, is_ground), unlit)


@pytest.mark.parametrize("ground", GROUNDS)
def test_exposure_changes_little(ground):
    reference, *others = (
        paint(BOX, ground=ground, size=SIZE, exposure=exposure, noise_levels=1.0) for exposure in (0.5, 0.125, 0.25, 1)
    )
    before = unlit_of(reference.tracked.frame.image_bgr, reference.beside_sheet)
    for scene in others:
        assert overlap(unlit_of(scene.tracked.frame.image_bgr, scene.beside_sheet), before) > 0.95


def test_the_palette_holds_the_ground_and_not_the_object():
    scene = paint(BOX, ground="checkered", size=SIZE)
    ground = fit_lit_ground(scene.tracked.frame.image_bgr, scene.beside_sheet, PRESET)
    assert ground is not None
    np.testing.assert_allclose(ground.palette.weights.sum(), 1, atol=0.01)
    assert (np.linalg.eigvalsh(ground.palette.covariances) > 0).all()
    lit = scene.beside_sheet & ~scene.body & ~scene.shadow
    assert np.median(ground.squared_distance[lit]) < 6 < np.median(ground.squared_distance[scene.body])
    assert ground.rare[lit].mean() < 0.1
    assert ground.rare[scene.body].mean() > 0.9


@pytest.mark.parametrize("ground", GROUNDS)
def test_the_lit_grounds_colour_is_the_painted_one(ground):
    scene = paint(BOX, ground=ground, size=SIZE, noise_levels=0.5)
    empty = paint(ground=ground, size=SIZE, noise_levels=0.5)
    fitted = fit_lit_ground(scene.tracked.frame.image_bgr, scene.beside_sheet, PRESET)
    assert fitted is not None
    painted = LINEAR_FROM_SRGB_8BIT[empty.tracked.frame.image_bgr[empty.beside_sheet]].mean(axis=0)[::-1]
    np.testing.assert_allclose(lit_rgb(fitted), painted, rtol=0.1)


def test_a_window_of_the_same_picture_has_the_same_colours():
    scene = paint(BOX, ground="striped", size=SIZE)
    image = scene.tracked.frame.image_bgr
    ground = fit_lit_ground(image, scene.beside_sheet, PRESET)
    assert ground is not None
    window = np.s_[40:180, 100:300]
    inner = np.s_[4:-4, 4:-4]  # the window's own border is smoothed without its surroundings
    np.testing.assert_allclose(ground_colours(image, ground, window)[inner], ground.colours[window][inner], atol=1e-4)


def test_a_finer_picture_of_the_same_ground_has_the_same_colours():
    fine = paint(BOX, noise_levels=0.0)
    coarse_image = np.asarray(cv2.resize(fine.tracked.frame.image_bgr, SIZE, interpolation=cv2.INTER_AREA), np.uint8)
    is_ground = paint(BOX, size=SIZE).beside_sheet
    ground = fit_lit_ground(coarse_image, is_ground, PRESET)
    assert ground is not None
    colours = ground_colours(fine.tracked.frame.image_bgr, ground, np.s_[100:400, 40:600])
    coarse = np.asarray(cv2.resize(colours, (280, 150), interpolation=cv2.INTER_AREA))
    off = np.abs(coarse - ground.colours[50:200, 20:300]).max(axis=2)
    assert np.median(off) < 0.02
    assert np.quantile(off, 0.9) < 0.05


NOISE = np.random.default_rng(3).integers(0, 256, (*SIZE[::-1], 3), dtype=np.uint8)
FLAT = {level: np.full((*SIZE[::-1], 3), level, np.uint8) for level in (0, 1, 128, 255)}


@pytest.mark.parametrize("image", [*FLAT.values(), NOISE], ids=[*map(str, FLAT), "noise"])
def test_pictures_of_nothing_hold_nothing(image):
    is_ground = np.ones(image.shape[:2], bool)
    ground = fit_lit_ground(image, is_ground, PRESET)
    assert ground is None or not unlit_mask(ground, is_ground, LEAST_PX).any()


@pytest.mark.parametrize("shape", [(1, 1), (2, 2), (1, 500), (500, 1), (30, 40)])
def test_too_little_ground_is_none(shape):
    image = np.full((*shape, 3), 90, np.uint8)
    assert fit_lit_ground(image, np.zeros(shape, bool), PRESET) is None
    if np.prod(shape) < 500:
        assert fit_lit_ground(image, np.ones(shape, bool), PRESET) is None


def test_the_same_picture_gives_the_same_bits():
    scene = paint(BOX, ground="bricks", size=SIZE)
    image, is_ground = scene.tracked.frame.image_bgr, scene.beside_sheet
    first = fit_lit_ground(image, is_ground, PRESET)
    cv2.setRNGSeed(99)
    np.random.seed(99)  # noqa: NPY002 - the global generator on purpose
    again = fit_lit_ground(image, is_ground, PRESET)
    assert first is not None
    assert again is not None
    np.testing.assert_array_equal(first.squared_distance, again.squared_distance)
    np.testing.assert_array_equal(first.rare, again.rare)
