"""Residuals between the outlines of bodies with shadows and the observed ones, and their derivatives, for a batch."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.shape.family import Members
from ashe_live.light.shape.outlines.silhouettes import Outlines
from ashe_live.light.shape.supports import outline_reaches

Indices = NDArray[np.intp]


class Stacked:
    """A dataclass of arrays that share their first axis."""

    __slots__: tuple[str, ...] = ()

    def of(self, rows: Indices | Mask) -> Self:
        """The given rows of every array; a row may be repeated."""
        return type(self)(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(frozen=True, slots=True)
class Observations(Stacked):
    """The observed outlines of n scenes, in pixels counted from their centres."""

    P: Float  # (n, 3, 4) pixels from the bodies' frame
    directions: Float  # (n, 2, d)
    least_px: Float  # (n, 1 + l or 2 + l, d) as in Outlines; without the last row if it bounds nothing in any scene
    most_px: Float
    scale_px: Float  # (n, 1) scale of Cauchy's loss

    @staticmethod
    def stacked(cameras: Sequence[Float], outlines: Sequence[Outlines], scales_px: Sequence[float]) -> "Observations":
        """Stacks outlines with the same number of shadows; missing directions are padded with infinite bounds."""
        n, (rows, _) = len(outlines), outlines[0].least_px.shape
        d = max(len(one.directions) for one in outlines)
        directions = np.zeros((n, 2, d))
        least, most = np.full((n, rows, d), -np.inf), np.full((n, rows, d), np.inf)
        for i, one in enumerate(outlines):
            used = slice(len(one.directions))
            directions[i, :, used] = one.directions.T
            least[i, :, used], most[i, :, used] = one.least_px, one.most_px
        if np.isneginf(least[:, -1]).all():
            least, most = least[:, :-1], most[:, :-1]
        return Observations(np.array(cameras), directions, least, most, np.array(scales_px)[:, None])


def residuals(observations: Observations, members: Members, lights: Float) -> tuple[Float, Float]:
    """(n, r) signed distances in pixels by which outlines of n bodies violate the observed bounds, 0 within them; and
    the derivatives of the outlines' reaches by theta, (n, split + q, r).

    lights: (n, l, 4) in the bodies' frames.
    """
    (n, rows, _), outlines = observations.least_px.shape, 1 + lights.shape[1]
    reach, by_theta = outline_reaches(members, observations.P, lights, observations.directions)
    if rows > outlines:
        is_farthest = reach.argmax(axis=1)[:, None] == np.arange(outlines)[:, None]
        of_farthest = (by_theta * is_farthest[:, None]).sum(axis=2, keepdims=True)
        reach = np.concatenate([reach, reach.max(axis=1, keepdims=True)], axis=1)
        by_theta = np.concatenate([by_theta, of_farthest], axis=2)
    missed = np.minimum(reach - observations.least_px, 0.0) + np.maximum(reach - observations.most_px, 0.0)
    return missed.reshape(n, -1), by_theta.reshape(n, by_theta.shape[1], -1)
