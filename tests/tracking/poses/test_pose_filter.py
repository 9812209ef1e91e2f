"""The filter: still when still, no lag when moving, never wrong by more than its gate."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import rigid
from ashe_live.tracking.poses.pose_filter import PoseFilter
from ashe_live.tracking.preset import BALANCED, TrackingPreset
from tests.tracking.conftest import SIDE_M, pose

PRESET = replace(BALANCED, filter_rest_s=0.3, filter_gate=3.0)
# Sure sideways, ten times less along the view, and the tilt least: what a small marker gives.
SIGMAS = np.array([0.01, 0.01, 0.002, 1e-4, 1e-4, 1e-3])
COVARIANCE = np.diag(SIGMAS**2)


def noisy(truth: Float, rng: np.random.Generator) -> Float:
    error = SIGMAS * rng.normal(size=6)
    return rigid(cv2.Rodrigues(error[:3])[0] @ truth[:3, :3], truth[:3, 3] + error[3:])


def filtered(poses: list[Float], preset: TrackingPreset = PRESET, covariance: Float = COVARIANCE) -> list[Float]:
    pose_filter = PoseFilter(SIDE_M)
    return [pose_filter.add(T, covariance, index / 30, preset) for index, T in enumerate(poses)]


def test_at_rest_noise_shrinks_to_less_than_a_third() -> None:
    rng, truth = np.random.default_rng(1), pose(0.5, 30)
    measured = [noisy(truth, rng) for _ in range(300)]
    held = filtered(measured)
    for rows in (slice(0, 3), 3):
        spread = [np.std([T[:3, rows] for T in poses[60:]], axis=0).max() for poses in (measured, held)]
        assert spread[1] < spread[0] / 3


def test_motion_beyond_the_noise_passes_at_once() -> None:
    """30 cm/s sideways and 90 degrees a second: after one frame nothing of it may be missing that could be seen."""
    moving = []
    for index in range(30):
        T = pose(0.5, 30, 3.0 * index)
        T[0, 3] += 0.01 * index
        moving.append(T)
    for T, held in zip(moving, filtered(moving, covariance=COVARIANCE / 25), strict=True):
        assert np.abs(held[:3, 3] - T[:3, 3]).max() < 1e-4
        assert np.abs(held[:3, :3] - T[:3, :3]).max() < 0.01


def test_what_is_held_is_never_wrong_by_more_than_the_gate() -> None:
    """Also where the marker creeps by less than the noise in each frame."""
    creeping = [pose(0.5, 30, 0, aside_m=0.3e-4 * index) for index in range(200)]
    lag = [np.abs(held[0, 3] - T[0, 3]) for T, held in zip(creeping, filtered(creeping), strict=True)]
    assert 0 < max(lag) < 1.2 * PRESET.filter_gate * SIGMAS[3]


def test_what_is_held_is_a_rotation() -> None:
    rng = np.random.default_rng(2)
    held = filtered([noisy(pose(0.5, 30, index), rng) for index in range(500)])[-1]
    assert held[:3, :3] @ held[:3, :3].T == pytest.approx(np.eye(3), abs=1e-9)


def test_off_after_a_gap_and_after_a_reset_the_measured_pose_is_shown() -> None:
    first, second = pose(0.5, 30), pose(0.5, 30.05)
    assert filtered([first, second], replace(PRESET, filter_rest_s=0.0))[1] is second
    for time_s, resets in ((5.0, False), (0.03, True), (-1.0, False)):
        pose_filter = PoseFilter(SIDE_M)
        pose_filter.add(first, COVARIANCE, 0.0, PRESET)
        if resets:
            pose_filter.reset()
        assert pose_filter.add(second, COVARIANCE, time_s, PRESET) is second


def test_an_exact_measurement_is_no_division_by_zero() -> None:
    pose_filter = PoseFilter(SIDE_M)
    for index in range(3):
        held = pose_filter.add(pose(0.5, 30), np.zeros((6, 6)), index / 30, PRESET)
    assert held == pytest.approx(pose(0.5, 30), abs=1e-12)
