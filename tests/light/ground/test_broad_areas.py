"""Shadows in the colour of joints stand out, as they are broader than any joint; joints and other grounds do not."""

import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.ground.broad_areas import with_broad_areas
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground, unlit_mask
from ashe_live.light.ground.regions import region_of
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import in_region, shift_of
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, Painted, paint

LEAST_PX = 40


def ground_of(scene: Painted) -> tuple[LitGround, View]:
    view = View.of(scene.tracked, BALANCED.fine_width_px).scaled(BALANCED.coarse_width_px)
    ground = fit_lit_ground(view.image_bgr, view.is_ground, BALANCED.ground)
    assert ground is not None
    return ground, view


def shrunk_to(view: View, mask: Mask) -> Mask:
    step = mask.shape[1] // view.size[0]
    return mask[step // 2 :: step, step // 2 :: step]


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_a_shadow_in_the_colour_of_joints_stands_out(caster):
    scene = paint(caster, ground="planks")
    ground, view = ground_of(scene)
    shadow = shrunk_to(view, scene.shadow & ~scene.body)
    before, after = (unlit_mask(each, view.is_ground, LEAST_PX) for each in (ground, with_broad_areas(ground, view)))
    assert np.mean(before[shadow]) < 0.6
    assert np.mean(after[shadow]) > 0.85
    assert np.mean(after[~shadow & ~shrunk_to(view, scene.body)]) < 0.02


@pytest.mark.parametrize("ground", [*GROUNDS, "planks"])
def test_no_empty_ground_has_any(ground):
    of_empty, view = ground_of(paint(ground=ground))
    assert with_broad_areas(of_empty, view) is of_empty


@pytest.mark.parametrize("ground", GROUNDS)
def test_where_no_joint_is_as_dark_as_a_shadow_hardly_any_lit_ground_is_added(ground):
    scene = paint(BOX, ground=ground)
    found, view = ground_of(scene)
    before, after = (unlit_mask(each, view.is_ground, LEAST_PX) for each in (found, with_broad_areas(found, view)))
    assert np.mean((after & ~before)[~shrunk_to(view, scene.shadow | scene.body)]) < 0.003


def test_there_a_shadow_costs_less_than_lit_ground_with_such_joints():
    scene = paint(BOX, ground="planks")
    ground, view = ground_of(scene)
    broad = with_broad_areas(ground, view)
    fine = View.of(scene.tracked, BALANCED.fine_width_px)
    unlit = unlit_mask(broad, view.is_ground, LEAST_PX)
    shift = shift_of(SHADOW_RATIO)
    regions = [region_of(fine, unlit, each, BALANCED.region_px) for each in (ground, broad)]
    before, after = (materials_of(region, each, shift) for region, each in zip(regions, (ground, broad), strict=True))
    shadow = in_region(regions[1], scene.shadow & ~scene.body)
    assert regions[1].broad is not None
    margins = [np.median((each.lit - each.shaded)[shadow & regions[1].broad]) for each in (before, after)]
    assert margins[0] < 10 < 15 < margins[1]
    elsewhere = ~grown(regions[1].broad, 4)  # both are smoothed
    np.testing.assert_array_equal(after.lit[elsewhere], before.lit[elsewhere])
