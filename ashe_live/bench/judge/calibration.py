"""Fits how much errors exceed what outlines imply, so that 68 and 95 % of them lie within what is stated.

Quantile regression (Koenker and Bassett, 1978) of the errors' logs: a few answers that are wrong by much more than any
covariance states weigh no more than others, as they would not in a likelihood.
"""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np

from ashe_live.bench.descent import coordinate_descent
from ashe_live.core.arrays import Float
from ashe_live.core.transforms import ELLIPSE_68, ELLIPSE_95
from ashe_live.light.explanation.judgement.uncertainty import Calibration, covariance_of_outlines, overdispersed

# Where the search begins, its factors on each parameter from coarse to fine, and the ranges that make sense.
START = Calibration(1.0, math.radians(20.0), 2.0)
FACTORS = (2.0, 1.4, 1.1, 1.03, 1.01)
LIMITS = (0.1, 20.0), (math.radians(1), math.radians(90)), (0.5, 6.0)
# The share of errors and the squared Mahalanobis distance of each quantile that is fitted.
QUANTILES = ((0.68, ELLIPSE_68), (0.95, ELLIPSE_95))
LEAST_SQUARED = 1e-4  # squared Mahalanobis distance of an error: a smaller one is as good as none


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """A judged answer: its confidence, the error of its light by axis, and the covariance by its outlines."""

    confidence: float
    error_by_axis: Float  # (2,) rad on the light's tangent basis
    covariance_rad2: Float  # (2, 2)
    unseen_end: float = 0.0  # share of the elevation's variance by a shadow's end out of view


def fitted_calibration(answers: Sequence[Answer]) -> Calibration:
    """The calibration with the least sum of quantile losses, by coordinate descent in the parameters' logs."""
    fitted = coordinate_descent(astuple(START), lambda tried: _loss(Calibration(*tried), answers), FACTORS, LIMITS)
    return Calibration(*(round(value, 4) for value in fitted))


def squared_distances(calibration: Calibration, answers: Sequence[Answer]) -> Float:
    """(n,) squared Mahalanobis distance of each error under the calibrated covariance."""
    confidence = np.array([answer.confidence for answer in answers])
    errors = np.array([answer.error_by_axis for answer in answers])
    outlines = np.array([answer.covariance_rad2 for answer in answers])
    doubt = calibration.doubt_rad * (1 - confidence) ** calibration.doubt_power
    unseen_ends = np.array([answer.unseen_end for answer in answers])
    by_outlines = covariance_of_outlines(overdispersed(outlines, unseen_ends, calibration.overdispersion))
    total = by_outlines + (doubt**2)[:, None, None] * np.eye(2)
    return np.asarray((errors * np.linalg.solve(total, errors[..., None])[..., 0]).sum(axis=1))


def _loss(calibration: Calibration, answers: Sequence[Answer]) -> float:
    logs = np.log(np.maximum(squared_distances(calibration, answers), LEAST_SQUARED))
    total = 0.0
    for share, within in QUANTILES:
        beyond = logs - math.log(within)
        total += float(np.where(beyond > 0, share * beyond, (share - 1) * beyond).mean())
    return total
