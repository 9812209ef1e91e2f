"""The light as a mean over families of bodies."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.views.joint.aligned import JointExplanation, towards_light
from ashe_live.light.views.joint.average_light import (
    probabilities_by_pixels,
    probabilities_by_steps,
    sharpened_families,
    with_average_light,
)
from ashe_live.light.views.joint.refinement import by_families
from tests.light.painted_views import explained_in_two_views, two_views
from tests.light.synthetic_masks import direction

OVERDISPERSION = 4.0


@pytest.fixture(scope="module")
def frames() -> list[TrackedFrame]:
    return list(two_views())


@pytest.fixture(scope="module")
def explanation() -> JointExplanation:
    return explained_in_two_views()


def lit_from(explanation: JointExplanation, azimuth_deg: float, elevation_deg: float) -> JointExplanation:
    covariance = explanation.joint.lights[0].covariance_rad2
    light = FittedLight(np.append(direction(azimuth_deg, elevation_deg), 0.0), covariance)
    return criterion(
        0.0, dataclasses.replace(explanation, joint=dataclasses.replace(explanation.joint, lights=(light,)))
    )


def criterion(value: float, explanation: JointExplanation) -> JointExplanation:
    """The explanation with this criterion of its steps of light."""
    return dataclasses.replace(explanation, joint=dataclasses.replace(explanation.joint, criterion=value))


def family(explanation: JointExplanation) -> str:
    return explanation.joint.lit.body.family.name


def dearer_by(cost: float, explanation: JointExplanation) -> JointExplanation:
    first, *others = explanation.each
    placed = dataclasses.replace(first.alignment.placed, cost=first.alignment.placed.cost + cost)
    dear = dataclasses.replace(first, alignment=dataclasses.replace(first.alignment, placed=placed))
    return dataclasses.replace(explanation, each=(dear, *others))


def test_families_that_explain_alike_are_alike_likely_and_dearer_ones_less(explanation: JointExplanation) -> None:
    a, b, c = probabilities_by_pixels([explanation, explanation, dearer_by(100.0, explanation)])
    assert a == b > c > 0
    assert a + b + c == pytest.approx(1.0)
    # Of more views, of which these costs are a smaller part, they tell the families apart less.
    twice = dataclasses.replace(explanation, each=explanation.each * 2)
    assert probabilities_by_pixels([twice, dearer_by(100.0, twice)])[1] > c / (a + c)


def test_steps_of_light_distinguish_families_by_their_criteria(explanation: JointExplanation) -> None:
    a, b, c = probabilities_by_steps(
        [criterion(5.0, explanation), criterion(5.0, explanation), criterion(9.0, explanation)]
    )
    assert a == b > c > 0
    assert a + b + c == pytest.approx(1.0)


def test_the_light_is_half_way_between_families_that_explain_alike(explanation: JointExplanation) -> None:
    low, high = lit_from(explanation, 200, 40), lit_from(explanation, 200, 46)
    found = with_average_light(low, [low, high], OVERDISPERSION)
    assert towards_light(found) == pytest.approx(direction(200, 43), abs=1e-3)
    before, after = (each.joint.lights[0].covariance_rad2 for each in (low, found))
    assert OVERDISPERSION * (after - before) == pytest.approx(np.diag([0.0, np.radians(3) ** 2]), rel=0.02, abs=1e-6)


def test_another_answer_and_a_dear_family_do_not_move_the_light(explanation: JointExplanation) -> None:
    low, elsewhere = lit_from(explanation, 200, 40), lit_from(explanation, 80, 40)
    assert towards_light(with_average_light(low, [low, elsewhere], OVERDISPERSION)) == pytest.approx(towards_light(low))
    dear = criterion(100.0, lit_from(explanation, 200, 46))
    assert towards_light(with_average_light(low, [low, dear], OVERDISPERSION)) == pytest.approx(towards_light(low))


def test_of_families_the_one_that_lies_on_the_steps_of_light_comes_first(
    frames: list[TrackedFrame], explanation: JointExplanation
) -> None:
    """Even where a box was taken for something else."""
    families = by_families(explanation, FAST.fine_fit)
    sharpener = Sharpener.of([View.of(frame, FAST.fine_width_px) for frame in frames])
    boxes = [one for one in families if family(one) == "box"]
    others = [one for one in families if family(one) != "box"]
    assert boxes
    assert others
    found = sharpened_families(others[0], [boxes[0], *others], sharpener)
    assert family(found[0]) == "box"
    assert all(np.isfinite(one.joint.criterion) for one in found)
    assert sorted(one.joint.criterion for one in found) == [one.joint.criterion for one in found]


def test_two_lights_and_a_light_without_families_stay(explanation: JointExplanation) -> None:
    low, high = lit_from(explanation, 200, 40), lit_from(explanation, 200, 46)
    both = dataclasses.replace(low, joint=dataclasses.replace(low.joint, lights=low.joint.lights * 2))
    assert with_average_light(both, [low, high], OVERDISPERSION) is both
    assert with_average_light(low, [], OVERDISPERSION) is low
