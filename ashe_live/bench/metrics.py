"""How wrong an answer is, and how honest what it says about its own error."""

import math
from collections.abc import Sequence
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import angle_between, normalised, tangent_basis

# Squared radius, in sigmas, of the ellipse that holds a 2D normal distribution's sample with probability 0.95.
ELLIPSE_95 = -2 * math.log(1 - 0.95)


def angular_error_deg(answer: ArrayLike, truth: ArrayLike) -> float:
    """Degrees between two directions (3,)."""
    return math.degrees(angle_between(answer, truth))


def worst_assigned_deg(answers: Sequence[ArrayLike], truths: Sequence[ArrayLike]) -> float:
    """The largest of the errors when each answer (3,) is given to another truth (3,) such that it is smallest.

    Raises ValueError when there are not as many of the one as of the other, or none.
    """
    if len(answers) != len(truths) or not len(answers):
        raise ValueError(f"{len(answers)} answers cannot be assigned to {len(truths)} truths")
    return min(
        max(angular_error_deg(answer, truth) for answer, truth in zip(answers, order, strict=True))
        for order in permutations(truths)
    )


def squared_sigmas(answer: Float, covariance_rad2: Float, truth: Float) -> float:
    """Squared Mahalanobis distance of `truth` (3,) from `answer` (3,) on the answer's tangent basis.

    The offset is as long as the angle, so that it is right far away too.
    """
    angle = angle_between(answer, truth)
    along = np.asarray(tangent_basis(answer) @ normalised(truth))
    length = float(np.hypot(*along))
    offset = along * (angle / length) if length > 1e-12 else np.array([angle, 0.0])
    return float(offset @ np.linalg.solve(covariance_rad2, offset))


def rms_deg(answers: Sequence[ArrayLike], centre: ArrayLike | None = None) -> float:
    """Root mean square of the angles between directions (3,) and `centre` (3,), or else their mean direction."""
    about = np.mean([normalised(answer) for answer in answers], axis=0) if centre is None else centre
    return math.sqrt(np.mean([angular_error_deg(answer, about) ** 2 for answer in answers]))


def brier_score(confidences: Sequence[float], outcomes: Sequence[bool]) -> float | None:
    """Mean squared difference between what was promised and what came: 0 is perfect, 0.25 is "one half" every time."""
    if not len(confidences):
        return None
    return float(np.mean((np.asarray(confidences) - np.asarray(outcomes, dtype=np.float64)) ** 2))


def share(flags: Sequence[bool]) -> float | None:
    """Of True among `flags`; None without any."""
    return float(np.mean(flags)) if len(flags) else None


def overlap(a: Mask, b: Mask) -> float:
    """Intersection over union of two masks of one shape; 1 for two empty ones."""
    either = np.count_nonzero(a | b)
    return float(np.count_nonzero(a & b) / either) if either else 1.0
