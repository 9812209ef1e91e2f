"""How wrong an answer is, and what many of them come to."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.transforms import angle_between

GOOD_DEG = 5.0


def angular_error_deg(answer: ArrayLike, truth: ArrayLike) -> float:
    """Degrees between two directions (3,)."""
    return math.degrees(angle_between(answer, truth))


@dataclass(frozen=True, slots=True)
class ErrorSummary:
    """Angular errors of the cases that were answered, beside how many were not; None where there are none."""

    attempted: int
    abstained: int
    mean_deg: float | None
    median_deg: float | None
    p90_deg: float | None
    max_deg: float | None
    good_share: float | None  # of the attempted cases: answered, and less than GOOD_DEG wrong
    median_ms: float | None  # an estimate, answered or not


def summarise(errors_deg: Sequence[float], attempted: int, abstained: int, times_ms: Sequence[float]) -> ErrorSummary:
    """Statistics of `errors_deg`, one for every case that has a true light and was answered."""
    median_ms = float(np.median(times_ms)) if len(times_ms) else None
    if not errors_deg:
        return ErrorSummary(attempted, abstained, None, None, None, None, None, median_ms)
    errors = np.asarray(errors_deg)
    return ErrorSummary(
        attempted,
        abstained,
        float(errors.mean()),
        float(np.median(errors)),
        float(np.percentile(errors, 90)),
        float(errors.max()),
        float(np.count_nonzero(errors < GOOD_DEG) / attempted),
        median_ms,
    )
