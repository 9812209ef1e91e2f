"""Lamps and suns told apart: how answers stand to the true places of lights."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.bench.metrics import angular_error_deg, median, share, tangent_offset
from ashe_live.core.arrays import Float
from ashe_live.core.light import Light

BESIDE_M = 0.2  # from the object: where a model may stand
ELLIPSOID_95 = 7.815  # squared Mahalanobis distance in three dimensions that 95 % lie within


@dataclass(frozen=True, slots=True)
class LampFigures:
    """How one answer stands to the true place of its light."""

    true_distance_m: float | None  # of the strongest light from the marker's centre; None for a sun
    is_stated: bool  # whether the answer is a lamp
    beside_deg: float | None = None  # mean error of the direction BESIDE_M from the object, along x and y
    distance_error: float | None = None  # of a lamp stated as such: error of its distance over that distance
    sigmas: float | None = None  # of the same: error of its inverse distance, in standard deviations
    squared_sigmas: float | None = None  # of the same: squared Mahalanobis distance of direction and inverse distance
    radius_error: float | None = None  # of the same, where its radius is stated: error of that over the true one


def lamp_figures(light: Light | None, case: Case) -> LampFigures | None:
    """None for a case without a light, or with several; `light` is the answer's, None for no answer."""
    if case.to_lights_marker is None or len(case.to_lights_marker) != 1:
        return None
    lamp_m = case.lamp_m
    distance_m = None if lamp_m is None else float(np.linalg.norm(lamp_m))
    if light is None:
        return LampFigures(distance_m, is_stated=False)
    true = np.append(case.to_lights_marker[0], 0.0 if distance_m is None else 1 / distance_m)
    beside = None if case.foot_m is None else _beside_deg(light.homogeneous, true, case.foot_m)
    if light.inverse_distance == 0 or distance_m is None:
        return LampFigures(distance_m, is_stated=light.inverse_distance > 0, beside_deg=beside)
    off_by = abs(1 / light.inverse_distance / distance_m - 1)
    figures = LampFigures(distance_m, is_stated=True, beside_deg=beside, distance_error=off_by)
    if light.lamp_covariance is not None:
        off = np.append(tangent_offset(light.to_light_marker, true[:3]), true[3] - light.inverse_distance)
        sigmas = float(-off[2] / math.sqrt(light.lamp_covariance[2, 2]))
        squared = float(off @ np.linalg.solve(light.lamp_covariance, off))
        figures = replace(figures, sigmas=sigmas, squared_sigmas=squared)
    if light.radius_m is not None and case.lamp_radius_m is not None:
        figures = replace(figures, radius_error=abs(light.radius_m / case.lamp_radius_m - 1))
    return figures


def _beside_deg(answer: Float, truth: Float, foot_m: Float) -> float:
    """Mean error in degrees of a light (4,) for another (4,), beside an object at foot_m (2,)."""
    errors = []
    for offset in BESIDE_M * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)]):
        point = np.append(foot_m + offset, 0.0)
        errors.append(angular_error_deg(*(light[:3] - light[3] * point for light in (answer, truth))))
    return float(np.mean(errors))


@dataclass(frozen=True, slots=True)
class LampSummary:
    """Statistics of pictures with one light; None where none contributes."""

    attempted: int
    answered: float | None  # fraction of the pictures
    stated: float | None  # fraction of the answered that are stated as lamps
    beside_deg: float | None  # median
    distance_error: float | None
    within_1_sigma: float | None  # of the inverse distances of those stated
    within_ellipsoid_95: float | None  # of the places of those stated
    radius_told: float | None  # of those stated, fraction with a radius
    radius_error: float | None  # median


def summarise_lamps(figures: Sequence[LampFigures], answered: Sequence[bool]) -> LampSummary:
    """The statistics of pictures; `answered` tells which have an answer."""
    given = [each for each, is_answered in zip(figures, answered, strict=True) if is_answered]
    sigmas = [each.sigmas for each in given if each.sigmas is not None]
    squares = [each.squared_sigmas for each in given if each.squared_sigmas is not None]
    return LampSummary(
        attempted=len(figures),
        answered=share(list(answered)),
        stated=share([each.is_stated for each in given]),
        beside_deg=median(each.beside_deg for each in given),
        distance_error=median(each.distance_error for each in given),
        within_1_sigma=share([abs(each) <= 1 for each in sigmas]),
        within_ellipsoid_95=share([each <= ELLIPSOID_95 for each in squares]),
        radius_told=share([each.radius_error is not None for each in given if each.distance_error is not None]),
        radius_error=median(each.radius_error for each in given),
    )
