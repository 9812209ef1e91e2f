"""Labels corrected by a fit: nearer to the truth than the fit that they start from, and doubt where there is doubt."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float32, Mask
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import object_cost
from ashe_live.light.labels.relabel import relabelled
from ashe_live.light.pixels.areas import grown, shrunk
from ashe_live.light.shape.predicted import Predicted
from tests.light.painted_regions import PaintedRegion, in_region, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, Caster, overlap

# Lit, it is as dark and as blue as the plain ground is in shadow.
LIKE_SHADOW = Caster(rgb=tuple(np.array([0.42, 0.38, 0.33]) * SHADOW_RATIO / 0.7))


def moved(mask: Mask, right: int, down: int) -> Mask:
    return np.roll(mask, (down, right), axis=(0, 1))


def own_cost(here: PaintedRegion, body: Mask) -> Float32:
    return object_cost(here.region, body & here.region.unlit)


def corrected(here: PaintedRegion, body: Mask, shadow: Mask) -> Split:
    return relabelled(here.region, here.materials, own_cost(here, body), Predicted(body, shadow & ~body))


SPOILT = {
    "moved right": lambda mask: moved(mask, 4, 0),
    "moved up": lambda mask: moved(mask, 0, -4),
    "moved aslant": lambda mask: moved(mask, -3, 3),
    "grown": lambda mask: grown(mask, 3),
    "shrunk": lambda mask: shrunk(mask, 3),
}


@pytest.mark.parametrize("spoilt", SPOILT)
@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", ["plain", "checkered", "bricks"])
def test_from_a_spoilt_fit_labels_come_nearer_to_the_truth(ground: str, caster: Caster, spoilt: str) -> None:
    here = painted_region(caster, ground=ground)
    body, shadow = (SPOILT[spoilt](mask) for mask in (here.body, here.shadow))
    split = corrected(here, body, shadow)
    assert overlap(split.object_mask, here.body) > max(overlap(body, here.body), 0.9)
    assert overlap(split.shadow_mask, here.shadow) > max(overlap(shadow & ~body, here.shadow), 0.85)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_what_is_right_stays(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    split = corrected(here, here.body, here.shadow)
    assert overlap(split.object_mask, here.body) > 0.9
    assert overlap(split.shadow_mask, here.shadow) > 0.9


def test_no_pixel_is_given_twice_and_none_of_the_sheet_is_shadow() -> None:
    for caster in (BOX, LIKE_SHADOW, Caster(at=(0.08, 0.0))):
        here = painted_region(caster)
        split = corrected(here, here.body, here.shadow)
        masks = [split.object_mask, split.shadow_mask, *([] if split.undecided is None else [split.undecided])]
        assert np.sum(masks, axis=0).max() == 1
        assert not (split.shadow_mask & ~here.region.is_ground).any()


def test_clear_colours_leave_no_doubt() -> None:
    here = painted_region(BOX)
    assert corrected(here, here.body, here.shadow).undecided is None


def test_an_object_coloured_like_its_shadow_is_separated_by_the_fit_or_left_in_doubt() -> None:
    """Its sides, some lit and some not, meet a shadow of the same colour; outline and doubt cover the whole."""
    here = painted_region(LIKE_SHADOW)
    split = corrected(here, here.body, here.shadow)
    undecided = np.zeros_like(here.body) if split.undecided is None else split.undecided
    assert overlap(split.object_mask | split.shadow_mask | undecided, here.body | here.shadow) > 0.85
    # What is given to the wrong one is little; the doubt lies where they meet.
    wrong = (split.object_mask & here.shadow) | (split.shadow_mask & here.body)
    assert np.count_nonzero(wrong) < 0.1 * np.count_nonzero(here.body | here.shadow)


def test_far_from_the_fit_colours_do_not_decide() -> None:
    """A second object of the same colours is no part of the first."""
    light = {"azimuth_deg": 90.0}
    both = painted_region(BOX, Caster(at=(0.205, 0.0)), **light)
    alone = painted_region(BOX, **light).scene
    body, shadow = in_region(both.region, alone.body), in_region(both.region, alone.shadow)
    assert np.count_nonzero(both.body & ~body) > 0.5 * np.count_nonzero(body)
    split = corrected(both, body, shadow)
    assert overlap(split.object_mask, body) > 0.9
    assert overlap(split.shadow_mask, shadow) > 0.8


@pytest.mark.parametrize("body", ["nothing", "all", "specks"])
@pytest.mark.parametrize("shadow", ["nothing", "all", "specks"])
def test_fits_without_sense_break_nothing(body: str, shadow: str) -> None:
    here = painted_region(BOX)
    shape = here.body.shape
    masks = {
        "nothing": np.zeros(shape, bool),
        "all": np.ones(shape, bool),
        "specks": np.random.default_rng(2).random(shape) < 0.1,
    }
    split = corrected(here, masks[body], masks[shadow])
    assert split.object_mask.shape == split.shadow_mask.shape == shape
    assert not (split.object_mask & split.shadow_mask).any()


def test_the_same_fit_gives_the_same_labels() -> None:
    here = painted_region(BOX, ground="striped")
    first, again = (corrected(here, grown(here.body, 2), here.shadow) for _ in range(2))
    np.testing.assert_array_equal(first.object_mask, again.object_mask)
    np.testing.assert_array_equal(first.shadow_mask, again.shadow_mask)
