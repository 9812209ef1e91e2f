"""The table on both sides of shadows' outlines: for every direction of a light, whether its shadow's edges are seen.

This is coarse, but of many lights at once: it says which of them are worth moving onto edges, and which cast no shadow
where one would be seen.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Float32, Mask, upper_median
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.outline.edges import POINTS
from ashe_live.light.known_body.outline.profiles import BY_NONE, BY_STEP, LEAST_STEP, POINTS_A_SAMPLE
from ashe_live.light.known_body.shadows import cells_of
from ashe_live.light.known_body.table import CELLS_A_HEIGHT, SIDE

PLACES = 40  # evenly along each outline
SAMPLES = POINTS / POINTS_A_SAMPLE / PLACES  # effective sample size of a place
EVERY = 7  # every so many of all places are enough to measure their scatter
# How far from the outline it is compared inside and outside: a part of the shadow's length, as neighbouring templates
# differ by a part of that. In cells, no less than blur takes, and no more than the shadow is broad.
BESIDE_LENGTHS, LEAST_CELLS, MOST_CELLS = 0.4, 0.3, 1.5
LEAST_SCATTER = 0.02  # standard deviation of steps where there is no edge, in the table's light, at least
LEAST_DARKENING = 0.06  # part of the table's light: what takes less is no light
MOST_OF_PLACE = math.log(0.85 / 0.15)  # log odds that one place may gain or lose, as a stain may lie there
NOWHERE = -1e6  # coordinate of what is not in the picture


class RimSteps(NamedTuple):
    """What is seen at the outlines of n shadows; only those of the first m are looked at."""

    in_view: Float  # (n,) part of each outline both sides of which are seen
    log_odds: Float  # (n,) of a shadow by how many places show a step as deep as map and sides want it
    lost: Float32  # (m, PLACES) light from outside to inside
    visible: Mask  # (m, PLACES) where both sides are seen

    @property
    def cautious(self) -> Float:
        """(n,) log odds by steps, of which those for a shadow count half, as other things have edges, too."""
        return np.where(self.log_odds > 0, 0.5 * self.log_odds, self.log_odds)

    def by_depth(self) -> Float:
        """(n,) log odds of steps as deep as those of each outline are on average, over none.

        Nearly all outlines are no shadow's, so that the scatter of all is that of the table.
        """
        by_depth = np.zeros(len(self.in_view))
        some = self.lost[self.visible][::EVERY]
        if not len(some):
            return by_depth
        scatter = max(SIGMA_OVER_MAD * upper_median(np.abs(some)), LEAST_SCATTER)
        lost = self.lost * self.visible
        depth = np.maximum(lost.sum(axis=1) / np.maximum(self.visible.sum(axis=1), 1), LEAST_DARKENING)
        depth = depth.astype(np.float32)[:, None]
        odds = (lost - depth / 2) * (depth / np.float32(scatter**2))
        odds = odds.clip(-MOST_OF_PLACE, MOST_OF_PLACE) * self.visible
        by_depth[: len(lost)] = SAMPLES * odds.sum(axis=1)
        return by_depth


class Beside(NamedTuple):
    """A picture at both sides of m shadows' outlines, whatever lights are known."""

    pixels: Float32  # (3, m, PLACES, 2) of Rims.places, and between both
    lost: Float32  # (m, PLACES) light from outside to inside
    hidden: Float32  # (m, PLACES) as in Rims


def steps_in(pictures: Sequence[tuple[Beside, Mask]], darkenings: Float, sky: Float, least: float) -> RimSteps:
    """What is seen at each outline in any of the pictures, as n lights would have it.

    Of n - m lights more than there are outlines nothing is seen.

    pictures: each with the pixels (h, w) of it that show the bare table away from all that is known. darkenings: (n,)
    part of the table's light that each light gives, at least `least`. sky: (n,) that of the sky beside it, of which the
    body hides more on the inner side.
    """
    in_each = np.array([_all_on(is_table, beside.pixels) for beside, is_table in pictures])
    is_visible = np.asarray(in_each.any(axis=0))
    lost_in_each = np.array([beside.lost for beside, _ in pictures]) * in_each
    lost = lost_in_each.sum(axis=0) / np.maximum(in_each.sum(axis=0), 1).astype(np.float32)
    m = len(lost)
    lost = lost - sky[:m, None].astype(np.float32) * pictures[0][0].hidden
    steps = is_visible & (lost > LEAST_STEP * np.maximum(darkenings[:m], least)[:, None])
    shown, count = np.zeros((2, len(darkenings)))
    shown[:m], count[:m] = steps.sum(axis=1), is_visible.sum(axis=1)
    log_odds = np.asarray(SAMPLES * (shown * BY_STEP + (count - shown) * BY_NONE))
    return RimSteps(count / PLACES, log_odds, lost, is_visible)


@dataclass(frozen=True, slots=True, eq=False)
class Rims:
    """Places at both sides of m shadows' outlines, in the map's cells."""

    places: Float32  # (2, m, PLACES, 2) columns and rows inside and outside of it; far away where there is none
    cells_away: Float  # (m,) from the outline to both sides
    hidden: Float32  # (m, PLACES) how much more of an even sky the body hides inside than outside

    @staticmethod
    def of(body: Proxy, lights: Float, hidden_sky: Float32) -> "Rims":
        """Of the body's shadows in lights (m, 4); hidden_sky: (n * n,) as in Templates."""
        cells, is_finite = cells_of(body, lights)
        beside = np.full((2, len(lights), PLACES, 2), NOWHERE, np.float32)
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
            beside[:, number] = [places + sign * away[number] * across for sign in (-1, 1)]
        within, beyond = _read(hidden_sky.reshape(SIDE, SIDE), beside, cv2.INTER_LINEAR)
        return Rims(beside, away, np.asarray(within - beyond, dtype=np.float32))

    def beside(self, light: Float32, pixel_from_cell: Float) -> Beside:
        """The table's light (h, w), over that of the lit one; pixel_from_cell: (3, 3) as by `table.pixel_from_cell`."""
        pixels = _in_picture(self.places, pixel_from_cell)
        inside, outside = _read(light, pixels, cv2.INTER_LINEAR)
        # Between both lies no other edge that is known, either.
        pixels = np.concatenate([pixels, 0.5 * (pixels[:1] + pixels[1:])])
        return Beside(pixels, np.asarray(outside - inside, dtype=np.float32), self.hidden)

    def hidden_step(self, seen: Mask) -> float:
        """How much more of the sky is hidden inside of the first outline, in the median of where both sides are `seen`.

        seen: (n, n). 0 where none is.
        """
        is_seen = _all_on(seen, self.places[:, :1])
        return float(np.median(self.hidden[:1][is_seen])) if is_seen.any() else 0.0


def _all_on(mask: Mask, places: Float32) -> Mask:
    """(m, k) whether all of k triples or pairs of places (j, m, k, 2) lie on a mask (h, w)."""
    return np.asarray((_read(mask.view(np.uint8), places, cv2.INTER_NEAREST) > 0).all(axis=0))


def _read(picture: Float32 | NDArray[np.uint8], places: Float32, interpolation: int) -> NDArray[Any]:
    """(j, m, k) what a picture (h, w) shows at places (j, m, k, 2); 0 outside of it."""
    rows = places.reshape(-1, *places.shape[2:])
    seen = cv2.remap(picture, rows, None, interpolation)  # type: ignore[call-overload]  # cv2's stub wants two maps
    return np.asarray(seen).reshape(places.shape[:3])


def _in_picture(cells: Float32, pixel_from_cell: Float) -> Float32:
    """(..., 2) x and y in the picture of places (..., 2) in cells; NOWHERE of what is behind the camera."""
    flat = cells.reshape(-1, 1, 2)
    pixels = np.asarray(cv2.perspectiveTransform(flat, pixel_from_cell), dtype=np.float32)
    is_behind = flat[:, 0] @ pixel_from_cell[2, :2].astype(np.float32) <= -pixel_from_cell[2, 2]
    pixels[is_behind] = NOWHERE
    return pixels.clip(NOWHERE, -NOWHERE).reshape(cells.shape)
