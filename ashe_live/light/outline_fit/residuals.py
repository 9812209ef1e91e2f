"""By how much bodies and their shadows miss outlines, and how that changes with their parameters: a stack at a time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.shape.family import Family, parts_of
from ashe_live.light.shape.silhouettes import Outlines
from ashe_live.light.shape.supports import outline_supports

Indices = NDArray[np.intp]


class Stacked:
    """A dataclass of arrays that go along in their first axis."""

    __slots__: tuple[str, ...] = ()

    def of(self, rows: Indices | Mask) -> Self:
        """Some of them, or one several times."""
        return type(self)(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(frozen=True, slots=True)
class Observations(Stacked):
    """What n bodies have to explain: outlines, as seen by a camera about their centre."""

    P: Float  # (n, 3, 4) pixels from the bodies' frame
    directions: Float  # (n, 2, d)
    least_px: Float  # (n, 1 + l or 2 + l, d) as in Outlines; without the last row where that bounds nothing
    most_px: Float
    scale_px: Float  # (n, 1) errors beyond it count less and less

    @staticmethod
    def stacked(cameras: Sequence[Float], outlines: Sequence[Outlines], scales_px: Sequence[float]) -> "Observations":
        """Of outlines of equally many shadows; where one has fewer directions than others, nothing bounds the rest."""
        n, (rows, _) = len(outlines), outlines[0].least_px.shape
        d = max(len(one.directions) for one in outlines)
        directions = np.zeros((n, 2, d))
        least, most = np.full((n, rows, d), -np.inf), np.full((n, rows, d), np.inf)
        for i, one in enumerate(outlines):
            own = slice(len(one.directions))
            directions[i, :, own] = one.directions.T
            least[i, :, own], most[i, :, own] = one.least_px, one.most_px
        if np.isneginf(least[:, -1]).all():
            least, most = least[:, :-1], most[:, :-1]
        return Observations(np.array(cameras), directions, least, most, np.array(scales_px)[:, None])


def residuals(
    observations: Observations, families: Sequence[Family], lights: Float, shapes: Float
) -> tuple[Float, Float]:
    """(n, r) pixels by which n bodies miss outlines, and how theta moves what they miss, (n, split + q, r).

    lights: (n, l, 4) in the bodies' frames. shapes: (n, q), of the members of `families` (n,).
    """
    (n, rows, _), outlines = observations.least_px.shape, 1 + lights.shape[1]
    parts, by_shape = parts_of(families, shapes)
    supports = outline_supports(observations.P, parts, lights, observations.directions)
    reach, by_theta = supports.reach_px, supports.by_theta(by_shape)
    if rows > outlines:
        is_farthest = reach.argmax(axis=1)[:, None] == np.arange(outlines)[:, None]
        of_farthest = (by_theta * is_farthest[:, None]).sum(axis=2, keepdims=True)
        reach = np.concatenate([reach, reach.max(axis=1, keepdims=True)], axis=1)
        by_theta = np.concatenate([by_theta, of_farthest], axis=2)
    missed = np.minimum(reach - observations.least_px, 0.0) + np.maximum(reach - observations.most_px, 0.0)
    return missed.reshape(n, -1), by_theta.reshape(n, by_theta.shape[1], -1)
