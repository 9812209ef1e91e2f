"""Levenberg and Marquardt's method for a family of bodies, many starts at once, with a loss that forgives outliers."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.proxies import Family
from ashe_live.light.silhouettes import Outlines
from ashe_live.light.supports import outline_supports

SOLID_PRIOR = 0.25  # px^2 that one `spread` of a parameter costs: enough to keep what nothing else holds
LARGEST_STEP = 1.5
TRIAL = 5  # iterations before a search may be given up
CONVERGED = 1e-3  # relative gain of the cost


@dataclass(frozen=True, slots=True)
class Solution:
    """The best member of a family."""

    family: Family
    slants: Float  # (l, 2)
    shape: Float  # (q,)
    cost: float  # px^2
    mean_square: float  # px^2, of the forgiving loss, over the outlines' directions
    count: int  # of directions in which an outline was measured
    information: Float  # (2 l, 2 l) on the slants, were errors independent and 1 px large


def residuals(P: Float, outlines: Outlines, family: Family, lights: int, theta: Float) -> tuple[Float, Float]:
    """(n, r) pixels by which outlines are missed, and their derivatives (n, r, 2 l + q) by theta = (slants, shape)."""
    n, split = len(theta), 2 * lights
    parts, by_shape = family.parts(theta[:, split:])
    supports = outline_supports(P, parts, theta[:, :split].reshape(n, lights, 2), outlines.directions)
    d = len(outlines.directions)
    by_theta = np.zeros((n, 2 + lights, d, theta.shape[1]))
    by_theta[:, :-1, :, split:] = supports.by_parts @ by_shape.reshape(n, 1, -1, by_shape.shape[3])
    for light in range(lights):
        by_theta[:, 1 + light, :, 2 * light : 2 * light + 2] = supports.by_slant[:, light]
    farthest = supports.reach_px.argmax(axis=1)
    by_theta[:, -1] = by_theta[np.arange(n)[:, None], farthest, np.arange(d)]
    reach = np.concatenate([supports.reach_px, supports.reach_px.max(axis=1, keepdims=True)], axis=1)
    missed = np.minimum(reach - outlines.least_px, 0.0) + np.maximum(reach - outlines.most_px, 0.0)
    by_theta *= (missed != 0)[..., None]
    return missed.reshape(n, -1), by_theta.reshape(n, -1, theta.shape[1])


def search(
    P: Float,
    outlines: Outlines,
    family: Family,
    starts: Float,
    scale_px: float,
    iterations: int,
    kept: int,
    hopeless: float,
) -> Solution:
    """The member of `family` and the slants that explain outlines best.

    starts: (n, 2 l + q). Errors beyond `scale_px` count less and less (Cauchy's loss). After a few iterations only
    the `kept` best go on, and none of them when their cost is above `hopeless` then.
    """
    lights = len(outlines.shadows)
    spread = np.array([np.inf] * (2 * lights) + list(family.spread))
    stiffness = SOLID_PRIOR / spread**2
    diagonal = np.arange(starts.shape[1])

    def evaluate(theta: Float, start: Float) -> tuple[Float, Float, Float]:
        missed, by_theta = residuals(P, outlines, family, lights, theta)
        loss = scale_px**2 * np.log1p((missed / scale_px) ** 2).sum(axis=1)
        return missed, by_theta, loss + ((theta - start) ** 2 * stiffness).sum(axis=1)

    theta, start, damping = starts.copy(), starts, np.full(len(starts), 1e-2)
    missed, by_theta, cost = evaluate(theta, start)
    for iteration in range(iterations):
        if iteration in (2, TRIAL) and len(theta) > kept:
            best = np.argsort(cost, kind="stable")[: max(kept, len(theta) // 3 if iteration == 2 else 0)]
            theta, start, damping = theta[best], start[best], damping[best]
            missed, by_theta, cost = missed[best], by_theta[best], cost[best]
        normal, gradient = _normal_equations(missed, by_theta, scale_px)
        gradient += (theta - start) * stiffness
        curvature = normal[:, diagonal, diagonal]
        floor = 1e-6 * curvature.max(axis=1, keepdims=True) + 1e-12
        normal[:, diagonal, diagonal] += damping[:, None] * (curvature + floor) + floor + stiffness
        step = np.linalg.solve(normal, -gradient[..., None])[..., 0]
        candidate = theta + np.clip(step, -LARGEST_STEP, LARGEST_STEP)
        new_missed, new_by_theta, new_cost = evaluate(candidate, start)
        better = new_cost < cost
        gain = np.where(better, cost - new_cost, 0.0)
        settled = iteration > TRIAL and bool(better.any()) and bool((gain <= CONVERGED * cost).all())
        theta[better], missed[better] = candidate[better], new_missed[better]
        by_theta[better], cost[better] = new_by_theta[better], new_cost[better]
        damping = np.clip(damping * np.where(better, 0.2, 6.0), 1e-7, 1e7)
        if settled or bool((damping > 1e5).all()) or (iteration >= TRIAL and cost.min() > hopeless):
            break
    best_one = int(cost.argmin())
    seen = outlines.seen.ravel()
    # Bounds are no measurements: what lies between them, or at one of them, could lie elsewhere.
    normal, _ = _normal_equations(missed[best_one][None, seen], by_theta[best_one][None, seen], scale_px)
    known = int(seen.sum())
    loss = scale_px**2 * np.log1p((missed[best_one] / scale_px) ** 2).sum()
    return Solution(
        family,
        theta[best_one, : 2 * lights].reshape(lights, 2),
        theta[best_one, 2 * lights :],
        float(cost[best_one]),
        float(loss) / max(known, 1),
        known,
        _marginal_information(normal[0] + np.diag(stiffness), 2 * lights),
    )


def _normal_equations(missed: Float, by_theta: Float, scale_px: float) -> tuple[Float, Float]:
    """(n, q, q) and (n, q) of the weighted squares that approach Cauchy's loss here."""
    weight = 1 / (1 + (missed / scale_px) ** 2)
    weighted = (by_theta * weight[..., None]).swapaxes(1, 2)
    return weighted @ by_theta, (weighted @ missed[..., None])[..., 0]


def _marginal_information(information: Float, count: int) -> Float:
    """(count, count) information on the first parameters when the others are not known (Schur complement)."""
    own, mixed, others = information[:count, :count], information[:count, count:], information[count:, count:]
    scale = np.sqrt(np.maximum(np.diag(others), 1e-9))
    balanced = others / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
    mixed = mixed / scale
    return np.asarray(own - mixed @ np.linalg.solve(balanced, mixed.T))
