"""From splits to explanations: true ones find the light, refined ones cost no more, what has nothing left is none."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between
from ashe_live.light.explanation.explain import Proposal, are_alike, explained, refined, refined_by_tangents
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.ground.regions import unlit_regions
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.outline_fit import preset
from ashe_live.light.pixels.areas import grown
from ashe_live.light.shape.predicted import Predicted
from tests.light.painted_bodies import explanation_of
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, Caster

ELSEWHERE = Caster("cylinder", at=(-0.1, -0.02))


def true_proposal(here: PaintedRegion) -> Proposal:
    return Proposal(here.region, here.materials, Split(here.body, here.shadow))


def seen_as(here: PaintedRegion, masks: Predicted) -> Explanation:
    truth = explanation_of(here)
    placed = replace(truth.alignment.placed, predicted=masks)
    return replace(truth, alignment=replace(truth.alignment, placed=placed))


def cost(explanation: Explanation, rough: Explanation) -> float:
    """By what the rough one says of the object's colours."""
    return Costs(rough.region, rough.materials, rough.as_object).of(explanation.predicted)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_true_split_is_explained_by_the_true_light(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    (found,) = explained([true_proposal(here)], preset.FAST)
    assert found is not None
    assert here.error_deg(found) < 1.5
    (better,) = refined([found], preset.BALANCED)
    assert better is not None
    assert here.error_deg(better) < 1.5
    assert cost(better, found) <= cost(found, found)


def test_each_proposal_is_explained_as_if_it_were_alone() -> None:
    here, there = painted_region(BOX), painted_region(CYLINDER)
    nothing = Proposal(here.region, here.materials, Split(here.body & False, here.shadow & False))
    proposals = [true_proposal(there), nothing, true_proposal(here)]
    together = explained(proposals, preset.FAST)
    assert together[1] is None
    for one, proposal in zip(together, proposals, strict=True):
        (alone,) = explained([proposal], preset.FAST)
        if one is None or alone is None:
            assert one is alone
            continue
        np.testing.assert_allclose(one.lights[0].to_light_marker, alone.lights[0].to_light_marker, atol=1e-6)


@pytest.mark.parametrize("caster", [BOX, CYLINDER])
def test_tangents_keep_a_true_light_and_do_not_ask_from_where_its_body_was_drawn(caster: Caster) -> None:
    here = painted_region(caster)
    (one,) = explained([true_proposal(here)], preset.BALANCED)
    assert one is not None
    sharp = refined_by_tangents(one)
    assert here.error_deg(sharp) < 1
    placed = one.alignment.placed
    elsewhere = replace(placed, sight=replace(placed.sight, centre_px=np.array([70.0, -20.0])))
    other = replace(one, alignment=replace(one.alignment, placed=elsewhere))
    assert angle_between(sharp.lights[0].to_light_marker, refined_by_tangents(other).lights[0].to_light_marker) < 1e-9


def test_an_explanation_of_which_nothing_is_left_is_dropped() -> None:
    """What its own materials say is lit ground can be neither object nor shadow."""
    here = painted_region(BOX)
    lit = replace(here.materials, lit=np.full_like(here.materials.lit, -100))
    truth = explanation_of(here)
    assert None not in refined([truth], preset.FAST)
    assert refined([replace(truth, materials=lit)], preset.FAST) == [None]
    lost, kept = refined([replace(truth, materials=lit), truth], preset.FAST)
    assert lost is None
    assert kept is not None
    assert refined([], preset.FAST) == []


def test_an_object_seen_in_two_regions_is_where_it_stands_whatever_frame_it_was_fitted_in() -> None:
    here = painted_region(CYLINDER)
    one = explanation_of(here, CYLINDER)
    other = replace(one, region=replace(here.region))
    lit = one.lit
    frame, x = lit.body.frame, np.array([1.0, 0.0])

    def standing(*, frame_moved: float, body_moved: float) -> Explanation:
        """In sizes of the object."""
        moved = replace(frame, origin_marker=frame.origin_marker + frame_moved * frame.unit_m * x)
        shape = lit.body.shape + np.append((body_moved - frame_moved) * x, np.zeros(3))
        body = replace(lit.body, frame=moved, shape=shape)
        placed = replace(one.alignment.placed, lit=replace(lit, body=body))
        return replace(other, alignment=replace(one.alignment, placed=placed))

    assert are_alike(one, standing(frame_moved=0.0, body_moved=0.0))
    assert are_alike(one, standing(frame_moved=0.5, body_moved=0.0))
    assert not are_alike(one, standing(frame_moved=0.0, body_moved=0.5))


def test_explanations_of_nearly_the_same_pixels_are_alike_either_way_round() -> None:
    here = painted_region(BOX)
    edge = grown(here.body, 1) & ~here.body
    little = here.body | (edge & (np.indices(edge.shape)[1] % 4 == 0))
    truth = seen_as(here, Predicted(here.body, here.shadow))
    alike = [truth, seen_as(here, Predicted(little, here.shadow & ~little))]
    different = [
        seen_as(here, Predicted(here.shadow, here.body)),
        seen_as(here, Predicted(here.body, here.shadow & False)),
        explanation_of(painted_region(ELSEWHERE), ELSEWHERE),
    ]
    for other in alike:
        assert are_alike(truth, other)
        assert are_alike(other, truth)
    for other in different:
        assert not are_alike(truth, other)
        assert not are_alike(other, truth)


def test_one_object_in_one_light_is_alike_in_two_regions() -> None:
    here, turned = painted_region(BOX), painted_region(BOX, azimuth_deg=100.0)
    (larger,) = unlit_regions(here.view.fine, here.unlit, here.ground, 140, 3)
    one = explanation_of(here)
    assert are_alike(one, replace(one, region=larger))
    assert are_alike(replace(one, region=larger), one)
    assert not are_alike(one, explanation_of(turned))
    assert not are_alike(one, replace(one, region=larger, lights=one.lights * 2))


def test_lights_are_less_certain_in_a_soft_shadow() -> None:
    here = painted_region(BOX)
    (good,) = explained([true_proposal(here)], preset.FAST)
    blurred = painted_region(BOX, penumbra_px=4.0)
    (worse,) = explained([true_proposal(blurred)], preset.FAST)
    assert good is not None
    assert worse is not None
    sigmas = [math.sqrt(np.linalg.eigvalsh(each.lights[0].covariance_rad2).max()) for each in (good, worse)]
    assert sigmas[0] < sigmas[1]
