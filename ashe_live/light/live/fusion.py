"""Fuses consecutive estimates into one: outliers are left out, and a light that has changed is forgotten.

Estimates of one view share the errors of marker and camera and most of the masks' errors, with unknown correlation.
They are therefore fused by covariance intersection (Julier and Uhlmann, A non-divergent estimation algorithm in the
presence of unknown correlations, 1997), which is consistent for any correlation: the fused covariance is never smaller
than justified. Weighted by confidence and precision, it is hardly larger than the best estimate's.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised, radius_of_68_percent, tangent_basis
from ashe_live.core.types import Illumination, Light, LightEstimate

MEMBERS = 8  # the number of latest estimates that are fused; older ones are dropped, as the sun moves
CHANGED_AFTER = 3  # consecutive estimates that contradict the fused one, and agree among themselves, to replace it
# 99th percentile of the chi-squared distribution with two degrees of freedom.
GATE = 9.21
# Errors of masks change in steps from frame to frame, even where each fit's covariance is small.
TOLERANCE_RAD = math.radians(2.5)
# Two lights whose shadow ratios differ by this factor are different, even from one direction: the sun, then a cloud.
OTHER_DEPTH = 1.5
UNKNOWN_SIGMA_RAD = math.radians(10)
LEAST_AREA = 1e-14  # rad^4, below which a covariance is as good as exact
UNKNOWN_CONFIDENCE = 0.3
NONE_CONFIDENCE = 0.2


class LightFusion:
    """The fused estimate of one scene, updated with estimates in their order in time."""

    def __init__(self) -> None:
        self.answer: LightEstimate | None = None  # with masks, body and frame of the latest member
        self._members: list[LightEstimate] = []
        self._dissent: list[LightEstimate] = []
        self._is_new = True

    @property
    def count(self) -> int:
        """The number of estimates that `answer` is fused from."""
        return len(self._members)

    @property
    def is_new(self) -> bool:
        """Whether the last estimate added did not agree with the answer before it, or was the first."""
        return self._is_new

    @property
    def is_settled(self) -> bool:
        """Whether further agreeing estimates would hardly change the answer."""
        return self.count == MEMBERS and not self._dissent

    def add(self, estimate: LightEstimate) -> bool:
        """Adds an estimate and updates `answer`; False when it is taken for an outlier and the answer stays."""
        self._is_new = self.answer is None or not agree(self.answer, estimate)
        if self.answer is None or not self._is_new:
            self._members.append(estimate)
            self._dissent.clear()
        else:
            self._dissent = [*(other for other in self._dissent if agree(other, estimate)), estimate]
            if len(self._dissent) < CHANGED_AFTER and _weight(self._dissent) <= _weight(self._members):
                return False
            self._members, self._dissent = self._dissent, []
        self._members = self._members[-MEMBERS:]
        self.answer = fused(self._members)
        return True


def agree(a: LightEstimate, b: LightEstimate) -> bool:
    """Whether both may be of the same light or lights, by their number, Mahalanobis distance and shadow ratios."""
    return _matched(a.lights, b.lights) is not None


def fused(estimates: Sequence[LightEstimate]) -> LightEstimate:
    """The fusion of estimates that agree; all but the lights and colours comes from the last of them.

    Raises ValueError when there are none.
    """
    if not estimates:
        raise ValueError("there is nothing to fuse")
    last = estimates[-1]
    if len(estimates) == 1 or not last.lights:
        return last
    weights = np.array([_confidence(estimate) * _precision(estimate) for estimate in estimates])
    weights /= weights.sum()
    rows = [_matched(last.lights, estimate.lights) or estimate.lights for estimate in estimates]
    lights = tuple(_fused_light(column, weights) for column in zip(*rows, strict=True))
    ambient = _mean([estimate.illumination.ambient_rgb_ratio for estimate in estimates], weights)
    ground = _mean([estimate.illumination.ground_rgb for estimate in estimates], weights)
    body = last.illumination.real_object
    return replace(last, illumination=Illumination(lights, ambient, ground, body))


def _fused_light(lights: Sequence[Light], weights: Float) -> Light:
    """The direction by covariance intersection in the tangent plane, the rest as weighted means.

    The confidence is that of the surest: the others agree with it, so that its direction is right if theirs are.
    weights: (n,), of sum 1.
    """
    mean = normalised(weights @ np.array([light.to_light_marker for light in lights]))
    information = np.array([_information(light) for light in lights])
    for _ in range(2):  # the second time in the tangent plane of the fused direction
        basis = tangent_basis(mean)
        on_plane = np.einsum("n,ai,nij->naj", weights, basis, information)
        offsets = np.array([light.to_light_marker - mean for light in lights])
        total = on_plane.sum(axis=0) @ basis.T
        mean = normalised(mean + np.linalg.solve(total, np.einsum("naj,nj->a", on_plane, offsets)) @ basis)
    basis = tangent_basis(mean)
    covariance = np.linalg.inv(basis @ np.einsum("n,nij->ij", weights, information) @ basis.T)
    is_known = all(light.covariance_rad2 is not None for light in lights)
    sizes = _mean([light.angular_size_rad for light in lights], weights)
    confidence = max((light.confidence for light in lights if light.confidence is not None), default=None)
    return Light(
        mean,
        covariance if is_known else None,
        radius_of_68_percent(covariance) if is_known else None,
        confidence,
        None if sizes is None else float(sizes),
        _mean([light.shadow_rgb_ratio for light in lights], weights),
    )


def _matched(a: Sequence[Light], b: Sequence[Light]) -> tuple[Light, ...] | None:
    """The lights `b` in the order of their matches in `a`; None when they are not the same lights."""
    if len(a) != len(b):
        return None
    for order in permutations(b):
        if all(_same_light(one, other) for one, other in zip(a, order, strict=True)):
            return order
    return None


def _same_light(a: Light, b: Light) -> bool:
    if a.shadow_rgb_ratio is not None and b.shadow_rgb_ratio is not None:
        factor = (float(a.shadow_rgb_ratio.mean()) + 1e-3) / (float(b.shadow_rgb_ratio.mean()) + 1e-3)
        if not 1 / OTHER_DEPTH <= factor <= OTHER_DEPTH:
            return False
    if a.to_light_marker @ b.to_light_marker <= 0:
        return False
    basis = tangent_basis(a.to_light_marker + b.to_light_marker)
    offset = basis @ (a.to_light_marker - b.to_light_marker)
    spread = basis @ (_covariance(a) + _covariance(b)) @ basis.T + TOLERANCE_RAD**2 * np.eye(2)
    return float(offset @ np.linalg.solve(spread, offset)) <= GATE


def _covariance(light: Light) -> Float:
    """(3, 3) rad^2 in the marker frame, 0 along the direction: regular at the zenith, unlike azimuth and elevation."""
    basis = tangent_basis(light.to_light_marker)
    covariance = UNKNOWN_SIGMA_RAD**2 * np.eye(2) if light.covariance_rad2 is None else light.covariance_rad2
    return np.asarray(basis.T @ covariance @ basis)


def _information(light: Light) -> Float:
    """(3, 3) pseudo-inverse of `_covariance`: the information within the tangent plane."""
    return np.asarray(np.linalg.pinv(_covariance(light), hermitian=True))


def _confidence(estimate: LightEstimate) -> float:
    if estimate.light is None:
        return NONE_CONFIDENCE
    # Above 0, so that weights can be normalised to sum 1.
    return max(UNKNOWN_CONFIDENCE if estimate.light.confidence is None else estimate.light.confidence, 1e-3)


def _precision(estimate: LightEstimate) -> float:
    """One over the area of the first light's covariance, so that vague estimates hardly widen a sharp one's answer."""
    if estimate.light is None or estimate.light.covariance_rad2 is None:
        return 1.0
    return 1 / math.sqrt(max(float(np.linalg.det(estimate.light.covariance_rad2)), LEAST_AREA))


def _weight(estimates: Sequence[LightEstimate]) -> float:
    return sum(map(_confidence, estimates))


def _mean(values: Sequence[Float | float | None], weights: Float) -> Float | None:
    """The weighted mean of the values that are not None; None if all are."""
    present = [(np.asarray(value), weight) for value, weight in zip(values, weights, strict=True) if value is not None]
    if not present:
        return None
    return np.asarray(sum(weight * value for value, weight in present) / sum(weight for _, weight in present))
