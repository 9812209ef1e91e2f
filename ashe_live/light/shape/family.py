"""Families of bodies, and the batching of bodies of several families.

A family maps parameters to spheroids (x, y, z, horizontal radius, half height) and their derivatives. Lengths are in
the units of the body frame (`body.BodyFrame`); those that must stay positive enter as logarithms.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float

FEW_PARTS = 4  # spheroids of a body that is computed beside others of as few

Parts = tuple[Float, Float]  # (n, k, 5) spheroids, (n, k, 5, q) their derivatives


@dataclass(frozen=True, slots=True)
class Family:
    """A parametric family of bodies, and the starts of a search among its members."""

    name: str
    grows_from: str | None  # the family whose best member a search starts from; None: the first guess
    parts: Callable[[Float], Parts]  # spheroids and derivatives for parameters (n, q)
    starts: Callable[[Float], Float]  # starts (n, q) from a member of that family (the first guess is a frustum)
    spread: tuple[float, ...]  # (q,) sigma of the prior on each parameter about its start; inf: none
    # The parameters that are logarithms of heights, and scale all heights together; none where these are fixed.
    heights: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """The number q of parameters."""
        return len(self.spread)


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Bodies that are computed together: all are hulls of points, or all of few spheroids, or all of many."""

    rows: NDArray[np.intp]  # (m,) indices of the bodies
    parts: Float  # (m, k, 5) spheroids; those with fewer are padded with copies of their first
    by_shape: Float  # (m, k, 5, q) derivatives; of those with fewer parameters padded with 0


@dataclass(frozen=True, slots=True, eq=False)
class Members:
    """n members of families."""

    families: Sequence[Family]  # (n,) the family of each
    shapes: Float  # (n, q) its parameters; those of families with fewer are padded

    def batches(self) -> list[Batch]:
        """Their spheroids, in batches.

        Points have simpler formulas than spheroids, and to pad few parts to many costs more than a batch of their own.
        """
        rows_of: dict[str, list[int]] = {}
        for i, family in enumerate(self.families):
            rows_of.setdefault(family.name, []).append(i)
        batches: dict[tuple[bool, bool], list[tuple[list[int], Float, Float]]] = {}
        for rows in rows_of.values():
            family = self.families[rows[0]]
            parts, by_shape = family.parts(self.shapes[rows, : family.size])
            kind = bool(parts[..., 3:].any()), parts.shape[1] > FEW_PARTS
            batches.setdefault(kind, []).append((rows, parts, by_shape))
        return [_joined(several) for several in batches.values()]


def _joined(several: Sequence[tuple[list[int], Float, Float]]) -> Batch:
    """One batch of the members of several families: the indices of each one's, their spheroids and derivatives."""
    rows = np.concatenate([each for each, *_ in several])
    most, size = (max(by_shape.shape[axis] for *_, by_shape in several) for axis in (1, 3))
    stack, slopes = np.empty((len(rows), most, 5)), np.zeros((len(rows), most, 5, size))
    begin = 0
    for each, parts, by_shape in several:
        here, (_, count, _, q) = slice(begin, begin + len(each)), by_shape.shape
        stack[here, :count], stack[here, count:] = parts, parts[:, :1]
        slopes[here, :count, :, :q] = by_shape
        begin += len(each)
    return Batch(rows, stack, slopes)


def padded(rows: Sequence[Float]) -> Float:
    """(n, most) array of n rows of different lengths, padded with zeros at their ends."""
    stack = np.zeros((len(rows), max(len(row) for row in rows)))
    for i, row in enumerate(rows):
        stack[i, : len(row)] = row
    return stack
