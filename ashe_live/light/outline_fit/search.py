"""Levenberg-Marquardt search for bodies of several families, many starts at once, with a robust loss (Cauchy's).

The starts of several families in several scenes are iterated as one batch: the arrays are small, so the overhead of
NumPy's calls dominates.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.outline_fit.residuals import Indices, Observations, Stacked, residuals
from ashe_live.light.shape.family import Family, Members, padded
from ashe_live.light.shape.layout import ParameterLayout

PRIOR_COST = 0.25  # px^2, cost of a parameter one `spread` from its start: it settles what the outlines leave open
LARGEST_STEP = 1.5  # of each parameter in one iteration, in theta's units
# Iterations after which a third of the starts, and then only the best one, are kept.
FIRST_SELECTION, LAST_SELECTION = 2, 4
CONVERGED = 1e-2  # relative gain of the cost
FIRST_DAMPING, HIGHEST_DAMPING = 1e-2, 1e5  # Marquardt's; a search that is damped more is stuck
STEP_DAMPING, LONGEST_STEP = 1e-3, 1.0  # of single steps, from a start near the solution
GIVE_UP_FACTOR = 3.0  # a search whose cost remains above this multiple of its scene's best is given up


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """The search for the member of one family that fits one scene best."""

    scene: int  # index among the observations
    family: Family
    lights: Float  # (m, l, 4) of m starts
    shapes: Float  # (m, q) of the same starts
    nearness: Float  # (l,) w / z at which each light is held, in the bodies' frame: 0 for lights at infinity


@dataclass(frozen=True, slots=True)
class Solution:
    """The best member of a family, with its lights."""

    family: Family
    lights: Float  # (l, 4)
    shape: Float  # (q,)
    cost: float  # px^2, robust loss and prior
    mean_square: float  # px^2, robust loss per measurement
    count: int  # number of measurements: directions in which an outline was observed, not only bounded


def search(
    observations: Observations, problems: Sequence[Problem], least_cost: Float, iterations: int
) -> list[Solution]:
    """For each of m problems, the member of its family and the lights that fit its scene's outlines best.

    After a few iterations only the best start is kept, and it is given up if its cost is far above the least found for
    its scene so far. least_cost: the least costs found before, one for each of the observations; inf if there is none.
    """
    stack = _Stack.of(observations, problems)
    now = stack.started(problems)
    solved: dict[int, Solution] = {}
    for iteration in range(iterations):
        if iteration in (FIRST_SELECTION, LAST_SELECTION):
            now = now.of(now.best(1 / 3 if iteration == FIRST_SELECTION else 0.0))
        candidate = now.theta + stack.step(now)
        gain = now.accept(candidate, *stack.evaluated(now.problem, now.start, candidate))
        if iteration >= LAST_SELECTION:
            least_cost = stack.lowered(least_cost, now)
            finished = now.finished(gain, GIVE_UP_FACTOR * least_cost[stack.scene], iteration > LAST_SELECTION)
            solved |= stack.solutions(now.of(finished))
            now = now.of(~finished)
            if not len(now.problem):
                break
    solved |= stack.solutions(now)
    return [solved[i] for i in range(len(problems))]


def prior_information(family: Family, layout: ParameterLayout) -> Float:
    """(split + q,) px^2 diagonal of the prior's information on theta about its start; 0 for the lights."""
    return np.asarray(PRIOR_COST / np.array([np.inf] * layout.split + list(family.spread)) ** 2)


def damped_steps(normal: Float, gradient: Float) -> Float:
    """(n, t) the Gauss-Newton steps of n normal equations (n, t, t) with gradients (n, t), damped and limited."""
    damped, diagonal = normal.copy(), np.arange(normal.shape[1])
    curvature = normal[:, diagonal, diagonal]
    damped[:, diagonal, diagonal] += STEP_DAMPING * curvature + 1e-6 * curvature.max(axis=1, keepdims=True) + 1e-12
    return np.asarray(np.clip(np.linalg.solve(damped, gradient[..., None])[..., 0], -LONGEST_STEP, LONGEST_STEP))


def information_on_lights(normal: Float, layout: ParameterLayout) -> Float:
    """(split, split) information on the lights with the shape marginalised out: the Schur complement of `normal`."""
    split = layout.split
    of_lights, mixed, of_shape = normal[:split, :split], normal[:split, split:], normal[split:, split:]
    scale = np.sqrt(np.maximum(np.diag(of_shape), 1e-9))
    balanced = of_shape / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
    mixed = mixed / scale
    return np.asarray(of_lights - mixed @ np.linalg.solve(balanced, mixed.T))


def offset_of_lights(normal: Float, gradient: Float, layout: ParameterLayout) -> tuple[Float, Float]:
    """(split,) the lights' step by normal equations, the shape marginalised out; (split, split) information on it.

    Well conditioned also where a parameter is hardly constrained.
    """
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-12))
    balanced = normal / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
    offset = np.linalg.solve(balanced, gradient / scale) / scale
    return offset[: layout.split], information_on_lights(normal, layout)


@dataclass(slots=True)
class _Candidates(Stacked):
    """The states of n searches."""

    problem: Indices  # (n,) index of the problem that each works on, ascending
    start: Float  # (n, split + q) theta at the start
    theta: Float  # (n, split + q)
    damping: Float  # (n,) Marquardt's
    missed: Float  # (n, r) residuals, pixels
    by_theta: Float  # (n, split + q, r)
    cost: Float  # (n,)

    def best(self, fraction: float = 0.0) -> Indices:
        """Indices of each problem's cheapest candidates: the given fraction of them, at least one."""
        order = np.lexsort((self.cost, self.problem))
        rank = np.arange(len(order)) - np.searchsorted(self.problem, self.problem)
        count = np.bincount(self.problem)[self.problem]
        return np.asarray(order[rank < np.maximum(1, (fraction * count).astype(int))])

    def accept(self, theta: Float, missed: Float, by_theta: Float, cost: Float) -> Float:
        """Accepts, in place, the steps that lower the cost, and adapts the damping; returns (n,) the reductions."""
        better = cost < self.cost
        gain = np.where(better, self.cost - cost, 0.0)
        self.theta[better], self.missed[better] = theta[better], missed[better]
        self.by_theta[better], self.cost[better] = by_theta[better], cost[better]
        self.damping[:] = np.clip(self.damping * np.where(better, 0.2, 6.0), 1e-7, 1e7)
        return gain

    def finished(self, gain: Float, cost_limit: Float, may_converge: bool) -> Mask:
        """(n,) whether each one's problem is finished: converged, stuck, or given up as it costs too much.

        cost_limit: (m,) the highest cost that is not given up, for each problem. may_converge: whether a small gain
        counts as convergence yet.
        """
        first = np.flatnonzero(np.diff(self.problem, prepend=-1))
        finished = np.minimum.reduceat(self.cost, first) > cost_limit[self.problem[first]]
        finished |= np.minimum.reduceat(self.damping, first) > HIGHEST_DAMPING
        if may_converge:
            much = gain - CONVERGED * (self.cost + gain)
            finished |= (np.maximum.reduceat(gain, first) > 0) & (np.maximum.reduceat(much, first) <= 0)
        return np.repeat(finished, np.diff(first, append=len(self.problem)))


@dataclass(frozen=True, slots=True)
class _Stack:
    """m problems as one batch; shorter parameter vectors are padded with parameters that have no effect."""

    families: Sequence[Family]
    scene: Indices  # (m,)
    observations: Observations  # of each problem
    prior: Float  # (m, split + q)
    nearness: Float  # (m, l)
    layout: ParameterLayout

    @classmethod
    def of(cls, observations: Observations, problems: Sequence[Problem]) -> Self:
        families = [problem.family for problem in problems]
        scene = np.array([problem.scene for problem in problems])
        layout = ParameterLayout(problems[0].lights.shape[1])
        prior = padded([prior_information(family, layout) for family in families])
        nearness = np.array([problem.nearness for problem in problems])
        return cls(families, scene, observations.of(scene), prior, nearness, layout)

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
        """Residuals (n, r) of n candidates, their derivatives by theta, and the costs (n,), the prior included."""
        observed, layout = self.observations.of(problem), self.layout
        members = Members([self.families[i] for i in problem], layout.shape_of(theta))
        missed, by_theta = residuals(observed, members, layout.lights_of(theta, self.nearness[problem]))
        loss = (observed.scale_px**2 * np.log1p((missed / observed.scale_px) ** 2)).sum(axis=1)
        return missed, by_theta, loss + ((theta - start) ** 2 * self.prior[problem]).sum(axis=1)

    def step(self, now: _Candidates) -> Float:
        """(n, split + q) Levenberg-Marquardt steps, clipped to LARGEST_STEP."""
        prior = self.prior[now.problem]
        weight = (now.missed != 0) / (1 + (now.missed / self.observations.scale_px[now.problem]) ** 2)
        normal, gradient = _normal_equations(now, weight)
        gradient += (now.theta - now.start) * prior
        diagonal = np.arange(prior.shape[1])
        curvature = normal[:, diagonal, diagonal]
        floor = 1e-6 * curvature.max(axis=1, keepdims=True) + 1e-12
        normal[:, diagonal, diagonal] += now.damping[:, None] * (curvature + floor) + floor + prior
        step = np.linalg.solve(normal, -gradient[..., None])[..., 0]
        return np.asarray(np.clip(step, -LARGEST_STEP, LARGEST_STEP))

    def lowered(self, least_cost: Float, now: _Candidates) -> Float:
        """(scenes,) the least cost found for each scene, the candidates' included."""
        least = least_cost.copy()
        np.minimum.at(least, self.scene[now.problem], now.cost)
        return least

    def solutions(self, now: _Candidates) -> dict[int, Solution]:
        """The best candidate of every problem that has any, by the problem's index."""
        best = now.of(now.best())
        observed = self.observations.of(best.problem)
        squares = (best.missed / observed.scale_px) ** 2
        loss = (observed.scale_px**2 * np.log1p(squares)).sum(axis=1)
        # Bounds are no measurements: an outline between them, or at one of them, could lie elsewhere too.
        is_measured = (observed.least_px == observed.most_px).reshape(best.missed.shape)
        measured = is_measured.sum(axis=1)
        found = {}
        for i, problem in enumerate(best.problem.tolist()):
            family = self.families[problem]
            lights = self.layout.lights_of(best.theta[i], self.nearness[problem])
            shape = self.layout.shape_of(best.theta[i])[: family.size]
            square = float(loss[i]) / max(int(measured[i]), 1)
            found[problem] = Solution(family, lights, shape, float(best.cost[i]), square, int(measured[i]))
        return found


def _normal_equations(now: _Candidates, weight: Float) -> tuple[Float, Float]:
    """(n, split + q, split + q) matrix and (n, split + q) gradient of the weighted normal equations."""
    weighted = now.by_theta * weight[:, None]
    return weighted @ now.by_theta.swapaxes(1, 2), (weighted @ now.missed[..., None])[..., 0]
