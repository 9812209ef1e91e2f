"""The ground, turned so that lines of one direction are rows: those that both sides of a hole show, drawn across."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.render.cover.inpainting.masked import HOLE_FROM, KNOWN_FROM, reduced

Indices = NDArray[np.intp]

# "Sides" below is the length of a side of the marker.
BESIDE_SIDES = 0.7  # length of a line that is examined on either side of the hole
LEAST_SEEN = 0.5  # share of that length that must be visible
SURE, LIKELY = 6.0, 2.5  # least contrast over its standard error, of a line's strongest row and of rows next to it
CORRELATED_SIDES = 0.12  # correlation length of texture: as much of a line counts as one sample
ALIKE = 0.5  # largest difference between the two sides' means, over the stronger side's contrast
STEADY = 0.6  # largest deviation along a line, beyond the texture's, over its contrast: a line with gaps has more


@dataclass(frozen=True, eq=False)
class GroundDetail:
    """The ground's detail at one resolution."""

    detail: Float32  # (m, m, 3), 0 where none is visible
    hole: Mask  # (m, m) where it is to be made up
    seen: Mask  # (m, m) visible ground
    side: float  # of the marker, pixels

    def reduced(self, m: int) -> "GroundDetail":
        """At a resolution of `m` pixels a side."""
        detail, hole, share = (reduced(each, m) for each in (self.detail, self.hole, self.seen))
        seen = np.asarray(share > KNOWN_FROM)
        side = self.side * m / len(self.hole)
        return GroundDetail(np.where(seen[..., None], detail, np.float32(0)), hole > HOLE_FROM, seen, side)

    def without(self, lines: Float32) -> "GroundDetail":
        return replace(self, detail=np.where(self.seen[..., None], self.detail - lines, 0))

    @cached_property
    def summands(self) -> Float32:
        """(m, m, 5) what is summed along rows in every direction: the detail, its square, and 1 where it is seen."""
        squares = (self.detail**2).sum(axis=2)
        return np.dstack([self.detail, squares, self.seen]).astype(np.float32)


class _Side(NamedTuple):
    """The rows of a turned picture on one side of the hole."""

    mean: Float32  # (k, 3) along each row
    deviation: Float32  # (k,) from it, root mean square
    contrast: Float  # (k,) length of the mean
    pixels: Float32  # (k,) that are visible


class TurnedRows:
    """The ground, turned about its hole so that the lines of one direction are rows: (k, k)."""

    def __init__(self, ground: GroundDetail, direction_deg: float) -> None:
        self._ground, self.direction_deg = ground, direction_deg
        self._reach = max(1, round(BESIDE_SIDES * ground.side))
        left, top, width, height = cv2.boundingRect(ground.hole.astype(np.uint8))
        centre = left + (width - 1) / 2, top + (height - 1) / 2
        self._size = k = int(np.hypot(width, height)) + 2 * self._reach + 2
        turning = np.asarray(cv2.getRotationMatrix2D(centre, direction_deg, 1.0), np.float64)
        turning[:, 2] += (k - 1) / 2 - np.array(centre)
        self._turning: Float = turning  # (2, 3)
        hole = cv2.warpAffine(ground.hole.astype(np.float32), self._turning, (k, k)) > 0.5
        self._crosses = hole.any(axis=1)
        self._first: Indices = np.where(self._crosses, hole.argmax(axis=1), k // 2)  # columns of the hole
        self._last: Indices = np.where(self._crosses, k - 1 - hole[:, ::-1].argmax(axis=1), k // 2)

    @cached_property
    def certainty(self) -> Float:
        """(k,) the weaker side's contrast over its standard error; 0 where the sides do not show one steady line."""
        first, second = self._sides
        apart = np.linalg.norm(first.mean - second.mean, axis=1)
        is_line = self._crosses & (apart < ALIKE * np.maximum(first.contrast, second.contrast))
        found = np.full(self._size, np.inf)
        for side in self._sides:
            is_seen = side.pixels > LEAST_SEEN * self._reach
            ground = side.deviation[is_seen & self._crosses]
            texture = float(np.median(ground)) if ground.size else 0.0
            is_line &= is_seen & (np.square(side.deviation) < np.square(STEADY * side.contrast) + texture**2)
            samples = np.maximum(side.pixels / (CORRELATED_SIDES * self._ground.side), 1.0)
            found = np.minimum(found, side.contrast * np.sqrt(samples) / np.maximum(side.deviation, 1e-4))
        return np.where(is_line, found, 0.0)

    @cached_property
    def _weaker(self) -> Float:
        """(k,) contrast of the weaker side."""
        return np.minimum(self._sides[0].contrast, self._sides[1].contrast)

    @property
    def energy(self) -> float:
        """Squared contrasts of the rows that may be lines, summed: largest if a line fills as few rows as it can."""
        return self.energy_of(np.ones(self._size, np.bool_))

    def energy_of(self, rows: Mask) -> float:
        """As `energy`, of some rows (k,)."""
        return float((self._weaker[rows & (self.certainty > LIKELY)] ** 2).sum())

    @property
    def highest(self) -> float:
        """Contrast of the strongest line. It is largest in that line's own direction, in which it fills fewest rows."""
        return float(self._weaker[self.is_line].max(initial=0.0))

    @property
    def strongest(self) -> Mask:
        """(k,) rows of that line."""
        at = np.arange(self._size) == np.where(self.is_line, self._weaker, 0).argmax()
        return self.lines_at(at)

    def lines_at(self, rows: Mask) -> Mask:
        """(k,) all rows of the lines that some rows (k,) belong to."""
        is_line = self.is_line
        _, parts = cv2.connectedComponents(is_line.astype(np.uint8)[:, None])
        return is_line & np.isin(parts[:, 0], parts[rows & is_line, 0])

    @property
    def is_line(self) -> Mask:
        """(k,) rows of lines: the sure ones, and the likely ones next to them."""
        _, parts = cv2.connectedComponents((self.certainty > LIKELY).astype(np.uint8)[:, None])
        sure = np.unique(parts[self.certainty > SURE])
        return np.asarray(np.isin(parts[:, 0], sure[sure > 0]))

    def those_of(self, others: "TurnedRows", lines: Mask) -> Mask:
        """(k,) the rows that correspond to the rows `lines` of `others`, which are at another resolution."""
        *along, offset = self._turning[1]
        *_, others_offset = others._turning[1]
        # Pixel middles are integers: a picture of m pixels extends from -0.5 to m - 0.5.
        half = 0.5 * float(np.sum(along))
        scale = others._ground.side / self._ground.side
        at = (np.arange(self._size) - offset + half) * scale - half + others_offset
        return np.asarray(lines[np.clip(np.round(at), 0, others._size - 1).astype(int)])

    def drawn(self, is_line: Mask) -> Float32:
        """(m, m, 3) the rows `is_line` (k,), in the hole and as far beside it as they were examined; 0 elsewhere."""
        first, last = self._first[:, None], self._last[:, None]
        column = np.arange(self._size)[None]
        share = np.clip((column - first) / np.maximum(last - first, 1), 0, 1)[..., None]
        profile = (1 - share) * self._sides[0].mean[:, None] + share * self._sides[1].mean[:, None]
        near = (column >= first - self._reach) & (column <= last + self._reach) & is_line[:, None]
        back, size = cv2.invertAffineTransform(self._turning), self._ground.hole.shape[::-1]
        return np.asarray(cv2.warpAffine(np.where(near[..., None], profile, 0), back, size), np.float32)

    @cached_property
    def _sides(self) -> tuple[_Side, _Side]:
        k = self._size
        sums = np.zeros((k, k + 1, 5), np.float32)
        np.cumsum(cv2.warpAffine(self._ground.summands, self._turning, (k, k)), axis=1, out=sums[:, 1:])
        return (
            _side(sums, self._first - self._reach, self._first),
            _side(sums, self._last + 1, self._last + 1 + self._reach),
        )


def _side(sums: Float32, begin: Indices, end: Indices) -> _Side:
    """The columns from `begin` to before `end`, (k,) each, by cumulative sums along the rows (k, k + 1, 5)."""
    rows, k = np.arange(len(sums)), len(sums)
    total = sums[rows, np.clip(end, 0, k)] - sums[rows, np.clip(begin, 0, k)]
    pixels = total[:, 4]
    mean = total[:, :3] / np.maximum(pixels, 1.0)[:, None]
    square = (mean**2).sum(axis=1)
    variance = total[:, 3] / np.maximum(pixels, 1.0) - square
    return _Side(mean, np.sqrt(np.maximum(variance, 0.0)), np.sqrt(square).astype(np.float64), pixels)
