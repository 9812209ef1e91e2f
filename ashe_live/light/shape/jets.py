"""Jets, numbers that carry their derivatives (forward-mode automatic differentiation), for the formulas of families."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float


@dataclass(slots=True)
class Jet:
    """Values and their exact derivatives by the q parameters of each of n candidates, in one array."""

    numbers: NDArray[Any]  # (n, k, 1 + q), real or complex, the values first

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.numbers + other.numbers)

    def __sub__(self, other: Jet) -> Jet:
        return Jet(self.numbers - other.numbers)

    def __mul__(self, other: Jet) -> Jet:
        one, two = self.numbers, other.numbers
        product = one * two[..., :1] + two * one[..., :1]
        product[..., 0] *= 0.5
        return Jet(product)

    def times(self, factors: Float) -> Jet:
        """Multiples (n, k) by k plain numbers."""
        return Jet(self.numbers * factors[:, None])

    @property
    def real(self) -> Jet:
        return Jet(self.numbers.real)

    @property
    def imag(self) -> Jet:
        return Jet(self.numbers.imag)


def parameters(theta: Float, logs: Sequence[int] = (), fractions: Sequence[int] = ()) -> list[Jet]:
    """What the q columns of theta (n, q) stand for, as jets (n, 1) whose derivatives are by theta.

    logs: columns that are logarithms, of which the jets are the numbers. fractions: columns that stand for a fraction
    between 0 and 1 by the logistic function. All others stand for themselves.
    """
    n, q = theta.shape
    numbers = np.zeros((n, q, 1 + q))
    # Views of these: (n, q) the values, and the derivatives by the same column.
    values, slopes = numbers[..., 0], numbers.reshape(n, -1)[:, 1 :: q + 2]
    values[:], slopes[:] = theta, 1.0
    for i in logs:
        values[:, i] = slopes[:, i] = np.exp(_limited(theta[:, i]))
    for i in fractions:
        share = 1 / (1 + np.exp(_limited(-theta[:, i])))
        values[:, i], slopes[:, i] = share, share * (1 - share)
    return [Jet(numbers[:, i : i + 1]) for i in range(q)]


def _limited(exponents: Float) -> Float:
    return np.asarray(np.minimum(np.maximum(exponents, -30.0), 30.0))


def unit_complex(jet: Jet) -> Jet:
    """exp(i angle): the complex number that rotates the plane by an angle."""
    value = np.exp(1j * jet.numbers[..., :1])
    numbers = 1j * value * jet.numbers
    numbers[..., :1] = value
    return Jet(numbers)


def joined(*jets: Jet) -> Jet:
    """The jets concatenated along k."""
    return Jet(np.concatenate([jet.numbers for jet in jets], axis=1))


def stacked(groups: Sequence[tuple[Jet | None, ...]], counts: Sequence[int]) -> tuple[Float, Float]:
    """(n, k, f) values and (n, k, f, q) derivatives of groups of rows, each of f jets (n, 1 or count); None means 0."""
    first = next(jet for jet in groups[0] if jet is not None).numbers
    numbers = np.zeros((first.shape[0], sum(counts), len(groups[0]), first.shape[2]))
    begin = 0
    for group, count in zip(groups, counts, strict=True):
        for field, jet in enumerate(group):
            if jet is not None:
                numbers[:, begin : begin + count, field] = jet.numbers
        begin += count
    return numbers[..., 0], numbers[..., 1:]
