"""Levenberg and Marquardt's method for a family of bodies, many starts at once, with a loss that forgives outliers.

The starts of several problems are worked on in step: NumPy's calls cost more than their numbers, which are few.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.proxies import Family
from ashe_live.light.silhouettes import Outlines
from ashe_live.light.supports import outline_supports

SOLID_PRIOR = 0.25  # px^2 that one `spread` of a parameter costs: enough to keep what nothing else holds
LARGEST_STEP = 1.5
THINNING, TRIAL = 2, 5  # iterations before a third of the starts, and only the best ones, go on
CONVERGED = 1e-3  # relative gain of the cost
HIGHEST_DAMPING = 1e5
Indices = NDArray[np.intp]


class _Stacked:
    """A dataclass of arrays that go along in their first axis."""

    __slots__: tuple[str, ...] = ()

    def of(self, rows: Indices | Mask) -> Self:
        """Some of them, or one several times."""
        return type(self)(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(frozen=True, slots=True)
class Sights(_Stacked):
    """What n searches have to explain: outlines, as seen by a camera about their centre."""

    P: Float  # (n, 3, 4) pixels from the bodies' frame
    directions: Float  # (n, d, 2)
    least_px: Float  # (n, 1 + l or 2 + l, d) as in Outlines; without the last row where that bounds nothing
    most_px: Float
    scale_px: Float  # (n, 1) errors beyond it count less and less

    @staticmethod
    def stacked(cameras: Sequence[Float], outlines: Sequence[Outlines], scales_px: Sequence[float]) -> "Sights":
        """Of outlines of equally many shadows; where one has fewer directions than others, nothing bounds the rest."""
        n, (rows, _) = len(outlines), outlines[0].least_px.shape
        d = max(len(one.directions) for one in outlines)
        directions = np.zeros((n, d, 2))
        least, most = np.full((n, rows, d), -np.inf), np.full((n, rows, d), np.inf)
        for i, one in enumerate(outlines):
            own = slice(len(one.directions))
            directions[i, own], least[i, :, own], most[i, :, own] = one.directions, one.least_px, one.most_px
        if np.isneginf(least[:, -1]).all():
            least, most = least[:, :-1], most[:, :-1]
        return Sights(np.array(cameras), directions, least, most, np.array(scales_px)[:, None])


@dataclass(frozen=True, slots=True)
class Solution:
    """The best member of a family."""

    family: Family
    slants: Float  # (l, 2)
    shape: Float  # (q,)
    cost: float  # px^2
    mean_square: float  # px^2, of the forgiving loss, over the outlines' directions
    count: int  # of directions in which an outline was measured
    normal: Float  # (2 l + q, 2 l + q) information on slants and shape, were errors independent and 1 px large


def information_on_slants(normal: Float, count: int) -> Float:
    """(count, count) of (count + q, count + q): what is known of slants when the shape is not; the Schur complement."""
    own, mixed, others = normal[:count, :count], normal[:count, count:], normal[count:, count:]
    scale = np.sqrt(np.maximum(np.diag(others), 1e-9))
    balanced = others / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
    mixed = mixed / scale
    return np.asarray(own - mixed @ np.linalg.solve(balanced, mixed.T))


@dataclass(frozen=True, slots=True)
class _Candidates(_Stacked):
    """Where n searches are."""

    problem: Indices  # (n,) which one is to be solved, ascending
    start: Float  # (n, 2 l + q)
    theta: Float  # (n, 2 l + q)
    damping: Float  # (n,)
    missed: Float  # (n, r)
    by_theta: Float  # (n, r, 2 l + q)
    cost: Float  # (n,)

    def best(self, kept: int, share: float) -> Indices:
        """Indices of each problem's `kept` best ones, or of this share of them if that is more."""
        order = np.lexsort((self.cost, self.problem))
        rank = np.arange(len(order)) - np.searchsorted(self.problem, self.problem)
        count = np.bincount(self.problem)[self.problem]
        return np.asarray(order[rank < np.maximum(kept, (share * count).astype(int))])

    def improved(self, theta: Float, missed: Float, by_theta: Float, cost: Float) -> Float:
        """Takes the places that cost less; (n,) how much less."""
        better = cost < self.cost
        gain = np.where(better, self.cost - cost, 0.0)
        self.theta[better], self.missed[better] = theta[better], missed[better]
        self.by_theta[better], self.cost[better] = by_theta[better], cost[better]
        self.damping[:] = np.clip(self.damping * np.where(better, 0.2, 6.0), 1e-7, 1e7)
        return gain

    def over(self, gain: Float, hopeless: Float, settles: bool) -> Mask:
        """(n,) whether their problem is solved, as far as can be, or given up."""
        first = np.flatnonzero(np.diff(self.problem, prepend=-1))
        over = np.minimum.reduceat(self.cost, first) > hopeless[self.problem[first]]
        over |= np.minimum.reduceat(self.damping, first) > HIGHEST_DAMPING
        if settles:
            much = gain - CONVERGED * (self.cost + gain)
            over |= (np.maximum.reduceat(gain, first) > 0) & (np.maximum.reduceat(much, first) <= 0)
        return np.repeat(over, np.diff(first, append=len(self.problem)))


def stiffness_of(family: Family, split: int) -> Float:
    """(split + q,) px^2 that parameters cost as they leave their start; slants, the first `split`, may go anywhere."""
    return np.asarray(SOLID_PRIOR / np.array([np.inf] * split + list(family.spread)) ** 2)


def residuals(sights: Sights, family: Family, theta: Float) -> tuple[Float, Float]:
    """(n, r) pixels by which outlines are missed, and their derivatives (n, r, 2 l + q) by theta = (slants, shape)."""
    (n, rows, d), split = sights.least_px.shape, theta.shape[1] - len(family.spread)
    lights = split // 2
    parts, by_shape = family.parts(theta[:, split:])
    supports = outline_supports(sights.P, parts, theta[:, :split].reshape(n, lights, 2), sights.directions)
    k = parts.shape[1]
    touched = by_shape.reshape(n * k, 5, -1).take(supports.part + k * np.arange(n)[:, None, None], axis=0)
    reach = supports.reach_px
    by_theta = np.zeros((n, rows, d, theta.shape[1]))
    by_theta[:, : 1 + lights, :, split:] = (supports.by_part[..., None, :] @ touched)[..., 0, :]
    for light in range(lights):
        by_theta[:, 1 + light, :, 2 * light : 2 * light + 2] = supports.by_slant[:, light]
    if rows > 1 + lights:
        farthest = reach.argmax(axis=1)
        by_theta[:, -1] = by_theta[np.arange(n)[:, None], farthest, np.arange(d)]
        reach = np.concatenate([reach, reach.max(axis=1, keepdims=True)], axis=1)
    missed = np.minimum(reach - sights.least_px, 0.0) + np.maximum(reach - sights.most_px, 0.0)
    by_theta *= (missed != 0)[..., None]
    return missed.reshape(n, -1), by_theta.reshape(n, -1, theta.shape[1])


def search(
    sights: Sights, family: Family, starts: Sequence[Float], hopeless: Float, iterations: int, kept: int
) -> list[Solution]:
    """For each of m problems the member of `family` and the slants that explain its outlines best.

    starts: of each problem (n, 2 l + q). After a few iterations only the `kept` best go on, and none of them when their
    cost is above `hopeless` (m,) then.
    """
    problem = np.repeat(np.arange(len(starts)), [len(each) for each in starts])
    start = np.concatenate(starts)
    split = start.shape[1] - len(family.spread)
    stiffness = stiffness_of(family, split)
    own = sights.of(problem)

    def evaluate(theta: Float, start: Float) -> tuple[Float, Float, Float]:
        missed, by_theta = residuals(own, family, theta)
        loss = (own.scale_px**2 * np.log1p((missed / own.scale_px) ** 2)).sum(axis=1)
        return missed, by_theta, loss + ((theta - start) ** 2 * stiffness).sum(axis=1)

    now = _Candidates(problem, start, start.copy(), np.full(len(start), 1e-2), *evaluate(start, start))
    ended = []
    for iteration in range(iterations):
        if iteration in (THINNING, TRIAL):
            best = now.best(kept, 1 / 3 if iteration == THINNING else 0.0)
            if len(best) < len(now.problem):
                now = now.of(best)
                own = sights.of(now.problem)
        candidate = now.theta + _step(now, own.scale_px, stiffness)
        gain = now.improved(candidate, *evaluate(candidate, now.start))
        if iteration >= TRIAL and (over := now.over(gain, hopeless, iteration > TRIAL)).any():
            ended.append(now.of(over))
            now = now.of(~over)
            own = sights.of(now.problem)
            if not len(now.problem):
                break
    solutions = sorted(
        (solution for part in [*ended, now] for solution in _solved(part, sights, family, stiffness)),
        key=lambda pair: pair[0],
    )
    return [solution for _, solution in solutions]


def _step(now: _Candidates, scale_px: Float, stiffness: Float) -> Float:
    """(n, 2 l + q) Levenberg and Marquardt's."""
    normal, gradient = _normal_equations(now, 1 / (1 + (now.missed / scale_px) ** 2))
    gradient += (now.theta - now.start) * stiffness
    diagonal = np.arange(len(stiffness))
    curvature = normal[:, diagonal, diagonal]
    floor = 1e-6 * curvature.max(axis=1, keepdims=True) + 1e-12
    normal[:, diagonal, diagonal] += now.damping[:, None] * (curvature + floor) + floor + stiffness
    step = np.linalg.solve(normal, -gradient[..., None])[..., 0]
    return np.asarray(np.clip(step, -LARGEST_STEP, LARGEST_STEP))


def _normal_equations(now: _Candidates, weight: Float) -> tuple[Float, Float]:
    """(n, q, q) and (n, q) of the weighted squares."""
    weighted = (now.by_theta * weight[..., None]).swapaxes(1, 2)
    return weighted @ now.by_theta, (weighted @ now.missed[..., None])[..., 0]


def _solved(now: _Candidates, sights: Sights, family: Family, stiffness: Float) -> Iterator[tuple[int, Solution]]:
    """The solution of every problem that has candidates, and which one it is."""
    best = now.of(now.best(1, 0.0))
    own = sights.of(best.problem)
    squares = (best.missed / own.scale_px) ** 2
    loss = (own.scale_px**2 * np.log1p(squares)).sum(axis=1)
    # Bounds are no measurements: what lies between them, or at one of them, could lie elsewhere.
    seen = (own.least_px == own.most_px).reshape(best.missed.shape)
    normal, _ = _normal_equations(best, seen / (1 + squares))
    normal += np.diag(stiffness)
    split = len(stiffness) - len(family.spread)
    for i, problem in enumerate(best.problem):
        slants, shape, known = best.theta[i, :split].reshape(-1, 2), best.theta[i, split:], int(seen[i].sum())
        square = float(loss[i]) / max(known, 1)
        yield int(problem), Solution(family, slants, shape, float(best.cost[i]), square, known, normal[i])
