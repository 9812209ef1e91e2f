"""What a family of bodies is, and bodies of several families in one stack.

A family turns parameters into spheroids (x, y, z, radius, half height) and their derivatives. Lengths are in units of
the first guess's size, about its place on the ground; those that must stay positive enter as logarithms.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float

Parts = tuple[Float, Float]  # (n, k, 5) spheroids, (n, k, 5, q) their derivatives


@dataclass(frozen=True, slots=True)
class Family:
    """A kind of body, and where a search among its members begins."""

    name: str
    grows_from: str | None  # the family whose member a search starts from; None: the first guess
    parts: Callable[[Float], Parts]  # of parameters (n, q)
    starts: Callable[[Float], Float]  # (n, q) from a member of that family (the first guess is a frustum)
    spread: tuple[float, ...]  # (q,) how far a parameter plausibly lies from its start; inf: anywhere

    @property
    def size(self) -> int:
        """Of the parameters."""
        return len(self.spread)


def parts_of(families: Sequence[Family], shapes: Float) -> Parts:
    """The parts of n bodies, of `families` (n,) with the parameters `shapes` (n, q), in one stack.

    Where a body has fewer than others: its further parts are copies of its first, its further parameters move nothing.
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
    """(n, most) of rows of different lengths, with zeros at their ends."""
    stack = np.zeros((len(rows), max(len(row) for row in rows)))
    for i, row in enumerate(rows):
        stack[i, : len(row)] = row
    return stack
