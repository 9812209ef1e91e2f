"""The evidence for and against an explanation: what the painted truth shows, and what other masks do not."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.edges.step_costs import StepCosts
from ashe_live.light.explanation.alignment import Alignment
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.evidence import FLAT, LEAST_CONTRAST, SIGNS, appearance, evidence
from ashe_live.light.explanation.judgement.shading import shading_of
from ashe_live.light.labels.materials import Materials, materials_of
from ashe_live.light.labels.two_lights import materials_of_two
from ashe_live.light.pixels.areas import grown, shrunk
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import Predicted, predicted
from tests.light.painted_bodies import alignment_of, body_of, explanation_of
from tests.light.painted_regions import PaintedRegion, painted_region, shift_of
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, Caster


def seen(
    here: PaintedRegion, body: Mask | None = None, shadow: Mask | None = None, materials: Materials | None = None
) -> dict[str, float]:
    """By name, the evidence of the picture where these masks, or the true ones, say object and shadow are."""
    body = here.body if body is None else body
    shadow = (here.shadow if shadow is None else shadow) & ~body
    return appearance(here.region, materials or here.materials, Predicted(body, shadow))


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_truth_looks_like_a_shadow(ground: str, caster: Caster) -> None:
    truth = seen(painted_region(caster, ground=ground))
    assert truth["edge"] > 0.8
    assert truth["hue"] < 0.2
    assert truth["border"] < 0.5
    assert truth["missed"] < np.log(0.15)


@pytest.mark.parametrize("ground", GROUNDS)
def test_a_shadow_on_lit_ground_has_no_edge(ground: str) -> None:
    here = painted_region(CYLINDER, ground=ground)
    truth, aside = seen(here), seen(here, shadow=here.region.is_ground & ~grown(here.body | here.shadow, 6))
    assert aside["edge"] < 0.5 * truth["edge"]
    assert aside["missed"] > truth["missed"] + 1
    assert aside["shaded"] < 0 < truth["shaded"]


def test_no_shadow_is_shaded_by_nothing_and_borders_on_the_object_alone() -> None:
    here = painted_region(BOX)
    none = seen(here, shadow=here.shadow & False)
    assert (none["shaded"], none["border"]) == (0, 1)


@pytest.mark.parametrize("ground", GROUNDS)
def test_what_is_as_dark_as_ground_in_the_same_shadow_is_no_object(ground: str) -> None:
    here = painted_region(BOX, ground=ground)
    truth = explanation_of(here)
    exchanged = with_masks(truth, Predicted(here.shadow, here.body & ~here.shadow))
    assert 0 <= evidence(truth)["in shadow"] < 0.3
    assert 0.7 < evidence(exchanged)["in shadow"] <= 1


def test_every_light_beyond_the_first_counts() -> None:
    here = painted_region(BOX)
    pale = materials_of(here.region, here.ground, shift_of(np.full(3, 0.8)))
    of_both = materials_of_two(here.region, here.ground, here.materials, pale)
    assert of_both is not None
    assert (seen(here)["second"], seen(here, materials=of_both)["second"]) == (0, 1)


def test_what_is_left_out_is_missed() -> None:
    here = painted_region(BOX, ground="checkered")
    truth = seen(here)
    less = seen(here, shrunk(here.body, 4), shrunk(here.shadow, 4))
    more = seen(here, grown(here.body, 4), grown(here.shadow, 4))
    assert less["missed"] > truth["missed"]
    assert more["missed"] <= truth["missed"]


def with_masks(one: Explanation, masks: Predicted) -> Explanation:
    placed = replace(one.alignment.placed, predicted=masks)
    return replace(one, alignment=replace(one.alignment, placed=placed))


@pytest.mark.parametrize("ground", GROUNDS)
def test_an_object_that_swallows_its_shadow_is_in_shadow(ground: str) -> None:
    """Where only the shadow's rim is taken for the shadow, most of the object is the ground in the same shadow."""
    here = painted_region(BOX, ground=ground)
    truth, inner = explanation_of(here), shrunk(here.shadow, 2)
    swallowed = with_masks(truth, Predicted(here.body | inner, here.shadow & ~inner))
    share = np.count_nonzero(inner) / np.count_nonzero(here.body | inner)
    assert evidence(truth)["in shadow"] < 0.05
    assert evidence(swallowed)["in shadow"] > 0.8 * share > 0.15


@pytest.mark.parametrize("ground", GROUNDS)
def test_a_shadow_with_lit_ground_in_it_is_uneven(ground: str) -> None:
    here = painted_region(BOX, ground=ground)
    truth = explanation_of(here)
    wider = with_masks(truth, Predicted(here.body, grown(here.shadow, 8) & ~here.body))
    assert evidence(truth)["uneven"] < 0.15
    assert evidence(wider)["uneven"] > 2 * evidence(truth)["uneven"]


def test_both_outlines_must_lie_on_steps_of_light() -> None:
    """One that does cannot make up for the other."""
    truth = explanation_of(painted_region(BOX))
    costs = [StepCosts(body, shadow) for body, shadow in ((1.0, 1.0), (1.0, 4.0), (4.0, 1.0), (4.0, 4.0))]
    told = [evidence(replace(truth, steps=each))["steps"] for each in costs]
    assert told[0] < told[1] == told[2] == told[3]


def test_a_light_is_grazing_where_the_ground_receives_little_of_it() -> None:
    truth = explanation_of(painted_region(BOX))

    def by_height(deg: float) -> float:
        angle = np.radians(deg)
        light = replace(truth.lights[0], light=np.array([np.cos(angle), 0.0, np.sin(angle), 0.0]))
        return evidence(replace(truth, lights=(light,)))["grazing"]

    assert by_height(40.0) == by_height(20.0) == 0 < by_height(15.0) < by_height(5.0)


def test_a_light_that_depends_on_the_family_is_less_certain() -> None:
    """By the angle that half of the likeliest families are beyond."""
    here = painted_region(BOX)
    truth, body = explanation_of(here), body_of(here, BOX)
    light = truth.lights[0].to_light_marker
    east = np.cross(light, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(light, [0.0, 0.0, 1.0]))
    turned = [
        replace(body, lights=at_infinity(np.cos(angle) * light + np.sin(angle) * east)[None]) for angle in (0, 0.1, 0.3)
    ]
    assert evidence(truth)["family"] == 0
    assert evidence(replace(truth, bodies=tuple(turned)))["family"] == pytest.approx(0.1, abs=0.02)


def test_an_object_or_a_shadow_on_lit_ground_is_lit() -> None:
    here = painted_region(BOX)
    truth = explanation_of(here)
    turned = body_of(here, replace(BOX, at=(0.16, 0.0)))
    aside = with_masks(truth, predicted(turned.body.proxy, turned.lights, here.region.view))
    assert evidence(truth)["lit"] < 0.1
    assert evidence(aside)["lit"] > evidence(truth)["lit"] + 0.3


def test_a_shift_of_another_hue_or_hardly_darker_is_evidence() -> None:
    here = painted_region(BOX)
    green = materials_of(here.region, here.ground, here.true_shift + np.array([0, 0, 0.6]))
    assert seen(here, materials=green)["hue"] > seen(here)["hue"] + 0.3
    pale = materials_of(here.region, here.ground, shift_of(np.array([0.8, 0.8, 0.8])))
    assert seen(here, materials=pale)["brightness"] > seen(here)["brightness"] == 0


def test_a_shadow_much_smaller_or_larger_than_the_object_is_short_or_long() -> None:
    here = painted_region(BOX)
    tiny, huge = here.shadow & False, grown(here.shadow, 60)
    tiny[20, 20:23] = True
    assert seen(here, shadow=tiny)["short"] > 0 == seen(here, shadow=tiny)["long"]
    assert seen(here, shadow=huge)["long"] > 0 == seen(here, shadow=huge)["short"]


def test_a_hole_in_the_object_is_no_shadow_beside_it() -> None:
    """A shadow that is surrounded by the object borders on nothing else."""
    here = painted_region(BOX)
    inner = shrunk(here.body, 8)
    assert inner.any()
    assert seen(here, here.body & ~inner, inner)["border"] == 1


def alignment_of_slab(here: PaintedRegion, height_m: float) -> Alignment:
    """The painted body, but of this height."""
    truth = alignment_of(here)
    flatter = body_of(here, replace(BOX, height_m=height_m))
    return replace(truth, placed=replace(truth.placed, lit=flatter))


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_truth_has_clear_borders_and_is_shaded_by_its_light(ground: str, caster: Caster) -> None:
    truth = evidence(explanation_of(painted_region(caster, ground=ground), caster))
    assert truth["clear shadow"] > 0.9
    assert min(truth["contrast"], truth["sunlit"]) > 0
    assert truth["flat"] == 0
    assert truth["misfit"] < np.log(0.01)


def test_a_picture_without_shading_speaks_only_so_much_against_its_light() -> None:
    here = painted_region(BOX)
    colours = here.region.colours.copy()
    colours[..., 0][here.body] = -0.7
    truth = explanation_of(here)
    plain = replace(truth, region=replace(here.region, colours=colours))
    shown = shading_of(plain.region, here.body, truth.proxy, [at_infinity(here.scene.to_light)], [0.1])
    assert shown.contrast < LEAST_CONTRAST
    assert evidence(plain)["contrast"] == LEAST_CONTRAST < evidence(truth)["contrast"]


def test_the_object_is_shaded_otherwise_in_another_light() -> None:
    here = painted_region(BOX)
    x, y, z = here.scene.to_light
    opposite = explanation_of(here, lights=(FittedLight(np.array([-x, -y, z, 0.0]), np.eye(2) * 1e-4),))
    for name in ("contrast", "sunlit"):
        assert evidence(opposite)[name] < evidence(explanation_of(here))[name] - 0.5


@pytest.mark.parametrize("height_m", [0.01, 0.003])
def test_a_slab_is_flat_by_how_much_wider_than_high_it_is(height_m: float) -> None:
    here = painted_region(BOX)
    upright, thick, thin = (
        evidence(explanation_of(here, alignment=alignment_of_slab(here, height)))["flat"]
        for height in (BOX.height_m, height_m, height_m / 3)
    )
    assert upright == 0 < thick
    assert thin - thick == pytest.approx(np.log(3))


def test_a_round_body_is_as_broad_as_it_is_across() -> None:
    here, height_m = painted_region(CYLINDER), 0.01
    truth, low = alignment_of(here), body_of(here, replace(CYLINDER, height_m=height_m))
    flat = replace(truth, placed=replace(truth.placed, lit=low))
    told = evidence(explanation_of(here, CYLINDER, alignment=flat))["flat"]
    assert told == pytest.approx(np.log(CYLINDER.width_m / height_m) - FLAT, abs=0.05)


def test_only_the_misfit_measures_how_far_outlines_are_from_borders() -> None:
    here = painted_region(BOX)
    good, bad = (
        evidence(explanation_of(here, alignment=alignment_of(here, misfit_px=misfit_px))) for misfit_px in (0.3, 3.0)
    )
    assert bad.pop("misfit") - good.pop("misfit") == pytest.approx(np.log(10))
    assert good == bad


def test_all_evidence_has_a_sign() -> None:
    assert evidence(explanation_of(painted_region(BOX))).keys() <= SIGNS.keys()
    assert set(SIGNS.values()) == {-1, 1}


@pytest.mark.parametrize("misfit_px", [0.0, 1e9])
def test_no_misfit_is_without_bounds(misfit_px: float) -> None:
    here = painted_region(BOX)
    values = evidence(explanation_of(here, alignment=alignment_of(here, misfit_px=misfit_px)))
    assert np.isfinite(list(values.values())).all()


@pytest.mark.parametrize("body", ["nothing", "all", "one pixel", "specks"])
@pytest.mark.parametrize("shadow", ["nothing", "all", "one pixel", "specks"])
def test_masks_without_sense_have_finite_evidence(body: str, shadow: str) -> None:
    here = painted_region(BOX)
    nothing = np.zeros_like(here.body)
    one = nothing.copy()
    one[5, 5] = True
    masks = {
        "nothing": nothing,
        "all": ~nothing,
        "one pixel": one,
        "specks": np.random.default_rng(1).random(nothing.shape) < 0.1,
    }
    assert np.isfinite(list(seen(here, masks[body], masks[shadow]).values())).all()
