"""Metrics: the error of an answer, and the calibration of its stated uncertainty and confidence."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import angle_between, normalised, tangent_basis

BAD_DEG, BAD_CONFIDENCE = 15.0, 0.5  # error and confidence beyond which an answer is sure and wrong


def angular_error_deg(answer: ArrayLike, truth: ArrayLike) -> float:
    """Degrees between two directions (3,)."""
    return math.degrees(angle_between(answer, truth))


def squared_sigmas(answer: Float, covariance_rad2: Float, truth: Float) -> float:
    """Squared Mahalanobis distance of `truth` (3,) from `answer` (3,) on the answer's tangent basis."""
    offset = tangent_offset(answer, truth)
    return float(offset @ np.linalg.solve(covariance_rad2, offset))


def tangent_offset(answer: Float, truth: Float) -> Float:
    """(2,) radians from `answer` (3,) to `truth` (3,) on the answer's tangent basis.

    Its length is the angle, so that large errors are measured correctly too.
    """
    angle = angle_between(answer, truth)
    along = np.asarray(tangent_basis(answer) @ normalised(truth))
    length = float(np.hypot(*along))
    return along * (angle / length) if length > 1e-12 else np.array([angle, 0.0])


def rms_deg(answers: Sequence[ArrayLike], centre: ArrayLike) -> float:
    """Root mean square angle, in degrees, between directions (3,) and `centre` (3,)."""
    return math.sqrt(np.mean([angular_error_deg(answer, centre) ** 2 for answer in answers]))


def brier_score(confidences: Sequence[float], outcomes: Sequence[bool]) -> float | None:
    """Mean squared difference of confidences and outcomes: 0 is perfect, 0.25 is a confidence of 0.5 every time.

    None without any.
    """
    if not len(confidences):
        return None
    return float(np.mean((np.asarray(confidences) - np.asarray(outcomes, dtype=np.float64)) ** 2))


def risk_by_coverage(
    confidences: Sequence[float], is_good: Sequence[bool], is_lit: Sequence[bool], lit: int
) -> list[tuple[float, float, float]]:
    """(confidence, coverage, risk) as n answers are given one after another, the most confident first.

    Coverage is the fraction of the `lit` pictures with a light that are answered, risk the fraction of all answers
    given that are not good (Geifman and El-Yaniv, "Selective classification for deep neural networks", 2017).
    """
    order = np.argsort(-np.asarray(confidences, dtype=np.float64), kind="stable")
    covered = np.cumsum(np.asarray(is_lit, dtype=np.float64)[order]) / max(lit, 1)
    risk = np.cumsum(~np.asarray(is_good, dtype=np.bool_)[order]) / np.arange(1, len(order) + 1)
    return [(float(confidences[i]), float(c), float(r)) for i, c, r in zip(order.tolist(), covered, risk, strict=True)]


def risk_at(curve: Sequence[tuple[float, float, float]], coverage: float) -> tuple[float, float] | None:
    """(confidence, risk) where the curve first reaches the coverage; None where it does not."""
    return next(((confidence, risk) for confidence, covered, risk in curve if covered >= coverage), None)


def calibration_error(confidences: Sequence[float], is_good: Sequence[bool], bins: int = 10) -> float | None:
    """Expected calibration error: mean distance of confidence from the fraction of good ones, in bins of equal size.

    None without answers. (Naeini, Cooper and Hauskrecht, 2015, with quantile bins.)
    """
    if not len(confidences):
        return None
    order = np.argsort(np.asarray(confidences, dtype=np.float64), kind="stable")
    parts = [part for part in np.array_split(order, bins) if len(part)]
    stated, good = np.asarray(confidences, dtype=np.float64), np.asarray(is_good, dtype=np.float64)
    return float(sum(len(part) * abs(stated[part].mean() - good[part].mean()) for part in parts) / len(order))


def share(flags: Sequence[bool]) -> float | None:
    """The fraction of True among `flags`; None without any."""
    return float(np.mean(flags)) if len(flags) else None


def mean(values: Iterable[float | None]) -> float | None:
    """The mean of the values that are known; None where none is, as of the statistics below."""
    known = _known(values)
    return float(np.mean(known)) if known else None


def median(values: Iterable[float | None]) -> float | None:
    known = _known(values)
    return float(np.median(known)) if known else None


def percentile(values: Iterable[float | None], percent: float) -> float | None:
    known = _known(values)
    return float(np.percentile(known, percent)) if known else None


def largest(values: Iterable[float | None]) -> float | None:
    return max(_known(values), default=None)


def _known(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def overlap(a: Mask, b: Mask) -> float:
    """Intersection over union of two masks of one shape; 1 for two empty ones."""
    union = np.count_nonzero(a | b)
    return float(np.count_nonzero(a & b) / union) if union else 1.0
