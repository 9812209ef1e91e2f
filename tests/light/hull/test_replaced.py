"""Explanations by families beside one by a hull."""

import dataclasses

import numpy as np
import pytest

from ashe_live.light.hull.explained import without_replaced
from ashe_live.light.shape.body import LitBody
from ashe_live.light.views.joint.aligned import JointExplanation, JointStart, costs_of_views, explained_where_it_stands
from tests.light.painted_views import explained_in_two_views


@pytest.fixture(scope="module")
def several() -> tuple[JointExplanation, JointExplanation, JointExplanation]:
    """By a family; by a hull of the same silhouettes; and the same body with a shadow to the other side."""
    joint = explained_in_two_views().joint
    lit, costs = joint.lit, costs_of_views(joint)
    family = explained_where_it_stands(JointStart(joint, lit, costs))
    turned = LitBody(lit.body, np.array([[*(lit.to_lights_marker[0] * (-1, -1, 1)), 0.0]]))
    elsewhere = explained_where_it_stands(JointStart(joint, turned, costs))
    assert family is not None
    assert elsewhere is not None
    hull = dataclasses.replace(family, joint=dataclasses.replace(family.joint, hull=family.joint.proxy))
    return family, hull, elsewhere


def test_what_families_make_of_a_hulls_silhouettes_is_no_other_answer(
    several: tuple[JointExplanation, JointExplanation, JointExplanation],
) -> None:
    family, hull, _ = several
    assert without_replaced([(family, 1.0), (hull, 0.5)]) == [(hull, 0.5)]


def test_another_shadow_and_another_hull_stay(
    several: tuple[JointExplanation, JointExplanation, JointExplanation],
) -> None:
    _, hull, elsewhere = several
    found = [(hull, 0.5), (elsewhere, 0.2), (hull, 0.1)]
    assert without_replaced(found) == found


def test_without_a_hull_all_families_stay(
    several: tuple[JointExplanation, JointExplanation, JointExplanation],
) -> None:
    family, _, elsewhere = several
    assert without_replaced([(family, 1.0), (elsewhere, 0.5)]) == [(family, 1.0), (elsewhere, 0.5)]
