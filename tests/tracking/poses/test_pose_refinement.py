"""The refined pose has the least cost of all near it, and the last pose is followed only where it is one."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.tracking.poses.pose_refinement import FOLLOWED_PX, Correspondences, PoseSolution
from tests.tracking.conftest import SIDE_M, pose

CAMERA = Camera.from_focal((640, 480), 600, "file")
TRUTH = pose(0.5, 45, 20)
FLAT = square_corners(SIDE_M)
UPRIGHT = FLAT[:, [0, 2, 1]] + (0.0, SIDE_M / 2, SIDE_M / 2)


def correspondences(points: Float, noise_px: float = 0.5, seed: int = 0) -> Correspondences:
    """Corners of which some are less certain than others, and of which errors go together."""
    random = np.random.default_rng(seed)
    mixing = np.eye(2 * len(points)) + 0.3 * random.normal(0, 1, (2 * len(points),) * 2)
    covariance = noise_px**2 * mixing @ mixing.T
    pixels = project(CAMERA, TRUTH, points) + random.multivariate_normal(np.zeros(len(covariance)), covariance).reshape(
        -1, 2
    )
    return Correspondences(points, pixels, np.linalg.inv(covariance))


def beside(solution: PoseSolution, step: Float) -> tuple[Float, Float]:
    return cv2.Rodrigues(step[:3])[0] @ solution.R, solution.t + step[3:]


@pytest.mark.parametrize("points", [FLAT, np.concatenate([FLAT, UPRIGHT])], ids=["flat", "not flat"])
@pytest.mark.parametrize("off", [0.0, 0.05, 0.3])
def test_no_pose_near_the_refined_one_costs_less(points: Float, off: float) -> None:
    seen = correspondences(points)
    start = seen.solution(
        cv2.Rodrigues(np.array([off, -off, off]))[0] @ TRUTH[:3, :3], TRUTH[:3, 3] * (1 + off), CAMERA.K
    )
    assert start is not None
    found = seen.refined(start, CAMERA.K)
    assert found.cost <= start.cost
    standard_deviations = np.sqrt(np.diag(seen.covariances(found, CAMERA.K, np.linalg.inv(seen.information)).whole))
    for axis in range(6):
        for sign in (-0.05, 0.05):
            tried = seen.solution(*beside(found, sign * standard_deviations * np.eye(6)[axis]), CAMERA.K)
            assert tried is not None
            assert tried.cost > found.cost
    again = seen.refined(found, CAMERA.K)
    assert again.cost == pytest.approx(found.cost, rel=1e-6)


def test_the_cost_is_the_squared_error_in_standard_deviations() -> None:
    seen = correspondences(FLAT)
    found = seen.solution(TRUTH[:3, :3], TRUTH[:3, 3], CAMERA.K)
    assert found is not None
    error = (project(CAMERA, TRUTH, FLAT) - seen.pixels).ravel()
    assert found.cost == pytest.approx(error @ seen.information @ error)
    assert found.rms_px == pytest.approx(np.sqrt((error**2).sum() / 4))
    assert seen.solution(TRUTH[:3, :3], -TRUTH[:3, 3], CAMERA.K) is None


def test_covariances_are_those_of_least_squares() -> None:
    """By differences of the projection: with noise as the information has it, both are the same."""
    points = np.concatenate([FLAT, UPRIGHT])
    seen = correspondences(points)
    truth = seen.solution(TRUTH[:3, :3], TRUTH[:3, 3], CAMERA.K)
    assert truth is not None
    columns = []
    for axis in range(6):
        low, high = (rigid(*beside(truth, sign * 1e-6 * np.eye(6)[axis])) for sign in (-1, 1))
        columns.append((project(CAMERA, high, points) - project(CAMERA, low, points)).ravel() / 2e-6)
    jacobian = np.array(columns).T
    expected = np.linalg.inv(jacobian.T @ seen.information @ jacobian)
    found = seen.covariances(truth, CAMERA.K, np.linalg.inv(seen.information))
    scale = np.sqrt(np.diag(expected))
    for covariance in (found.whole, found.noise):
        np.testing.assert_allclose(covariance / np.outer(scale, scale), expected / np.outer(scale, scale), atol=1e-3)
    # A focal length that is longer by a thousandth moves the pose as much as its covariance says.
    longer = Correspondences(points, project(CAMERA, TRUTH, points), seen.information)
    K = CAMERA.K * np.array([(1.001, 1, 1), (1, 1.001, 1), (1, 1, 1)])
    moved = longer.refined(longer.solution(TRUTH[:3, :3], TRUTH[:3, 3], K), K)
    change = np.concatenate([cv2.Rodrigues(moved.R @ TRUTH[:3, :3].T)[0].ravel(), moved.t - TRUTH[:3, 3]]) / 0.001
    by_focal = longer.covariances(truth, CAMERA.K, np.linalg.inv(seen.information)).by_log_focal
    np.testing.assert_allclose(np.abs(change), np.sqrt(np.diag(by_focal)), rtol=0.02, atol=1e-3)


def test_the_last_pose_is_followed_only_where_no_second_one_is_possible_and_it_is_near() -> None:
    deep = correspondences(np.concatenate([FLAT, UPRIGHT]), noise_px=0.1)
    followed = deep.followed(TRUTH, CAMERA.K)
    assert followed is not None
    np.testing.assert_allclose(followed.t, TRUTH[:3, 3], atol=1e-3)
    assert correspondences(FLAT, noise_px=0.1).followed(TRUTH, CAMERA.K) is None
    moved = TRUTH.copy()
    moved[0, 3] += 3 * FOLLOWED_PX * TRUTH[2, 3] / CAMERA.K[0, 0]
    assert deep.followed(moved, CAMERA.K) is None
    # Points that lie hardly beside the plane tell no more than those in it.
    hardly = np.concatenate([FLAT, FLAT + np.array((0.0, 0.0, 0.1 * SIDE_M))])
    assert correspondences(hardly, noise_px=0.1).followed(TRUTH, CAMERA.K) is None
