"""The metrics of the tracking bench: errors, flips, jitter and lag."""

import math
from collections.abc import Iterator, Sequence

import cv2
import numpy as np

from ashe_live.bench.track.contenders import Answer
from ashe_live.bench.track.takes import FPS, SIDE_M
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, project

FLIP_DEG, LASTING_FRAMES = 10.0, 3
MEDIAN_6 = 5.348  # of the chi-squared distribution with six degrees of freedom


def rotation_errors_deg(given: Sequence[Answer]) -> list[float]:
    """The angle between the rotation of each answer and the true one."""
    return [turn_deg(T, answer.truth) for answer, T in _answered(given)]


def turn_deg(T_a: Float, T_b: Float) -> float:
    """Degrees between the rotations of two poses (4, 4)."""
    chord = float(np.linalg.norm(T_a[:3, :3] - T_b[:3, :3]))
    return math.degrees(2 * math.asin(min(1.0, chord / math.sqrt(8))))


def flipped_share(given: Sequence[Answer]) -> float:
    """The fraction of answered frames in which the normal is wrong by more than FLIP_DEG."""
    flipped = [_is_flipped(T, answer.truth) for answer, T in _answered(given)]
    return float(np.mean(flipped)) if flipped else 0.0


def lasting_flips(given: Sequence[Answer]) -> int:
    """The number of runs of more than LASTING_FRAMES frames in which the normal is wrong by more than FLIP_DEG."""
    lasting, run = 0, 0
    for answer, T in _answered(given):
        run = run + 1 if _is_flipped(T, answer.truth) else 0
        lasting += run == LASTING_FRAMES + 1
    return lasting


def corner_jitter_px(given: Sequence[Answer], camera: Camera, unfiltered: bool = False) -> float:
    """RMS deviation of the corners, projected by each answer's pose, from their mean positions."""
    poses = [T if not unfiltered or a.pose is None else a.pose.measured_T_cam_marker for a, T in _answered(given)]
    corners = np.array([project(camera, T, square_corners(SIDE_M)) for T in poses])
    return float(np.sqrt(((corners - corners.mean(axis=0)) ** 2).sum(axis=2).mean()))


def lag_ms(given: Sequence[Answer]) -> float:
    """The delay of the answers' positions behind the true ones, by least squares."""
    truth = np.array([answer.truth[:3, 3] for answer in given])
    is_answered = [answer.T_cam_marker is not None for answer in given]
    # Of all frames, as those that are answered may have others between them.
    velocity = np.gradient(truth, 1 / FPS, axis=0)[is_answered]
    behind = truth[is_answered] - np.array([T[:3, 3] for _, T in _answered(given)])
    return float(1e3 * (behind * velocity).sum() / (velocity**2).sum())


def normalised_error_squared(given: Sequence[Answer]) -> float:
    """Median squared Mahalanobis error of the unfiltered poses under the covariances of their noise, over that of the
    chi-squared distribution: 1 if they are calibrated. The takes have noise, and no other errors.
    """
    squares = []
    for answer in given:
        if answer.pose is not None and answer.pose.noise_covariance is not None:
            error = pose_error(answer.pose.measured_T_cam_marker, answer.truth)
            squares.append(float(error @ np.linalg.solve(answer.pose.noise_covariance, error)))
    return float(np.median(squares)) / MEDIAN_6


def pose_error(T_cam_marker: Float, truth: Float) -> Float:
    """(6,) of (w, v), rad and m, by which a pose (4, 4) is off: as in MarkerPose.covariance."""
    turn = cv2.Rodrigues(T_cam_marker[:3, :3] @ truth[:3, :3].T)[0].ravel()
    return np.concatenate([turn, T_cam_marker[:3, 3] - truth[:3, 3]])


def _answered(given: Sequence[Answer]) -> Iterator[tuple[Answer, Float]]:
    for answer in given:
        if answer.T_cam_marker is not None:
            yield answer, answer.T_cam_marker


def _is_flipped(T_cam_marker: Float, truth: Float) -> bool:
    return math.degrees(angle_between(T_cam_marker[:3, 2], truth[:3, 2])) > FLIP_DEG
