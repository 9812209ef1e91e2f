"""The light whose shadow a hull casts, as silhouettes of any shape and the smoothness of solids constrain it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between, normalised, tangent_basis
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from ashe_live.light.hull.carved import Carved, InLight
from ashe_live.light.hull.measured import shape_and_shadow
from ashe_live.light.hull.supports import ShadowLines, SupportFunction
from ashe_live.light.views.joint.average_light import log_likelihoods_by_pixels

COARSE_RAD, COARSE = math.radians(4.0), 5  # step of the first grid of directions, and steps to each side
FINE_SIGMAS, FINE = 0.8, 3  # of the second, in sigmas of the first one's result
FINEST_RAD = math.radians(0.5)  # below which voxels and pixels do not resolve directions
LOWEST_SINE = 0.06  # of a light's elevation
# Log likelihood that pixels and tangents together may lack of the most that each reaches by itself: where two sigmas do
# not bring them together, the labels of one are wrong.
MOST_APART = 6.0


@dataclass(frozen=True, slots=True, eq=False)
class HullLight:
    """The light of a hull."""

    to_light_marker: Float  # (3,)
    covariance_rad2: Float  # (2, 2) on its tangent basis: larger azimuth, larger elevation
    seen: InLight  # what the hull explains in it


def light_of_hull(hull: Carved, start: Float) -> HullLight | None:
    """The posterior mean of the light's direction around `start` (3,), with its covariance; None where that is unknown.

    The likelihood is that of the views' pixels under the hull in each light, times that of the shadow's tangents under
    the support function that the silhouettes leave (docs/maths, "A hull"), on a grid of directions around the start,
    and on a finer one around its result. It is unknown where too little of the shadow's outline is seen, where the two
    contradict each other, and where the result contradicts the start, a family's light by the same labels: one of both
    is wrong then, and the family's probability is not the result's.
    """
    around = _grid(start, COARSE_RAD, COARSE)
    by_pixels = _log_likelihood_by_pixels(hull, around)
    first, _ = _posterior(around, by_pixels)
    shape = shape_and_shadow(hull.views, hull.in_light(first).masks, hull.middle)
    if shape is None:
        return None
    support, shadow = shape
    by_tangents = _log_likelihood_by_tangents(support, shadow, around)
    shadow = support.without_outliers(shadow, around[int((by_pixels + by_tangents).argmax())])
    by_tangents = _log_likelihood_by_tangents(support, shadow, around)
    if (by_pixels + by_tangents).max() < by_pixels.max() + by_tangents.max() - MOST_APART:
        return None
    mean, covariance = _posterior(around, by_pixels + by_tangents)
    step = max(FINE_SIGMAS * math.sqrt(float(np.trace(covariance)) / 2), FINEST_RAD)
    around = _grid(mean, step, FINE)
    by_tangents = _log_likelihood_by_tangents(support, shadow, around)
    mean, covariance = _posterior(around, _log_likelihood_by_pixels(hull, around) + by_tangents)
    return HullLight(mean, covariance, hull.in_light(mean)) if angle_between(mean, start) < GOOD_RAD else None


def _log_likelihood_by_pixels(hull: Carved, directions: Sequence[Float]) -> Float:
    several = [hull.in_light(each) for each in directions]
    best = min(several, key=attrgetter("cost"))
    return log_likelihoods_by_pixels([seen.cost for seen in several], best.masks)


def _log_likelihood_by_tangents(support: SupportFunction, shadow: ShadowLines, directions: Sequence[Float]) -> Float:
    return np.array([support.log_likelihood(shadow, each) for each in directions])


def _grid(middle: Float, step_rad: float, steps: int) -> list[Float]:
    """Directions (3,) around `middle`, on a square grid of its tangent plane; those above LOWEST_SINE."""
    basis, several = tangent_basis(middle), math.tan(step_rad) * np.arange(-steps, steps + 1)
    found = [normalised(middle + x * basis[0] + y * basis[1]) for y in several for x in several]
    return [each for each in found if each[2] > LOWEST_SINE] or [middle]


def _posterior(directions: Sequence[Float], log_likelihood: Float) -> tuple[Float, Float]:
    """The mean direction (3,), and the covariance (2, 2) on its tangent basis, of a likelihood on a grid."""
    weights = np.exp(log_likelihood - log_likelihood.max())
    weights /= weights.sum()
    several = np.array(directions)
    mean = normalised(weights @ several)
    away = several @ tangent_basis(mean).T
    return mean, (away * weights[:, None]).T @ away + (FINEST_RAD / 2) ** 2 * np.eye(2)
