"""How uncertain a direction is: the radius that holds the truth."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import PoseShapeErrors
from ashe_live.core.transforms import radius_of_68_percent, tangent_basis
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.judgement.judge import good_by_pose
from ashe_live.light.explanation.judgement.uncertainty import FLOOR_RAD, Calibration, overdispersed
from ashe_live.light.shape.directions import HEMISPHERE_RAD, FittedLight
from tests.light.painted_scenes import BOX, paint
from tests.light.synthetic_masks import direction

TO_LIGHT = direction(200.0, 40.0)


@pytest.fixture(scope="module")
def tracked() -> TrackedFrame:
    return paint(BOX).tracked


def held_by(radius: float, deviations: tuple[float, float]) -> float:
    """The probability that a normal sample lies within `radius`: over the angle, the radial part is exponential."""
    angles = np.linspace(0, np.pi, 20_001)[:-1] + 1e-5
    along = (deviations[0] * np.cos(angles)) ** 2 + (deviations[1] * np.sin(angles)) ** 2
    return float(1 - np.exp(-0.5 * radius**2 / along).mean())


@pytest.mark.parametrize("turn_rad", [0.0, 1.1])
@pytest.mark.parametrize("share", [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0])
def test_the_radius_holds_the_truth_with_probability_68_percent(share: float, turn_rad: float) -> None:
    axes = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    deviations = 0.03, 0.03 * share
    radius = radius_of_68_percent(axes @ np.diag(np.square(deviations)) @ axes.T)
    # Without any spread across, the angle's integrand is 0 almost everywhere.
    deviations = 0.03, max(0.03 * share, 1e-7)
    assert held_by(radius / 1.01, deviations) < 0.68 < held_by(radius * 1.01, deviations)


def test_no_spread_has_no_radius() -> None:
    assert radius_of_68_percent(np.zeros((2, 2))) == 0
    assert radius_of_68_percent(np.diag([-1e-18, 0.0])) == 0


def test_the_less_confident_an_answer_is_the_wider_it_is(tracked: TrackedFrame) -> None:
    calibration = Calibration(1.0, 0.5, 2.0)
    fitted = FittedLight(np.append(TO_LIGHT, 0.0), np.diag([1e-4, 4e-4]))
    spreads = [calibration.covariance(fitted, confidence, tracked) for confidence in np.linspace(0, 1, 11)]
    assert np.all(np.diff([radius_of_68_percent(each) for each in spreads]) < 0)
    doubt = spreads[3] - spreads[-1]
    np.testing.assert_allclose(doubt, (0.5 * 0.7**2) ** 2 * np.eye(2), atol=1e-12)


@pytest.mark.parametrize("overdispersion", [0.5, 1.0, 3.0])
def test_overdispersion_widens_what_the_outlines_state_and_nothing_else(
    overdispersion: float, tracked: TrackedFrame
) -> None:
    stated = np.array([[1e-6, 1e-6], [1e-6, 4e-6]])  # far narrower than the hemisphere
    fitted = FittedLight(np.append(TO_LIGHT, 0.0), stated)
    none, some = (Calibration(factor, 0.5, 2.0).covariance(fitted, 1.0, tracked) for factor in (0.0, overdispersion))
    np.testing.assert_allclose(some - none, overdispersion * stated, rtol=1e-4)


@pytest.mark.parametrize("by_outlines", [1e-9, 0.1, 1.0, 100.0])  # information, 1/rad^2
def test_what_is_known_before_any_outline_is_not_widened(by_outlines: float) -> None:
    prior, turned = np.eye(2) / HEMISPHERE_RAD**2, np.array([[0.8, -0.6], [0.6, 0.8]])
    outlines = turned @ np.diag([by_outlines, 5 * by_outlines]) @ turned.T
    wider = overdispersed(np.linalg.inv(outlines + prior), 0.0, 7.0)
    np.testing.assert_allclose(wider, np.linalg.inv(outlines / 7.0 + prior), rtol=1e-9)
    assert radius_of_68_percent(wider) < math.radians(61)  # that of the prior


@pytest.mark.parametrize("unseen_end", [0.0, 0.4, 1.0])
def test_what_an_end_out_of_view_leaves_open_is_no_error_of_outlines(unseen_end: float) -> None:
    stated = np.array([[1e-4, 1e-4], [1e-4, 4e-4]])
    wider = overdispersed(stated, unseen_end, 9.0)
    assert wider[0, 0] == pytest.approx(9e-4, rel=0.01)  # which is far narrower than the hemisphere
    assert wider[1, 1] == pytest.approx(4e-4 * (9 * (1 - unseen_end) + unseen_end), rel=0.01)
    assert np.linalg.det(wider) > 0
    assert overdispersed(stated, unseen_end, 1.0)[1, 1] == pytest.approx(4e-4)


def by_pose(tracked: TrackedFrame, **how: bool) -> Float:
    """The covariance of a direction that outlines determine, beyond the floor of systematic errors."""
    exact = FittedLight(np.append(TO_LIGHT, 0.0), np.zeros((2, 2)))
    return Calibration(1.0, 0.0, 1.0).covariance(exact, 1.0, tracked, **how) - FLOOR_RAD**2 * np.eye(2)


def moved_by(turn: Float, tracked: TrackedFrame) -> Float:
    """(2,) by how much a light that stays in the room moves, on its tangent basis, if the marker is seen so turned."""
    assert tracked.marker is not None
    R = tracked.marker.T_cam_marker[:3, :3]
    turned = cv2.Rodrigues(turn)[0] @ R
    return tangent_basis(TO_LIGHT) @ (turned.T @ R @ TO_LIGHT - TO_LIGHT)


def test_a_direction_is_as_unsure_as_the_markers_turn_leaves_it(tracked: TrackedFrame) -> None:
    assert tracked.marker is not None
    causes = 1e-4 * np.array([[3.0, 1.0, -2.0], [0.0, 2.0, 1.0], [1.0, 0.0, 4.0]])  # rows: independent turns
    covariance = np.diag([0.0, 0.0, 0.0, 1.0, 2.0, 3.0])  # a shift moves no direction
    covariance[:3, :3] = causes.T @ causes
    unsure = replace(tracked, marker=replace(tracked.marker, covariance=covariance))
    moves = np.array([moved_by(each, tracked) for each in causes])
    np.testing.assert_allclose(by_pose(unsure), moves.T @ moves, rtol=1e-3)
    np.testing.assert_allclose(by_pose(tracked), np.zeros((2, 2)), atol=1e-16)


def test_what_outlines_say_of_the_pose_as_the_body_may_be_off_counts_once(tracked: TrackedFrame) -> None:
    assert tracked.marker is not None
    R = tracked.marker.T_cam_marker[:3, :3]
    noise, of_body = 1e-4 * np.diag([1.0, 2.0, 3.0]), 1e-3 * np.array([[2.0, 0.0], [1.0, -1.0], [0.0, 3.0]])
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = noise @ noise + R @ of_body @ of_body.T @ R.T
    errors = PoseShapeErrors(np.vstack([of_body, np.zeros((3, 2))]), np.zeros((1, 3, 2)))
    marker = replace(tracked.marker, covariance=covariance)
    folded = replace(tracked, marker=replace(marker, pose_shape_errors=errors))
    moves = np.array([moved_by(each, tracked) for each in noise])
    np.testing.assert_allclose(by_pose(folded, has_shape_errors=True), moves.T @ moves, rtol=1e-3, atol=1e-12)
    rigid = by_pose(replace(tracked, marker=marker))
    np.testing.assert_allclose(by_pose(folded), rigid)
    np.testing.assert_allclose(by_pose(replace(tracked, marker=marker), has_shape_errors=True), rigid)


def turned_by(sigma_deg: float, tracked: TrackedFrame) -> TrackedFrame:
    """Whose marker's rotation is known to this standard deviation about each axis."""
    assert tracked.marker is not None
    covariance = np.diag([math.radians(sigma_deg) ** 2] * 3 + [1e-8] * 3)
    return replace(tracked, marker=replace(tracked.marker, covariance=covariance))


@pytest.mark.parametrize("sigma_deg", [1.0, 4.0, 8.0, 57.0])
def test_a_pose_puts_directions_off_as_often_as_its_turns_do(sigma_deg: float, tracked: TrackedFrame) -> None:
    turns = np.random.default_rng(1).normal(0.0, math.radians(sigma_deg), (4000, 3))
    # In the tangent plane, as the covariance is, where turns of a radian lead farther than on the sphere.
    off = np.linalg.norm(np.cross(turns, TO_LIGHT), axis=1)
    assert good_by_pose(TO_LIGHT, turned_by(sigma_deg, tracked)) == pytest.approx(
        np.mean(off < math.radians(10)), abs=0.02
    )


def test_no_answer_is_surer_than_the_pose_determines_it(tracked: TrackedFrame) -> None:
    sure, less, open_pose = (ProxyEstimator().estimate(turned_by(sigma, tracked)) for sigma in (0.1, 5.0, 57.0))
    assert sure.light is not None
    assert less.light is not None
    assert sure.light.confidence is not None
    assert less.light.confidence == pytest.approx(
        sure.light.confidence * good_by_pose(less.light.to_light_marker, turned_by(5.0, tracked)), abs=0.02
    )
    assert open_pose.light is None
    assert open_pose.reason is not None
    assert open_pose.reason.startswith("how the marker lies stays open")
