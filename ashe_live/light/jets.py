"""Numbers that carry their derivatives: what lets each family of bodies be written as plain formulas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float


@dataclass(frozen=True, slots=True)
class Jet:
    """Values (n, k) and their exact derivatives by the q parameters of each of n candidates."""

    value: Float
    slope: Float  # (n, k, q), or 1 in the place of n or k where all are the same

    def __add__(self, other: Jet | Float | float) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.value + other.value, self.slope + other.slope)
        return Jet(self.value + other, self.slope)

    def __sub__(self, other: Jet) -> Jet:
        return Jet(self.value - other.value, self.slope - other.slope)

    def __mul__(self, other: Jet | Float | float) -> Jet:
        if isinstance(other, Jet):
            slope = self.slope * other.value[..., None] + other.slope * self.value[..., None]
            return Jet(self.value * other.value, slope)
        factor = np.asarray(other, dtype=np.float64)
        return Jet(self.value * factor, self.slope * factor[..., None])

    __rmul__ = __mul__
    __radd__ = __add__


def parameters(theta: Float) -> list[Jet]:
    """The q columns of theta (n, q) as jets (n, 1), the ones with respect to which slopes are taken."""
    one_hot = np.eye(theta.shape[1])
    return [Jet(theta[:, i : i + 1], one_hot[None, i : i + 1]) for i in range(theta.shape[1])]


def exp(jet: Jet) -> Jet:
    value = np.exp(np.minimum(np.maximum(jet.value, -30.0), 30.0))
    return Jet(value, value[..., None] * jet.slope)


def share(jet: Jet) -> Jet:
    """The logistic function, between 0 and 1."""
    value = 1 / (1 + np.exp(np.minimum(np.maximum(-jet.value, -30.0), 30.0)))
    return Jet(value, (value * (1 - value))[..., None] * jet.slope)


def cos(jet: Jet) -> Jet:
    return Jet(np.cos(jet.value), -np.sin(jet.value)[..., None] * jet.slope)


def sin(jet: Jet) -> Jet:
    return Jet(np.sin(jet.value), np.cos(jet.value)[..., None] * jet.slope)


def stacked(groups: Sequence[tuple[Jet | None, ...]], counts: Sequence[int]) -> tuple[Float, Float]:
    """(n, k, f) values and (n, k, f, q) slopes of groups of rows, each of f jets (n, 1 or count); None stands for 0."""
    first = next(jet for jet in groups[0] if jet is not None)
    n, q = first.value.shape[0], first.slope.shape[2]
    values = np.zeros((n, sum(counts), len(groups[0])))
    slopes = np.zeros((*values.shape, q))
    begin = 0
    for group, count in zip(groups, counts, strict=True):
        for field, jet in enumerate(group):
            if jet is not None:
                values[:, begin : begin + count, field] = jet.value
                slopes[:, begin : begin + count, field] = jet.slope
        begin += count
    return values, slopes
