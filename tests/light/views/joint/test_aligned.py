"""One body and its lights, aligned in several views."""

import dataclasses

import numpy as np

from ashe_live.core.transforms import angle_between
from ashe_live.light.shape.body import LitBody
from ashe_live.light.views.joint.aligned import JointStart, explained_in_views, turned_from
from tests.light.painted_bodies import explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX
from tests.light.synthetic_masks import direction


def lit_from(lit: LitBody, azimuth_deg: float, elevation_deg: float) -> LitBody:
    return dataclasses.replace(lit, lights=np.array([[*direction(azimuth_deg, elevation_deg), 0.0]]))


def test_a_start_that_alignment_turns_or_loses_is_kept_where_it_stood() -> None:
    one = explanation_of(painted_region(BOX))
    here = one.lit
    start, turned = (
        JointStart(one, lit, [one.costs]) for lit in (here, lit_from(here, azimuth_deg=225, elevation_deg=40))
    )
    (aligned,) = explained_in_views([start])
    assert aligned is not None
    assert not turned_from([start], [aligned])
    for kept in turned_from([turned, turned], [aligned, None]):
        towards = kept.joint.lights[0].to_light_marker
        assert angle_between(towards, turned.lit.to_lights_marker[0]) < 1e-6
    assert len(turned_from([turned, turned], [aligned, None])) == 2
