"""Families of bodies, and the batching of bodies of several families.

A family maps parameters to spheroids (x, y, z, horizontal radius, half height) and their derivatives. Lengths are in
the units of the body frame (`body.BodyFrame`); those that must stay positive enter as logarithms.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float

Parts = tuple[Float, Float]  # (n, k, 5) spheroids, (n, k, 5, q) their derivatives


@dataclass(frozen=True, slots=True)
class Family:
    """A parametric family of bodies, and the starts of a search among its members."""

    name: str
    grows_from: str | None  # the family whose best member a search starts from; None: the first guess
    parts: Callable[[Float], Parts]  # spheroids and derivatives for parameters (n, q)
    starts: Callable[[Float], Float]  # starts (n, q) from a member of that family (the first guess is a frustum)
    spread: tuple[float, ...]  # (q,) sigma of the prior on each parameter about its start; inf: none

    @property
    def size(self) -> int:
        """The number q of parameters."""
        return len(self.spread)


def parts_of(families: Sequence[Family], shapes: Float) -> Parts:
    """The spheroids (n, k, 5) of n bodies, members of `families` (n,) with parameters `shapes` (n, q), in one batch.

    Bodies with fewer spheroids are padded with copies of their first, and those with fewer parameters with derivatives
    of 0. Returns the derivatives (n, k, 5, q) too.
    """
    members: dict[str, list[int]] = {}
    for i, family in enumerate(families):
        members.setdefault(family.name, []).append(i)
    several = []
    for rows in members.values():
        family = families[rows[0]]
        several.append((rows, *family.parts(shapes[rows, : family.size])))
    most = max(parts.shape[1] for _, parts, _ in several)
    stack, slopes = np.empty((len(shapes), most, 5)), np.zeros((len(shapes), most, 5, shapes.shape[1]))
    for rows, parts, by_shape in several:
        _, count, _, size = by_shape.shape
        stack[rows, :count], stack[rows, count:] = parts, parts[:, :1]
        slopes[rows, :count, :, :size] = by_shape
    return stack, slopes


def padded(rows: Sequence[Float]) -> Float:
    """(n, most) array of n rows of different lengths, padded with zeros at their ends."""
    stack = np.zeros((len(rows), max(len(row) for row in rows)))
    for i, row in enumerate(rows):
        stack[i, : len(row)] = row
    return stack
