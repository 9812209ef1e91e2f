"""Poses of views as nuisance parameters: what moves with them, and that a joint fit finds what they are off by."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import angle_between, pixels_by_pose, project, transform_points
from ashe_live.core.types import TrackedFrame
from ashe_live.light.edges.moved_views import moved_view, pose_cost, pose_offset
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.pixels.view import OVER_NOISE, View
from tests.light.painted_scenes import BOX, tracked_frame
from tests.light.painted_views import painted_from
from tests.light.synthetic_masks import direction

SIGMAS = np.array([0.01, 0.01, 0.01, 0.001, 0.001, 0.001])  # of poses: rad and metres
# Each view is off by another turn and shift.
OFF = SIGMAS * np.array(
    [[1.5, -1, 0.5, 0.5, -1, 0], [-1.5, 1, -0.5, 1, 0.5, 0], [-1, -1.5, 1, 0, 1, 0.5], [1, 1.5, -1, -1, -0.5, 0]]
)


def view(covariance: Float | None = None) -> View:
    tracked = tracked_frame(np.zeros((480, 640, 3), np.uint8), Camera.from_hfov((640, 480), 60.0))
    assert tracked.marker is not None
    return View.of(replace(tracked, marker=replace(tracked.marker, noise_covariance=covariance)), 640)


@pytest.mark.parametrize("parameter", range(6))
def test_points_move_with_a_pose_as_they_are_projected(parameter: int) -> None:
    points = np.array([[0.1, 0.05, 0.0], [0.05, -0.1, 0.08], [-0.1, 0.1, 0.03]])
    step = 1e-5 * np.eye(6)[parameter]
    ahead, behind = (moved_view(view(), sign * step) for sign in (1, -1))
    moved = project(ahead.camera, ahead.T_cam_marker, points) - project(behind.camera, behind.T_cam_marker, points)
    pose = view().T_cam_marker
    by_pose = pixels_by_pose(points @ pose[:3, :3].T, transform_points(pose, points), ahead.camera.K)
    assert moved / 2e-5 == pytest.approx(by_pose[..., parameter], abs=1e-5)


def test_a_pose_costs_what_it_has_been_moved_by() -> None:
    there = moved_view(view(np.diag(SIGMAS**2)), 2 * OFF[0])
    assert pose_offset(there) == pytest.approx(2 * OFF[0], rel=1e-6)
    assert pose_cost(there) == pytest.approx(np.sum((2 * OFF[0] / (OVER_NOISE * SIGMAS)) ** 2), rel=1e-6)
    assert pose_cost(moved_view(view(), OFF[0])) == 0


def test_views_whose_poses_are_off_move_to_where_one_body_fits_them_all() -> None:
    painted = [painted_from(heading, BOX, size=(640, 480)).tracked for heading in (70, 110, 90, 130)]

    def estimated(covariance: Float | None) -> tuple[float, float]:
        """The light's error, and the root mean square of how far the views' poses are off, in sigmas."""
        frames = [_off(tracked, off, covariance) for tracked, off in zip(painted, OFF, strict=True)]
        estimate, trace = ProxyEstimator(BALANCED).traced(frames[0], frames[1:])
        assert estimate.light is not None
        best = trace.judged[int(np.argmax(trace.probabilities))].alignment
        views = [one.costs.region.view for one in (best.placed, *best.elsewhere)]
        assert len(views) == len(painted)
        away = [
            pose_offset(each) + off
            for frame, off in zip(frames, OFF, strict=True)
            for each in views
            if each.shows(frame.marker)
        ]
        error = angle_between(estimate.light.to_light_marker, direction(200, 40))
        return error, float(np.sqrt(np.mean((np.array(away) / SIGMAS)[:, :3] ** 2)))

    fixed, moved = estimated(None), estimated(np.diag((SIGMAS / OVER_NOISE) ** 2))
    assert moved[1] < 0.7 * fixed[1]
    assert moved[0] < fixed[0]


def _off(tracked: TrackedFrame, off: Float, covariance: Float | None) -> TrackedFrame:
    """The frame with a pose that is off by (w, v), and said to have this covariance."""
    assert tracked.marker is not None
    pose = moved_view(View.of(tracked, 640), off).T_cam_marker
    return replace(tracked, marker=replace(tracked.marker, T_cam_marker=pose, noise_covariance=covariance))
