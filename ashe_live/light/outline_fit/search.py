"""Levenberg and Marquardt's method for families of bodies, many starts at once, with a loss that forgives outliers.

The starts of several families in several scenes are worked on in step: NumPy's calls cost more than their numbers,
which are few.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.outline_fit.residuals import Indices, Observations, Stacked, residuals
from ashe_live.light.shape.family import Family, padded
from ashe_live.light.shape.layout import Layout

SOLID_PRIOR = 0.25  # px^2 that one `spread` of a parameter costs: enough to keep what nothing else holds
LARGEST_STEP = 1.5
THINNING, TRIAL = 2, 4  # iterations before a third of the starts, and only the best one, go on
CONVERGED = 1e-2  # relative gain of the cost
FIRST_DAMPING, HIGHEST_DAMPING = 1e-2, 1e5
HOPELESS = 3.0  # a search whose cost remains above this multiple of its scene's best is given up


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A family in which to look for the body that explains a scene."""

    scene: int  # which one of the observations
    family: Family
    lights: Float  # (m, l, 4) to start from
    shapes: Float  # (m, q)


@dataclass(frozen=True, slots=True)
class Solution:
    """The best member of a family."""

    family: Family
    lights: Float  # (l, 4)
    shape: Float  # (q,)
    cost: float  # px^2
    mean_square: float  # px^2, of the forgiving loss, over the outlines' directions
    count: int  # of directions in which an outline was measured


def search(
    observations: Observations, problems: Sequence[Problem], least_cost: Float, iterations: int
) -> list[Solution]:
    """For each of m problems the member of its family and the lights that explain its scene's outlines best.

    After a few iterations only the best start goes on, and not even that when its cost is far above the least that is
    known for the scene by then; at first that is `least_cost`, one for each of the observations.
    """
    stack = _Stack.of(observations, problems)
    now = stack.started(problems)
    solved: dict[int, Solution] = {}
    for iteration in range(iterations):
        if iteration in (THINNING, TRIAL):
            now = now.of(now.best(1 / 3 if iteration == THINNING else 0.0))
        candidate = now.theta + stack.step(now)
        gain = now.improved(candidate, *stack.evaluated(now.problem, now.start, candidate))
        if iteration >= TRIAL:
            least_cost = stack.lowered(least_cost, now)
            over = now.over(gain, HOPELESS * least_cost[stack.scene], iteration > TRIAL)
            solved |= stack.solutions(now.of(over))
            now = now.of(~over)
            if not len(now.problem):
                break
    solved |= stack.solutions(now)
    return [solved[i] for i in range(len(problems))]


def stiffness_of(family: Family, layout: Layout) -> Float:
    """(split + q,) px^2 that theta costs as it leaves its start; lights may go anywhere."""
    return np.asarray(SOLID_PRIOR / np.array([np.inf] * layout.split + list(family.spread)) ** 2)


def information_on_lights(normal: Float, layout: Layout) -> Float:
    """(split, split) of (split + q, split + q): what is known of lights when the shape is not; the Schur complement."""
    split = layout.split
    own, mixed, others = normal[:split, :split], normal[:split, split:], normal[split:, split:]
    scale = np.sqrt(np.maximum(np.diag(others), 1e-9))
    balanced = others / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
    mixed = mixed / scale
    return np.asarray(own - mixed @ np.linalg.solve(balanced, mixed.T))


@dataclass(slots=True)
class _Candidates(Stacked):
    """Where n searches are."""

    problem: Indices  # (n,) which one is to be solved, ascending
    start: Float  # (n, split + q)
    theta: Float  # (n, split + q)
    damping: Float  # (n,)
    missed: Float  # (n, r)
    by_theta: Float  # (n, split + q, r)
    cost: Float  # (n,)

    def best(self, share: float = 0.0) -> Indices:
        """Indices of each problem's best one, or of this share of them if that is more."""
        order = np.lexsort((self.cost, self.problem))
        rank = np.arange(len(order)) - np.searchsorted(self.problem, self.problem)
        count = np.bincount(self.problem)[self.problem]
        return np.asarray(order[rank < np.maximum(1, (share * count).astype(int))])

    def improved(self, theta: Float, missed: Float, by_theta: Float, cost: Float) -> Float:
        """Takes the places that cost less; (n,) how much less."""
        better = cost < self.cost
        gain = np.where(better, self.cost - cost, 0.0)
        self.theta[better], self.missed[better] = theta[better], missed[better]
        self.by_theta[better], self.cost[better] = by_theta[better], cost[better]
        self.damping[:] = np.clip(self.damping * np.where(better, 0.2, 6.0), 1e-7, 1e7)
        return gain

    def over(self, gain: Float, hopeless: Float, settles: bool) -> Mask:
        """(n,) whether their problem is solved, as far as can be, or given up as it costs more than `hopeless` (m,)."""
        first = np.flatnonzero(np.diff(self.problem, prepend=-1))
        over = np.minimum.reduceat(self.cost, first) > hopeless[self.problem[first]]
        over |= np.minimum.reduceat(self.damping, first) > HIGHEST_DAMPING
        if settles:
            much = gain - CONVERGED * (self.cost + gain)
            over |= (np.maximum.reduceat(gain, first) > 0) & (np.maximum.reduceat(much, first) <= 0)
        return np.repeat(over, np.diff(first, append=len(self.problem)))


@dataclass(frozen=True, slots=True)
class _Stack:
    """m problems in step. What a family has fewer parameters than another stands after its own and moves nothing."""

    families: Sequence[Family]
    scene: Indices  # (m,)
    observations: Observations  # of each problem
    stiffness: Float  # (m, split + q)
    layout: Layout

    @classmethod
    def of(cls, observations: Observations, problems: Sequence[Problem]) -> Self:
        families = [problem.family for problem in problems]
        scene = np.array([problem.scene for problem in problems])
        layout = Layout(problems[0].lights.shape[1])
        stiffness = padded([stiffness_of(family, layout) for family in families])
        return cls(families, scene, observations.of(scene), stiffness, layout)

    def started(self, problems: Sequence[Problem]) -> _Candidates:
        start = padded(
            [
                self.layout.theta(lights, shape)
                for each in problems
                for lights, shape in zip(each.lights, each.shapes, strict=True)
            ]
        )
        problem = np.repeat(np.arange(len(problems)), [len(each.shapes) for each in problems])
        evaluated = self.evaluated(problem, start, start)
        return _Candidates(problem, start, start.copy(), np.full(len(start), FIRST_DAMPING), *evaluated)

    def evaluated(self, problem: Indices, start: Float, theta: Float) -> tuple[Float, Float, Float]:
        """What n candidates miss (n, r), its derivatives, and their costs (n,), which include leaving their start."""
        own, layout = self.observations.of(problem), self.layout
        families = [self.families[i] for i in problem]
        missed, by_theta = residuals(own, families, layout.lights_of(theta), layout.shape_of(theta))
        loss = (own.scale_px**2 * np.log1p((missed / own.scale_px) ** 2)).sum(axis=1)
        return missed, by_theta, loss + ((theta - start) ** 2 * self.stiffness[problem]).sum(axis=1)

    def step(self, now: _Candidates) -> Float:
        """(n, split + q) Levenberg and Marquardt's."""
        stiffness = self.stiffness[now.problem]
        weight = (now.missed != 0) / (1 + (now.missed / self.observations.scale_px[now.problem]) ** 2)
        normal, gradient = _normal_equations(now, weight)
        gradient += (now.theta - now.start) * stiffness
        diagonal = np.arange(stiffness.shape[1])
        curvature = normal[:, diagonal, diagonal]
        floor = 1e-6 * curvature.max(axis=1, keepdims=True) + 1e-12
        normal[:, diagonal, diagonal] += now.damping[:, None] * (curvature + floor) + floor + stiffness
        step = np.linalg.solve(normal, -gradient[..., None])[..., 0]
        return np.asarray(np.clip(step, -LARGEST_STEP, LARGEST_STEP))

    def lowered(self, least_cost: Float, now: _Candidates) -> Float:
        """The least cost that is known of each scene, now that these are."""
        least = least_cost.copy()
        np.minimum.at(least, self.scene[now.problem], now.cost)
        return least

    def solutions(self, now: _Candidates) -> dict[int, Solution]:
        """Of every problem that has candidates."""
        best = now.of(now.best())
        own = self.observations.of(best.problem)
        squares = (best.missed / own.scale_px) ** 2
        loss = (own.scale_px**2 * np.log1p(squares)).sum(axis=1)
        # Bounds are no measurements: what lies between them, or at one of them, could lie elsewhere.
        seen = (own.least_px == own.most_px).reshape(best.missed.shape)
        known = seen.sum(axis=1)
        found = {}
        for i, problem in enumerate(best.problem.tolist()):
            family, lights = self.families[problem], self.layout.lights_of(best.theta[i])
            shape = self.layout.shape_of(best.theta[i])[: family.size]
            square = float(loss[i]) / max(int(known[i]), 1)
            found[problem] = Solution(family, lights, shape, float(best.cost[i]), square, int(known[i]))
        return found


def _normal_equations(now: _Candidates, weight: Float) -> tuple[Float, Float]:
    """(n, split + q, split + q) and (n, split + q) of the weighted squares."""
    weighted = now.by_theta * weight[:, None]
    return weighted @ now.by_theta.swapaxes(1, 2), (weighted @ now.missed[..., None])[..., 0]
