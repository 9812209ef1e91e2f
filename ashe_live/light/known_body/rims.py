"""The table on both sides of shadows' outlines: which lights' shadows show edges in the picture, of all directions.

Coarse, but of many lights at once: it says which of them are worth moving onto edges, and which cast no shadow where it
would be seen.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, upper_median
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.outline.edges import POINTS
from ashe_live.light.known_body.outline.profiles import BY_NONE, BY_STEP, LEAST_STEP, POINTS_A_SAMPLE
from ashe_live.light.known_body.shadows import cells_of
from ashe_live.light.known_body.table import CELLS_A_HEIGHT, SIDE

PLACES = 40  # of an outline, evenly along it
SAMPLES = POINTS / POINTS_A_SAMPLE / PLACES  # independent ones in each
EVERY = 7  # of all places, by which their scatter is told well enough
# From the outline to where it is dark and lit: of the shadow's length, as templates lie apart by a part of it and the
# body hides what is nearer to its own middle; in cells no less than blur takes, and no more than there is room for in
# a long one.
BESIDE_LENGTHS, LEAST_CELLS, MOST_CELLS = 0.4, 0.3, 1.5
# Of the table's light: least scatter of what is no step, and what takes less is no light; and log odds that one place
# may gain or lose, as a stain may lie there.
LEAST_SCATTER, LEAST_DEPTH, MOST_OF_PLACE = 0.02, 0.06, math.log(0.85 / 0.15)
NOWHERE = -1e6  # coordinate of what is not in the picture


class Steps(NamedTuple):
    """What is seen at the outlines of m shadows."""

    in_view: Float  # (m,) part of each outline both sides of which are seen
    log_odds: Float  # (m,) of a shadow by how many places show a step as deep as map and sides want it
    lost: Float32  # (m, PLACES) light from outside to inside
    visible: Mask  # (m, PLACES) where both sides are seen

    @property
    def cautious(self) -> Float:
        """(m,) log odds by steps, of which those for a shadow count half, as other things have edges, too."""
        return np.where(self.log_odds > 0, 0.5 * self.log_odds, self.log_odds)

    def by_depth(self) -> Float:
        """(m,) log odds of steps as deep as those of each outline are on average, over none.

        Nearly all outlines are no shadow's, so that the scatter of all is that of the table.
        """
        some = self.lost[self.visible][::EVERY]
        if not len(some):
            return np.zeros(len(self.lost))
        scatter = max(1.48 * upper_median(np.abs(some)), LEAST_SCATTER)
        lost = self.lost * self.visible
        depth = np.maximum(lost.sum(axis=1) / np.maximum(self.visible.sum(axis=1), 1), LEAST_DEPTH)
        depth = depth.astype(np.float32)[:, None]
        odds = (lost - depth / 2) * (depth / np.float32(scatter**2))
        odds = odds.clip(-MOST_OF_PLACE, MOST_OF_PLACE) * self.visible
        return np.asarray(SAMPLES * odds.sum(axis=1), dtype=np.float64)


class Ground(NamedTuple):
    """A picture of the table in which shadows' outlines are looked for."""

    light: Float32  # (h, w) over the lit table's
    is_table: Mask  # (h, w) pixels that show the bare table away from all that is known
    pixel_from_cell: Float  # (3, 3) as by `table.pixel_from_cell`


@dataclass(frozen=True, slots=True, eq=False)
class Rims:
    """Places at both sides of m shadows' outlines, in the map's cells."""

    inside: Float32  # (m, PLACES, 2) columns and rows; far away where a shadow has no outline
    outside: Float32  # (m, PLACES, 2)
    cells_away: Float  # (m,) from the outline to both
    hidden: Float32  # (m, PLACES) how much more of an even sky the body hides inside than outside

    @staticmethod
    def of(body: Proxy, lights: Float, hidden_sky: Float32) -> "Rims":
        """Of the body's shadows in lights (m, 4); hidden_sky: (n * n,) as in Templates."""
        cells, is_finite = cells_of(body, lights)
        inside, outside = (np.full((len(lights), PLACES, 2), NOWHERE, np.float32) for _ in range(2))
        lengths_cells = CELLS_A_HEIGHT * np.hypot(*lights[:, :2].T) / np.maximum(lights[:, 2], 1e-6)
        away = np.clip(BESIDE_LENGTHS * lengths_cells, LEAST_CELLS, MOST_CELLS)
        evenly = (np.arange(PLACES) + 0.5) / PLACES
        for number in np.flatnonzero(is_finite):
            outline = cv2.convexHull(cells[number].astype(np.float32))[:, 0].astype(np.float64)
            sides = np.roll(outline, -1, axis=0) - outline
            lengths = np.hypot(*sides.T)
            ends = lengths.cumsum()
            if len(outline) < 3 or not lengths.min() > 0:
                continue
            side = np.minimum(np.searchsorted(ends, evenly * ends[-1], side="right"), len(outline) - 1)
            along = sides / lengths[:, None]
            places = outline[side] + (evenly * ends[-1] - ends[side] + lengths[side])[:, None] * along[side]
            across = np.column_stack([along[side, 1], -along[side, 0]])
            across *= np.sign(((places - outline.mean(axis=0)) * across).sum(axis=1))[:, None]
            inside[number], outside[number] = (places + sign * away[number] * across for sign in (-1, 1))
        hidden = hidden_sky.reshape(SIDE, SIDE)
        within, beyond = (cv2.remap(hidden, *_split(each), cv2.INTER_LINEAR) for each in (inside, outside))
        return Rims(inside, outside, away, np.asarray(within - beyond, dtype=np.float32))

    def and_unseen(self, count: int) -> "Rims":
        """These and so many after them of which nothing is seen."""
        unseen = np.full((count, PLACES, 2), NOWHERE, np.float32)
        return Rims(
            np.concatenate([self.inside, unseen]),
            np.concatenate([self.outside, unseen]),
            np.concatenate([self.cells_away, np.full(count, MOST_CELLS)]),
            np.concatenate([self.hidden, np.zeros((count, PLACES), np.float32)]),
        )

    def seen(self, ground: Ground, darkenings: Float, sky: Float, least: float) -> Steps:
        """What is seen of steps at each outline.

        darkenings: (m,) part of the table's light that each light gives, at least `least`. sky: (m,) that of the sky
        beside it, of which the body hides more on the inner side.
        """
        inside, outside = (_in_picture(each, ground.pixel_from_cell) for each in (self.inside, self.outside))
        dark, lit = (cv2.remap(ground.light, x, y, cv2.INTER_LINEAR) for x, y in (inside, outside))
        # Between both lies no other edge that is known, either.
        between = 0.5 * (inside[0] + outside[0]), 0.5 * (inside[1] + outside[1])
        visible = _all_on(ground.is_table, inside, outside, between)
        lost = lit - dark - sky.astype(np.float32)[:, None] * self.hidden
        steps = visible & (lost > LEAST_STEP * np.maximum(darkenings, least)[:, None])
        shown, count = steps.sum(axis=1), visible.sum(axis=1)
        log_odds = np.asarray(SAMPLES * (shown * BY_STEP + (count - shown) * BY_NONE))
        return Steps(count / PLACES, log_odds, lost, visible)

    def hidden_step(self, seen: Mask) -> float:
        """How much more of the sky is hidden inside of the first outline, in the median of where both sides are `seen`.

        seen: (n, n). 0 where none is.
        """
        is_seen = _all_on(seen, _split(self.inside[:1]), _split(self.outside[:1]))
        return float(np.median(self.hidden[:1][is_seen])) if is_seen.any() else 0.0


def _all_on(mask: Mask, *places: tuple[Float32, Float32]) -> Mask:
    """(m, k) whether all of several places with x and y (m, k) lie on a mask (h, w)."""
    on = [cv2.remap(mask.view(np.uint8), x, y, cv2.INTER_NEAREST, borderValue=0) > 0 for x, y in places]
    return np.asarray(np.all(on, axis=0))


def _split(places: Float32) -> tuple[Float32, Float32]:
    """(m, k) columns and rows of places (m, k, 2)."""
    return np.ascontiguousarray(places[..., 0]), np.ascontiguousarray(places[..., 1])


def _in_picture(cells: Float32, pixel_from_cell: Float) -> tuple[Float32, Float32]:
    """(m, k) x and y in the picture of places (m, k, 2) in cells; NOWHERE of what is behind the camera."""
    H = pixel_from_cell.astype(np.float32)
    x, y, depth = (row[0] * cells[..., 0] + row[1] * cells[..., 1] + row[2] for row in H)
    is_before = depth > 0
    depth = np.where(is_before, depth, np.float32(1))
    x, y = (np.where(is_before, each / depth, np.float32(NOWHERE)).clip(NOWHERE, -NOWHERE) for each in (x, y))
    return x, y
