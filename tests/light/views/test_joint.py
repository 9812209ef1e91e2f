"""One body and its lights, aligned in several views."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between, angles_from_direction
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.steps import FAST
from ashe_live.light.explanation.explanation import LIKELY_FAMILIES, Explanation
from ashe_live.light.shape.body import LitBody
from ashe_live.light.views.evidence import joint_features
from ashe_live.light.views.joint import (
    JointStart,
    explained_in_views,
    explained_where_it_stands,
    own_costs,
    turned_from,
)
from ashe_live.light.views.joint_refinement import by_families
from tests.light.painted_scenes import BOX, paint
from tests.light.synthetic_masks import direction


def explained() -> Explanation:
    _, trace = ProxyEstimator(FAST).traced(paint(BOX).tracked)
    return trace.judged[int(np.argmax(trace.probabilities))]


def lit_from(lit: LitBody, azimuth_deg: float, elevation_deg: float) -> LitBody:
    return dataclasses.replace(lit, lights=np.array([[*direction(azimuth_deg, elevation_deg), 0.0]]))


def test_a_start_that_alignment_turns_or_loses_is_kept_where_it_stood() -> None:
    one = explained()
    here = one.alignment.placed.lit
    start, turned = (
        JointStart(one, lit, [own_costs(one)]) for lit in (here, lit_from(here, azimuth_deg=225, elevation_deg=40))
    )
    (aligned,) = explained_in_views([start])
    assert aligned is not None
    assert not turned_from([start], [aligned])
    for kept in turned_from([turned, turned], [aligned, None]):
        towards = kept.joint.lights[0].to_light_marker
        assert angle_between(towards, turned.lit.to_lights_marker[0]) < 1e-6
    assert len(turned_from([turned, turned], [aligned, None])) == 2


def test_a_light_that_further_views_move_depends_no_more_on_the_family() -> None:
    one = explained()
    here, costs = one.alignment.placed.lit, [own_costs(one)]
    (aligned,) = explained_in_views([JointStart(one, here, costs)])
    assert aligned is not None
    likeliest, *others = by_families(aligned, FAST.fine_fit)
    assert others
    lights = [each.joint.lights[0].to_light_marker for each in (likeliest, *others)]
    own, told = lights[0], joint_features(likeliest)["family"]
    assert told == pytest.approx(np.median([angle_between(own, each) for each in lights[:LIKELY_FAMILIES]]), abs=1e-6)
    azimuth, elevation = np.degrees(angles_from_direction(own))
    moved = explained_where_it_stands(JointStart(likeliest.origin, lit_from(here, azimuth + 5, elevation + 5), costs))
    assert moved is not None
    assert joint_features(moved)["family"] == told
