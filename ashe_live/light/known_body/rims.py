"""The table on both sides of shadows' outlines, in the map: which lights' shadows show edges there, of all directions.

Coarse, but of many lights at once: it says which of them are worth moving onto edges, and which cast no shadow where it
would be seen.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.outline.edges import POINTS
from ashe_live.light.known_body.outline.profiles import BY_NONE, BY_STEP, LEAST_STEP, POINTS_A_SAMPLE
from ashe_live.light.known_body.shadows import FIXED, Integers, corners_of
from ashe_live.light.known_body.table import SIDE

PLACES = 40  # of an outline, evenly along it
# Cells from the outline to where it is dark and lit: a template's outline lies up to this far from the shadow's.
BESIDE_CELLS = 1.5
BEYOND = SIDE * SIDE  # number of a cell that is none of the map's


@dataclass(frozen=True, slots=True, eq=False)
class Rims:
    """The cells at both sides of m shadows' outlines."""

    inside: Integers  # (m, PLACES) numbers of cells, row by row; BEYOND for what is not in the map
    outside: Integers  # (m, PLACES)

    @staticmethod
    def of(body: Proxy, lights: Float) -> "Rims":
        """Of the body's shadows in lights (m, 4)."""
        corners, is_finite = corners_of(body, lights)
        inside, outside = (np.full((len(lights), PLACES), BEYOND) for _ in range(2))
        evenly = (np.arange(PLACES) + 0.5) / PLACES
        for number in np.flatnonzero(is_finite):
            outline = cv2.convexHull(corners[number])[:, 0].astype(np.float64) / FIXED
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
            inside[number], outside[number] = (_cells(places + sign * BESIDE_CELLS * across) for sign in (-1, 1))
        return Rims(inside, outside)

    def and_unseen(self, count: int) -> "Rims":
        """These and so many after them of which nothing is seen."""
        unseen = np.full((count, PLACES), BEYOND)
        return Rims(*(np.concatenate([each, unseen]) for each in (self.inside, self.outside)))

    def seen(
        self, values: Float32, seen: Mask, hidden_sky: Float32, darkenings: Float, sky: Float, least: float
    ) -> tuple[Float, Float]:
        """(m,) part of each outline both sides of which are `seen`, and the log odds of a shadow by steps there.

        values: (n, n) relative light. seen: (n, n). hidden_sky: (n * n,) as in Templates. darkenings: (m,) part of the
        table's light that each light gives, at least `least`. sky: (m,) that of the sky beside it, of which the body
        hides more on the inner side.
        """
        light = np.append(np.where(seen, values, np.nan).reshape(-1), np.nan)
        hidden = np.append(hidden_sky, 0.0)
        lost = light[self.outside] - light[self.inside]
        visible = np.isfinite(lost)
        lost -= sky[:, None] * (hidden[self.inside] - hidden[self.outside])
        with np.errstate(invalid="ignore"):
            steps = lost > LEAST_STEP * np.maximum(darkenings, least)[:, None]
        shown, count = steps.sum(axis=1), visible.sum(axis=1)
        samples = POINTS / POINTS_A_SAMPLE / PLACES
        return count / PLACES, np.asarray(samples * (shown * BY_STEP + (count - shown) * BY_NONE))

    def hidden_step(self, hidden_sky: Float32, seen: Mask) -> float:
        """How much more of the sky is hidden inside of an outline, in the median of where both sides are `seen`.

        hidden_sky: (n * n,). seen: (n, n). 0 where none is.
        """
        hidden, is_cell = np.append(hidden_sky, 0.0), np.append(seen.reshape(-1), False)
        is_seen = is_cell[self.inside] & is_cell[self.outside]
        return float(np.median((hidden[self.inside] - hidden[self.outside])[is_seen])) if is_seen.any() else 0.0


def _cells(places: Float) -> Integers:
    """(k,) numbers of the cells in which places (k, 2) lie, in cells from the map's corner."""
    columns, rows = np.floor(places).astype(np.intp).T
    is_in_map = (columns >= 0) & (columns < SIDE) & (rows >= 0) & (rows < SIDE)
    return np.where(is_in_map, rows * SIDE + columns, BEYOND)
