"""Regions of painted scenes: they hold what was painted, at the scale that was asked for, where it was."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.ground.lit_ground import ground_colours, with_on_plane, with_unlit_on_average
from ashe_live.light.ground.regions import BEFORE, region_with_on_plane, unlit_regions
from ashe_live.light.pixels.areas import areas_by_size, grown
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import in_region, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, Caster, overlap

FAR_APART = Caster(at=(0.13, 0.06)), Caster("cylinder", at=(-0.1, -0.02), rgb=(0.1, 0.25, 0.5))
LIGHT_BETWEEN = {"azimuth_deg": 270.0, "elevation_deg": 60.0}


def fine_of(width_px: int = 640) -> View:
    return View.of(painted_region(BOX).scene.tracked, width_px)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_a_region_holds_the_object_and_its_shadow(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    painted = here.body | here.shadow
    assert len(here.regions) == 1
    assert overlap(here.region.unlit, painted) > 0.85
    # Nothing of it is beyond the window's border.
    border = np.ones_like(painted)
    border[1:-1, 1:-1] = False
    assert not (painted & border).any()


@pytest.mark.parametrize("size_px", [100, 130, 160])
def test_what_stands_out_has_the_size_that_was_asked_for(size_px: int) -> None:
    here = painted_region(BOX)
    (region,) = unlit_regions(fine_of(), here.unlit, here.ground, size_px, 3)
    painted = in_region(region, here.scene.body | here.scene.shadow)
    down, across = (np.ptp(axis) + 1 for axis in np.nonzero(painted))
    assert math.sqrt(down * across) == pytest.approx(size_px, rel=0.15)


def test_no_region_is_finer_than_the_finest_view_nor_coarser_than_the_coarse_one() -> None:
    here = painted_region(BOX)
    for fine, size_px, width_px in ((fine_of(), 10_000, 640), (fine_of(400), 10_000, 400), (fine_of(), 1, 320)):
        (region,) = unlit_regions(fine, here.unlit, here.ground, size_px, 3)
        assert region.frame_shape[1] == width_px


def test_a_region_is_a_window_of_the_frame() -> None:
    here = painted_region(BOX, ground="striped")
    region = here.region
    whole = View.of(here.scene.tracked, region.frame_shape[1])
    np.testing.assert_array_equal(region.view.image_bgr, whole.image_bgr[region.window])
    np.testing.assert_array_equal(region.colours, ground_colours(whole.image_bgr, here.ground, region.window))
    assert region.view.size == region.unlit.shape[::-1] == region.colours.shape[1::-1]
    again = region.in_frame(region.unlit)
    assert again.shape == region.frame_shape
    np.testing.assert_array_equal(again[region.window], region.unlit)
    assert np.count_nonzero(again) == np.count_nonzero(region.unlit)


def test_the_sheet_is_not_unlit() -> None:
    here = painted_region(Caster(at=(0.08, 0.0)))
    assert not (here.region.unlit & in_region(here.region, here.scene.sheet) & ~here.body & ~here.shadow).any()


def test_objects_apart_are_regions_of_their_own_the_largest_first() -> None:
    here = painted_region(*FAR_APART, **LIGHT_BETWEEN)
    assert len(here.regions) == 2
    first, second = (np.count_nonzero(region.unlit) for region in here.regions)
    scales = [region.frame_shape[1] for region in here.regions]
    assert first / scales[0] ** 2 > second / scales[1] ** 2
    fine = View.of(here.scene.tracked, BALANCED.fine_width_px)
    (only,) = unlit_regions(fine, here.unlit, here.ground, BALANCED.region_px, 1)
    np.testing.assert_array_equal(only.unlit, here.regions[0].unlit)


def test_what_is_beside_the_marker_comes_before_what_fills_the_background() -> None:
    here = painted_region(BOX)
    background = 1 + math.ceil(np.count_nonzero(here.unlit) / here.unlit.shape[1])
    both = here.unlit.copy()
    both[:background] = True
    nearest, *_ = unlit_regions(fine_of(), both, here.ground, BALANCED.region_px, 2)
    np.testing.assert_array_equal(nearest.unlit, here.region.unlit)


def test_an_object_and_a_shadow_that_hardly_part_are_one_region() -> None:
    here = painted_region(BOX)
    unlit = here.unlit.copy()
    columns = np.flatnonzero(unlit.any(axis=0))
    middle = int(columns.mean())
    unlit[:, middle : middle + 4] = False
    assert len(unlit_regions(fine_of(), unlit, here.ground, 130, 5)) == 1
    unlit[:, middle - 4 : middle + 6] = False
    assert len(unlit_regions(fine_of(), unlit, here.ground, 130, 5)) > 1


def test_an_object_with_a_gap_to_its_shadow_is_also_tried_with_it() -> None:
    here = painted_region(BOX)
    unlit = here.unlit.copy()
    _, columns = np.nonzero(unlit)
    middle = int(columns.mean())
    unlit[:, middle - 4 : middle + 6] = False
    *_, joined = unlit_regions(fine_of(), unlit, here.ground, 130, 5)
    painted = in_region(joined, here.scene.body) | in_region(joined, here.scene.shadow)
    assert overlap(joined.unlit, painted) > 0.75


def test_two_groups_that_are_also_tried_together_leave_the_third_its_region() -> None:
    here = painted_region(BOX)
    unlit = np.zeros_like(here.unlit)
    one, near, apart = (slice(20, 50), slice(30, 60)), (slice(20, 50), slice(75, 105)), (slice(150, 165), slice(40, 55))
    for rows, columns in (one, near, apart):
        unlit[rows, columns] = True
    regions = unlit_regions(fine_of(), unlit, here.ground, 130, 3)
    assert len(regions) == 4
    for rows, columns in (one, near, apart):
        alone = np.zeros_like(unlit)
        alone[rows, columns] = True
        assert max(overlap(region.unlit, in_region(region, alone)) for region in regions) > 0.8


def test_an_object_with_a_belt_in_the_grounds_colour_is_whole_where_it_is_tried_with_its_shadow() -> None:
    here = painted_region(BOX)
    unlit = np.zeros_like(here.unlit)
    for rows in (slice(20, 40), slice(44, 60), slice(70, 95)):  # above its belt, below it; the shadow
        unlit[rows, 30:70] = True
    *_, joined = unlit_regions(fine_of(), unlit, here.ground, 130, 5)
    assert len(areas_by_size(joined.unlit, 1)) == 1


def test_a_plain_object_on_specks_of_its_colour_is_found_by_its_mean() -> None:
    view = View.of(painted_region(BOX).scene.tracked, BALANCED.coarse_width_px)
    rng = np.random.default_rng(4)
    specks = np.array([(40, 50, 110), (60, 70, 150), (150, 180, 210)], np.uint8)
    image = specks[rng.integers(0, 3, view.is_ground.shape)]
    thing = np.zeros(view.is_ground.shape, np.bool_)
    thing[20:60, 220:270] = True
    nothing, everywhere = np.zeros_like(thing), np.ones_like(thing)
    assert not with_unlit_on_average(nothing, replace(view, image_bgr=image, is_ground=everywhere)).any()
    with_thing = np.where(thing[..., None], specks[2], image)
    found = with_unlit_on_average(nothing, replace(view, image_bgr=with_thing, is_ground=everywhere))
    assert overlap(found, thing) > 0.6


def test_what_glossy_ground_mirrors_is_nearly_lit_and_neither_object_nor_shadow_is() -> None:
    # Towards the camera the black cylinder takes an eighth of the sky's light from the ground.
    here = painted_region(replace(CYLINDER, rgb=(0.03, 0.03, 0.04)), azimuth_deg=200.0, elevation_deg=40.0, gloss=0.12)
    faint = here.region.faint
    assert faint is not None
    beside = here.region.unlit & ~grown(here.body | here.shadow, 3)
    assert beside.sum() > 100
    assert (faint[beside]).mean() > 0.9
    assert (faint[here.body]).mean() < 0.02
    assert (faint[here.shadow]).mean() < 0.1


def test_where_nothing_is_unlit_there_is_no_region() -> None:
    here = painted_region(BOX)
    assert unlit_regions(fine_of(), np.zeros_like(here.unlit), here.ground, 130, 3) == []


def test_any_unlit_mask_has_regions_within_the_frame() -> None:
    here = painted_region(BOX)
    specks = np.random.default_rng(2).random(here.unlit.shape)
    corner = np.zeros_like(here.unlit)
    corner[-1, -1] = True
    for unlit in (np.ones_like(here.unlit), specks < 0.5, specks < 0.01, corner):
        regions = unlit_regions(fine_of(), unlit, here.ground, 130, 3)
        assert 1 <= len(regions) <= 3 + BEFORE + 1
        for region in regions:
            assert region.in_frame(region.unlit).shape == region.frame_shape
            assert region.unlit.size > 0


def test_evidence_of_other_views_is_the_same_for_a_region_that_was_found_without_them() -> None:
    here = painted_region(BOX)
    told = np.random.default_rng(3).normal(size=here.ground.colours.shape[:2]).astype(np.float32)
    ground = with_on_plane(here.ground, told)
    fine = fine_of()
    (alone,), (beside,) = (unlit_regions(fine, here.unlit, each, 130, 1) for each in (here.ground, ground))
    assert alone.on_plane is None
    assert beside.on_plane is not None
    np.testing.assert_array_equal(region_with_on_plane(alone, ground).on_plane, beside.on_plane)
    # Odds of the whole frame, at the region's scale: on average they are those of its window.
    rows, columns = (
        slice(each.start * len(told) // alone.frame_shape[0], each.stop * len(told) // alone.frame_shape[0] + 1)
        for each in alone.window
    )
    assert beside.on_plane.mean() == pytest.approx(told[rows, columns].mean(), abs=0.05)


def test_what_the_ground_nearly_explains_takes_no_room_from_an_object_and_its_shadow() -> None:
    """Sheen all over a table reaches the object; its region would show little of the object itself."""
    here = painted_region(BOX)
    painted = here.unlit
    glow = np.zeros_like(painted)
    glow[10:-10, 10:-10] = True
    nearly = replace(here.ground, squared_distance=np.where(painted, 60.0, np.where(glow, 12.0, 0.0)))
    clear, whole = unlit_regions(fine_of(), painted | glow, nearly, BALANCED.region_px, 3)
    assert overlap(clear.unlit, in_region(clear, here.scene.body | here.scene.shadow)) > 0.8
    assert clear.frame_shape[1] > 1.3 * whole.frame_shape[1]


def test_what_is_dark_for_the_ground_is_not_told_by_what_lies_beyond_it() -> None:
    """A black wall above the ground makes the shadow on it no brighter."""
    here = painted_region(BOX)
    painted, fine, colours = here.unlit, fine_of(), here.ground.colours.copy()
    wall = np.zeros_like(painted)
    wall[: painted.nonzero()[0].min() - 10] = True
    beside = np.zeros_like(painted)
    beside[10:-10, 10:-10] = True
    beside &= ~wall
    colours[wall, 0] = -5.0
    lit = ~(painted | beside | wall)
    assert wall.sum() > lit.sum()
    distance = np.where(painted, 60.0, np.where(beside, 12.0, 0.0))
    nearly = replace(here.ground, squared_distance=distance, colours=colours)
    above = np.zeros_like(fine.is_ground)
    above[: len(above) * wall.any(axis=1).sum() // len(wall)] = True
    fine = replace(fine, is_ground=fine.is_ground & ~above)
    clear, _ = unlit_regions(fine, painted | beside, nearly, BALANCED.region_px, 3)
    assert overlap(clear.unlit, in_region(clear, here.scene.body | here.scene.shadow)) > 0.8


def test_bright_parts_alone_are_no_regions_of_their_own() -> None:
    """Without anything dark there is no shadow."""
    here = painted_region(BOX)
    bright = replace(here.ground, squared_distance=np.where(here.unlit, 60.0, 12.0), colours=0 * here.ground.colours)
    assert len(unlit_regions(fine_of(), np.ones_like(here.unlit), bright, BALANCED.region_px, 3)) == 1
