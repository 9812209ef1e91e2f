"""Answers that were found more than once."""

import dataclasses
import math

import numpy as np
import pytest

from ashe_live.core.transforms import normalised
from ashe_live.light.shape.body import LitBody
from ashe_live.light.views.joint.aligned import JointExplanation, JointStart, costs_of_views, explained_where_it_stands
from ashe_live.light.views.joint.repeated import counted_once, show_the_same
from tests.light.painted_views import explained_in_two_views


@pytest.fixture(scope="module")
def found() -> JointExplanation:
    """A box in two views, by a family."""
    joint = explained_in_two_views().joint
    lit = joint.lit
    return standing(JointStart(joint, lit, costs_of_views(joint)), lit)


def standing(start: JointStart, lit: LitBody) -> JointExplanation:
    there = explained_where_it_stands(dataclasses.replace(start, lit=lit))
    assert there is not None
    return there


def turned(found: JointExplanation, by_deg: float) -> JointExplanation:
    """The same body in a light of another azimuth."""
    lit = found.joint.lit
    x, y, z = normalised(lit.to_lights_marker[0])
    c, s = math.cos(math.radians(by_deg)), math.sin(math.radians(by_deg))
    light = np.array([[c * x - s * y, s * x + c * y, z, 0.0]])
    return standing(JointStart(found.joint, lit, costs_of_views(found.joint)), LitBody(lit.body, light))


def test_an_answer_that_is_found_again_is_no_likelier(found: JointExplanation) -> None:
    again = turned(found, 4)
    assert counted_once([(again, 0.5), (found, 1.0)]) == [(found, 1.0)]


def test_another_light_is_another_answer_though_object_and_shadow_are_much_the_same(found: JointExplanation) -> None:
    other = turned(found, 25)
    assert counted_once([(found, 1.0), (other, 0.5)]) == [(found, 1.0), (other, 0.5)]


def test_silhouettes_are_the_same_in_both_orders_and_not_with_a_shadow_elsewhere(found: JointExplanation) -> None:
    again, opposite = turned(found, 4), turned(found, 180)
    for one, other in ((found, again), (again, found)):
        assert show_the_same(one, other)
    assert not show_the_same(found, opposite)
    assert not show_the_same(opposite, found)


def test_another_object_in_the_same_light_counts_by_itself(found: JointExplanation) -> None:
    """What agrees without sharing its pixels is evidence of its own."""
    lit = found.joint.lit
    frame = dataclasses.replace(lit.body.frame, origin_marker=lit.body.frame.origin_marker + np.array([0.0, 0.05]))
    beside = LitBody(dataclasses.replace(lit.body, frame=frame), lit.lights)
    elsewhere = standing(JointStart(found.joint, lit, costs_of_views(found.joint)), beside)
    assert counted_once([(found, 1.0), (elsewhere, 0.5)]) == [(found, 1.0), (elsewhere, 0.5)]
