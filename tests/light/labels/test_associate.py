"""Which of what stands out is shadow, in regions of painted scenes."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.estimators.proposals import SHADOWS_PER_SHIFT
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import (
    Split,
    are_like_areas,
    areas_of_one_colour,
    shadow_like,
    splits,
    with_near_shadow_undecided,
)
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.pixels.areas import grown
from tests.light.painted_regions import PaintedRegion, blurred_and_grey, in_region, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, Caster, overlap

TWO = Caster(at=(0.1, 0.06)), Caster("cylinder", at=(0.16, -0.12), rgb=(0.1, 0.25, 0.5))


def splits_by(region: Region, ground: LitGround, shift: Float, shadows_tried: int) -> list[Split]:
    look = shadow_like(region, ground, [shift])
    return splits(region, materials_of(region, ground, shift), look, shadows_tried)


def explained(here: PaintedRegion, region: Region | None = None) -> list[Split]:
    """The splits of a region by every shift that is voted for."""
    region = region or here.region
    return [split for shift in here.shifts for split in splits_by(region, here.ground, shift, SHADOWS_PER_SHIFT)]


def goodness(split: Split, body: Mask, shadow: Mask) -> float:
    return min(overlap(split.object_mask, body), overlap(split.shadow_mask, shadow))


def best_of(here: PaintedRegion) -> Split:
    return max(explained(here), key=lambda split: goodness(split, here.body, here.shadow))


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_one_explanation_is_the_true_one(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    best = best_of(here)
    assert overlap(best.object_mask, here.body) > 0.9
    assert overlap(best.shadow_mask, here.shadow) > 0.8


@pytest.mark.parametrize("ground", ["plain", "checkered"])
def test_an_explanation_gives_no_pixel_twice_and_none_of_the_sheet(ground: str) -> None:
    here = painted_region(BOX, ground=ground)
    found = explained(here)
    assert found
    for split in found:
        assert split.is_large_enough
        assert not (split.object_mask & split.shadow_mask).any()
        assert not (split.shadow_mask & in_region(here.region, here.scene.sheet)).any()


def test_no_two_explanations_by_one_shift_are_alike() -> None:
    here = painted_region(BOX, ground="striped")
    for shift in here.shifts:
        found = splits_by(here.region, here.ground, shift, 5)
        assert not any(one.is_like(other) for i, one in enumerate(found) for other in found[:i])


def test_an_object_as_dark_as_its_shadow_is_separated_by_colour() -> None:
    here = painted_region(Caster(rgb=(0.16, 0.05, 0.02)))
    assert goodness(best_of(here), here.body, here.shadow) > 0.7


@pytest.mark.parametrize("rgb", [(0.1, 0.1, 0.12), (0.16, 0.16, 0.2), (0.25, 0.2, 0.18)])
def test_a_shadow_beside_an_object_nearly_as_dark_is_an_area_of_one_colour(rgb: tuple[float, float, float]) -> None:
    here = painted_region(replace(CYLINDER, rgb=rgb))
    areas = areas_of_one_colour(here.region)
    assert max(overlap(area, here.shadow) for area in areas) > 0.9
    assert not any(are_like_areas(one, other) for i, one in enumerate(areas) for other in areas[:i])
    assert not any((area & ~here.region.unlit).sum() > 0.2 * area.sum() for area in areas)


@pytest.mark.parametrize("level", [0.02, 0.05])
def test_where_a_dark_objects_border_mixes_with_lit_ground_there_is_no_shadow(level: float) -> None:
    """Between dark grey and lit ground lie the colours of a shadow, in a picture without others."""
    here = painted_region(replace(BOX, rgb=(level,) * 3), seen_as=blurred_and_grey)
    best = best_of(here)
    assert overlap(best.object_mask, here.body) > 0.9
    beyond = best.shadow_mask & ~grown(here.shadow, 3)
    assert np.count_nonzero(beyond) < 0.02 * np.count_nonzero(here.shadow)


def test_of_two_casters_each_is_explained_or_both_together() -> None:
    here = painted_region(*TWO)
    found = [(region, split) for region in here.regions for split in explained(here, region)]
    for alone in (painted_region(TWO[0]), painted_region(TWO[1])):
        truths = alone.scene, here.scene
        assert (
            max(
                goodness(split, in_region(region, scene.body), in_region(region, scene.shadow))
                for region, split in found
                for scene in truths
            )
            > 0.6
        )


# Likeness and doubt


def halves() -> tuple[Mask, Mask]:
    body, shadow = np.zeros((2, 40, 60), bool)
    body[10:30, 10:30] = True
    shadow[10:30, 30:55] = True
    return body, shadow


def test_splits_are_alike_when_hardly_a_pixel_is_explained_otherwise() -> None:
    body, shadow = halves()
    split = Split(body, shadow)
    other = shadow.copy()
    other[10, 30:40] = False
    assert split.is_like(split)
    assert split.is_like(Split(body, other))
    assert Split(body, other).is_like(split)
    assert not split.is_like(Split(shadow, body))


def test_a_doubted_split_is_another_one() -> None:
    split = Split(*halves())
    doubtful = with_near_shadow_undecided(split)
    assert doubtful is not None
    assert doubtful.is_like(doubtful)
    assert not split.is_like(doubtful)
    assert not doubtful.is_like(split)


def test_nothing_is_too_small() -> None:
    body, shadow = halves()
    nothing = np.zeros_like(body)
    assert Split(body, shadow).is_large_enough
    for small in (Split(nothing, shadow), Split(body, nothing), Split(nothing, nothing)):
        assert not small.is_large_enough


def test_doubt_takes_the_shadow_near_the_object_and_leaves_the_rest() -> None:
    body, shadow = halves()
    split = with_near_shadow_undecided(Split(body, shadow))
    assert split is not None
    assert split.undecided is not None
    np.testing.assert_array_equal(split.object_mask, body)
    np.testing.assert_array_equal(split.shadow_mask | split.undecided, shadow)
    assert not (split.shadow_mask & split.undecided).any()
    _, sure = np.nonzero(split.shadow_mask)
    _, doubtful = np.nonzero(split.undecided)
    assert doubtful.max() < sure.min()
    assert np.count_nonzero(split.undecided) > np.count_nonzero(split.shadow_mask)


def test_a_shadow_of_few_pixels_is_not_doubted() -> None:
    body, _ = halves()
    shadow = np.zeros_like(body)
    shadow[20, 30:38] = True
    assert Split(body, shadow).is_large_enough
    assert with_near_shadow_undecided(Split(body, shadow)) is None


# Extremes


def with_unlit(region: Region, unlit: Mask) -> Region:
    return Region(region.view, region.colours, unlit, region.window, region.frame_shape)


def test_without_anything_unlit_there_is_no_explanation() -> None:
    here = painted_region(BOX)
    few = np.zeros_like(here.region.unlit)
    for columns in (0, 10):
        few[20, 20 : 20 + columns] = True
        assert explained(here, with_unlit(here.region, few)) == []


def test_unlit_pixels_of_one_colour_are_no_several_areas() -> None:
    here = painted_region(BOX)
    flat = Region(
        here.region.view,
        np.zeros_like(here.region.colours),
        np.ones_like(here.region.unlit),
        here.region.window,
        here.region.frame_shape,
    )
    assert areas_of_one_colour(flat) == []
    assert areas_of_one_colour(with_unlit(here.region, np.zeros_like(here.region.unlit))) == []


def test_masks_without_sense_break_nothing() -> None:
    """Everything unlit, specks, one line: explanations are whole or left out."""
    here = painted_region(BOX, ground="striped")
    shape = here.region.unlit.shape
    specks = np.random.default_rng(2).random(shape)
    line = np.zeros(shape, bool)
    line[20:23] = True
    for unlit in (np.ones(shape, bool), specks < 0.5, specks < 0.02, line):
        for split in explained(here, with_unlit(here.region, unlit)):
            assert split.is_large_enough
            assert not (split.object_mask & split.shadow_mask).any()


@pytest.mark.parametrize("window", [np.s_[:1, :1], np.s_[:1, :], np.s_[:, :1], np.s_[:3, :3]])
def test_regions_of_a_few_pixels_have_no_explanation(window: tuple[slice, slice]) -> None:
    here = painted_region(BOX)
    rows, columns = (slice(0, len(range(*part.indices(n)))) for part, n in zip(window, here.body.shape, strict=True))
    unlit = np.ones_like(here.region.unlit[rows, columns])
    region = Region(
        here.region.view.cut((rows, columns)),
        here.region.colours[rows, columns],
        unlit,
        (rows, columns),
        here.region.frame_shape,
    )
    assert explained(here, region) == []


def test_the_same_picture_gives_the_same_explanations() -> None:
    here = painted_region(BOX, ground="striped")
    first = explained(here)
    cv2.setRNGSeed(77)
    again = explained(here)
    assert len(first) == len(again) > 0
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.object_mask, b.object_mask)
        np.testing.assert_array_equal(a.shadow_mask, b.shadow_mask)
