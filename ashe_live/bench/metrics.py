"""Metrics: the error of an answer, and the calibration of its stated uncertainty and confidence."""

import math
from collections.abc import Sequence
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import angle_between, normalised, tangent_basis

# Squared Mahalanobis radius of the ellipse that holds a sample of a 2D normal distribution with probability 0.95.
ELLIPSE_68 = -2 * math.log(1 - 0.68)
ELLIPSE_95 = -2 * math.log(1 - 0.95)


def angular_error_deg(answer: ArrayLike, truth: ArrayLike) -> float:
    """Degrees between two directions (3,)."""
    return math.degrees(angle_between(answer, truth))


def worst_assigned_deg(answers: Sequence[ArrayLike], truths: Sequence[ArrayLike]) -> float:
    """The bottleneck assignment: the largest error when answers (3,) are matched to truths (3,) so that it is smallest.

    Raises ValueError when there are none, or their numbers differ.
    """
    if len(answers) != len(truths) or not len(answers):
        raise ValueError(f"{len(answers)} answers cannot be assigned to {len(truths)} truths")
    return min(
        max(angular_error_deg(answer, truth) for answer, truth in zip(answers, order, strict=True))
        for order in permutations(truths)
    )


def squared_sigmas(answer: Float, covariance_rad2: Float, truth: Float) -> float:
    """Squared Mahalanobis distance of `truth` (3,) from `answer` (3,) on the answer's tangent basis.

    The offset's length is the angle, so that large errors are measured correctly too.
    """
    angle = angle_between(answer, truth)
    along = np.asarray(tangent_basis(answer) @ normalised(truth))
    length = float(np.hypot(*along))
    offset = along * (angle / length) if length > 1e-12 else np.array([angle, 0.0])
    return float(offset @ np.linalg.solve(covariance_rad2, offset))


def rms_deg(answers: Sequence[ArrayLike], centre: ArrayLike | None = None) -> float:
    """Root mean square angle, in degrees, between directions (3,) and `centre` (3,), or their mean without one."""
    about = np.mean([normalised(answer) for answer in answers], axis=0) if centre is None else centre
    return math.sqrt(np.mean([angular_error_deg(answer, about) ** 2 for answer in answers]))


def brier_score(confidences: Sequence[float], outcomes: Sequence[bool]) -> float | None:
    """Mean squared difference of confidences and outcomes: 0 is perfect, 0.25 is a confidence of 0.5 every time.

    None without any.
    """
    if not len(confidences):
        return None
    return float(np.mean((np.asarray(confidences) - np.asarray(outcomes, dtype=np.float64)) ** 2))


def share(flags: Sequence[bool]) -> float | None:
    """The fraction of True among `flags`; None without any."""
    return float(np.mean(flags)) if len(flags) else None


def overlap(a: Mask, b: Mask) -> float:
    """Intersection over union of two masks of one shape; 1 for two empty ones."""
    union = np.count_nonzero(a | b)
    return float(np.count_nonzero(a & b) / union) if union else 1.0
