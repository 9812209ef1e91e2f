"""Maximum likelihood of a conditional logit with an outside option, whose curves rise or fall as physics has it.

Each group of candidates (one picture's explanations) has one right choice, or none: then "none of them" is right. A
feature enters as a piecewise linear curve; its slopes are bounded by zero on the side that SIGNS forbids, and a ridge
penalty keeps those small that the groups do not need. The problem is solved by accelerated projected gradients (Beck
and Teboulle, "FISTA", 2009).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.bench.judge.samples import Candidate
from ashe_live.core.arrays import Float, Mask
from ashe_live.errors import UserError
from ashe_live.light.explanation.judgement.evidence import SIGNS
from ashe_live.light.explanation.judgement.judge_tables import Curve, Score

# The quantiles between which a curve has a slope; beyond the outer ones it is constant.
QUANTILES = (0.03, 0.35, 0.65, 0.97)
# Of features that are 0 where nothing speaks against an explanation, the quantiles of the values above.
QUANTILES_ABOVE = (0.33, 0.66, 0.95)
LEAST_STEP = 1e-3
RIDGE = 1.0  # inverse variance of a curve's step, in log odds
ROUNDS, TOLERANCE = 2000, 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    steps: Float  # (n, p) how much of each curve's steps a candidate has taken, with the sign of its contribution
    group: NDArray[np.intp]  # (n,)
    is_right: Mask  # (n,)
    count: int  # of groups
    weight: float  # of each group in the likelihood

    def loss(self, weights: Float) -> tuple[float, Float]:
        """The penalised negative log likelihood of (constant, steps) and its gradient (1 + p,)."""
        odds = weights[0] + self.steps @ weights[1:]
        every = self._log_sum(odds, np.ones(len(odds), np.bool_), outside=True)
        right = self._log_sum(odds, self.is_right, outside=False)
        decided = np.isfinite(right)
        missed = self.weight * (every - np.where(decided, right, 0.0)).sum()
        loss = float(missed + RIDGE * (weights[1:] ** 2).sum())
        share = np.exp(odds - every[self.group])
        target = np.zeros(len(odds))
        target[self.is_right] = np.exp(odds[self.is_right] - right[self.group[self.is_right]])
        slope = self.weight * (share - target)
        return loss, np.append(slope.sum(), self.steps.T @ slope + 2 * RIDGE * weights[1:])

    def _log_sum(self, odds: Float, taken: Mask, outside: bool) -> Float:
        """(groups,) log of the sum of odds in each group, and of "none" (1) with `outside`; -inf if empty."""
        top = np.full(self.count, 0.0 if outside else -np.inf)
        np.maximum.at(top, self.group[taken], odds[taken])
        finite = np.where(np.isfinite(top), top, 0.0)
        total = np.exp(-finite) if outside else np.zeros(self.count)
        np.add.at(total, self.group[taken], np.exp(odds[taken] - finite[self.group[taken]]))
        return np.where(total > 0, finite + np.log(np.maximum(total, 1e-300)), -np.inf)


def fitted_score(groups: Sequence[Sequence[Candidate]], weight: float = 1.0) -> Score:
    """The score of candidates by which the right ones, or none, are likeliest in all groups together.

    Right are a group's candidates with the highest `rightness` above 0. Candidates of a group share one probability,
    so it does not matter how often the right explanation was found. weight: of each group in the likelihood, below 1
    where several groups show the same picture. Raises UserError where there are no candidates at all.
    """
    every = [candidate for group in groups for candidate in group]
    if not every:
        raise UserError("nothing was tried in these pictures", "name more of them, with a marker, an object and ground")
    names = list(every[0].features)
    values = np.array([[candidate.features[name] for name in names] for candidate in every])
    knots = {name: _knots(values[:, i]) for i, name in enumerate(names)}
    steps = np.concatenate([_steps(values[:, i], knots[name], SIGNS[name]) for i, name in enumerate(names)], axis=1)
    index = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    best = [max((candidate.rightness for candidate in group), default=0) for group in groups]
    is_right = np.array([c.rightness == best[i] > 0 for i, group in enumerate(groups) for c in group])
    weights = _minimised(_Problem(steps, index, is_right, len(groups), weight))
    parts = np.split(weights[1:], np.cumsum([len(knots[name]) - 1 for name in names])[:-1])
    curves: Mapping[str, Curve] = {
        name: _curve(knots[name], SIGNS[name] * part) for name, part in zip(names, parts, strict=True)
    }
    return Score(round(float(weights[0]), 3), curves)


def _knots(values: Float) -> Float:
    """Rising values between which a feature's curve is linear."""
    if len(np.unique(values)) <= 2:
        return np.array([values.min(), values.min() + max(float(np.ptp(values)), 1.0)])
    if np.mean(values == values.min()) > QUANTILES[1] - QUANTILES[0]:
        above = values[values > values.min()]
        knots = np.array([values.min(), *np.quantile(above, QUANTILES_ABOVE)])
    else:
        knots = np.quantile(values, QUANTILES)
    knots = np.round(knots, 3)
    return np.asarray(knots[np.append(True, np.diff(knots) >= LEAST_STEP)])


def _steps(values: Float, knots: Float, sign: int) -> Float:
    """(n, k - 1) the fraction, 0 to 1, of the way between neighbouring knots (k,) that each value has gone."""
    low, high = knots[:-1], knots[1:]
    return np.asarray(sign * np.clip((values[:, None] - low) / (high - low), 0, 1))


def _curve(knots: Float, steps: Float) -> Curve:
    heights = np.round(np.append(0.0, np.cumsum(steps)), 3)
    return Curve(tuple(knots.tolist()), tuple(heights.tolist()))


def _minimised(problem: _Problem) -> Float:
    """The minimum over steps that are not negative."""
    weights = np.zeros(1 + problem.steps.shape[1])
    ahead, momentum, curvature = weights, 1.0, 1.0
    last = problem.loss(weights)[0]
    for _ in range(ROUNDS):
        loss, slope = problem.loss(ahead)
        while True:
            found = ahead - slope / curvature
            found[1:] = np.maximum(found[1:], 0)
            step = found - ahead
            reached = problem.loss(found)[0]
            if reached <= loss + slope @ step + 0.5 * curvature * step @ step + TOLERANCE:
                break
            curvature *= 2
        if reached > last:  # the momentum overshoots: start anew from the best point
            if momentum == 1.0:
                break
            ahead, momentum = weights, 1.0
            continue
        further = (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        ahead = found + (momentum - 1) / further * (found - weights)
        is_done = last - reached < TOLERANCE * abs(last) and momentum > 1
        weights, momentum, last, curvature = found, further, reached, 0.9 * curvature
        if is_done:
            break
    return weights
