"""Of a square's two poses the likelier is meant, unless the other's error is decisively smaller."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.tracking.poses.pose_choice import in_order, is_from_below, longest_focal, turn_from
from ashe_live.tracking.poses.pose_refinement import PoseSolution


def solution(rms_px: float, tilt: float = 0.0) -> PoseSolution:
    return PoseSolution(cv2.Rodrigues(np.array([tilt, 0.0, 0.0]))[0], np.array([0.0, 0.0, 1.0]), rms_px, rms_px**2)


def order(likely_px: float, other_px: float, far: tuple[float, float] | None = None, unexplained_px: float = 0.1):
    """The errors of the chosen one and of the other; `far`: of both for the longest focal length."""
    likely, other = solution(likely_px), solution(other_px, tilt=1.0)
    of_longest = [
        solution(likely_px if far is None else far[0]),
        solution(other_px if far is None else far[1], tilt=1.0),
    ]
    found = in_order([other, likely], turn_from(np.eye(4)), unexplained_px, lambda: of_longest)
    return [one.rms_px for one in found]


@pytest.mark.parametrize(
    ("likely_px", "other_px", "chosen_px"),
    [
        (0.2, 0.9, 0.2),  # likelier and better
        (0.9, 0.6, 0.9),  # the other is better, but not by twice
        (0.9, 0.3, 0.3),  # decisively
        (0.09, 0.001, 0.09),  # by no more than noise explains
    ],
)
def test_the_likelier_is_meant_unless_the_other_is_decisively_better(likely_px, other_px, chosen_px) -> None:
    assert order(likely_px, other_px)[0] == chosen_px


def test_with_the_longest_focal_length_it_must_be_decisive_as_well() -> None:
    assert order(0.9, 0.3, far=(0.4, 0.3))[0] == 0.9
    assert order(0.9, 0.3, far=(0.9, 0.2))[0] == 0.3


def test_a_single_solution_is_the_one() -> None:
    alone = solution(0.5)
    assert in_order([alone], is_from_below, 0.1, lambda: [alone]) == [alone]


def test_the_longest_focal_length_is_two_deviations_of_its_logarithm_longer_about_the_same_centre() -> None:
    camera = Camera((640, 480), np.array([(600, 0, 300.0), (0, 610, 250), (0, 0, 1)]), np.zeros(5), "assumed", 60.0)
    longer = math.exp(2 * 60 / 600)
    np.testing.assert_allclose(longest_focal(camera), [(600 * longer, 0, 300), (0, 610 * longer, 250), (0, 0, 1)])


def test_a_table_is_seen_from_above() -> None:
    """The camera's y runs down: a surface that faces up has a normal against it."""
    for tilt_deg, is_below in ((130.0, False), (-130.0, True)):
        R = cv2.Rodrigues(np.array([math.radians(tilt_deg), 0.0, 0.0]))[0]
        assert is_from_below(PoseSolution(R, np.zeros(3), 0.0, 0.0)) is is_below


def test_a_turn_is_measured_from_the_last_pose() -> None:
    last = rigid(cv2.Rodrigues(np.array([0.3, 0.0, 0.0]))[0], (0.0, 0.0, 1.0))
    costs = [turn_from(last)(solution(0.0, tilt)) for tilt in (0.3, 0.4, 0.1, 1.5)]
    assert costs[0] == pytest.approx(0)
    assert costs == sorted(costs)
