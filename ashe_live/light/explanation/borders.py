"""Borders of pictures across predicted outlines: where they are, how surely, and how clearly."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.labels.costs import Side

PLACES = 48  # of an outline at which its border is looked for
STEPS = 33  # from as far inside of a place as is looked, to as far outside
BENT_PX = 0.01  # a corner that stands out less than this from an edge lies on it
EXPECTED_SHARE = 0.6  # of the reach: how far off a border is expected to be
PIXELS_PER_SAMPLE = 2.0  # a picture is blurred, and so are its costs: pixels over their effective sample size
LEAST_VARIANCE = 0.35**2
AT_THE_END = 0.2  # weight of a border that may be farther off than it was looked for
CLEAR = 4.0  # cost of taking both sides for the same material at which a border is clear


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Evenly spread over n closed outlines, the same number p on each."""

    points: Float  # (n, p, 2) pixels
    normals: Float  # (n, p, 2) outward
    share: Float  # (n, p) where each is between the ends of its straight edge; those turn from x to y


@dataclass(frozen=True, slots=True, eq=False)
class Borders:
    """What pictures say at p places of each of n outlines."""

    away_px: Float  # (n, p) how far outside of the place its border is
    information: Float  # (n, p) one over the variance of that; 0 where nothing is known
    clarity: Float  # (n, p) 0 where both sides look like the same material, 1 where they surely do not; nan: not known
    in_view: Mask  # (n, p) whether the place lies on ground in the picture, be it hidden by the object


def evenly_spread(hulls_px: Sequence[Float]) -> Places:
    """Places on the outlines of n convex hulls (m, 2)."""
    hulls = [cv2.approxPolyDP(hull.astype(np.float32), BENT_PX, True)[:, 0] for hull in hulls_px]
    most = max(len(hull) for hull in hulls)
    # The last corner stands for those that other hulls have more.
    corners = np.array(
        [np.concatenate([hull, hull[-1:].repeat(most - len(hull), axis=0)]) for hull in hulls], np.float64
    )
    edges = np.concatenate([corners[:, 1:], corners[:, :1]], axis=1) - corners
    lengths = np.hypot(edges[..., 0], edges[..., 1])
    ends = lengths.cumsum(axis=1)
    at = (np.arange(PLACES) + 0.5) / PLACES * ends[:, -1:]
    edge = np.minimum((ends[:, None] <= at[..., None]).sum(axis=2), most - 1)
    row = np.arange(len(hulls))[:, None]
    length = np.maximum(lengths[row, edge], 1e-9)
    share = 1 - (ends[row, edge] - at) / length
    along = edges[row, edge]
    points = corners[row, edge] + share[..., None] * along
    twice_area = (corners[..., 0] * edges[..., 1] - corners[..., 1] * edges[..., 0]).sum(axis=1)
    sense = np.where(twice_area > 0, 1.0, -1.0)[:, None]  # of its corners: from x to y, or back
    normals = along[..., ::-1] * (1, -1) * (sense / length)[..., None]
    return Places(points, normals, np.where(sense > 0, share, 1 - share))


def borders_at(places: Places, sides: Sequence[Side], reach_px: Float) -> Borders:
    """The borders nearer than `reach_px` (n,) to the places of n outlines."""
    steps = reach_px[:, None] * np.linspace(-1, 1, STEPS)
    step_px = steps[:, 1:2] - steps[:, :1]
    lines = places.points[..., None] + steps[:, None, None] * places.normals[..., None]
    x, y = np.moveaxis(lines, 2, 0).astype(np.float32)

    def sampled(pictures: Sequence[NDArray[Any]], interpolation: int) -> NDArray[Any]:
        """(n, p, steps), 0 outside of the picture."""
        return np.array([cv2.remap(one, x[i], y[i], interpolation) for i, one in enumerate(pictures)])

    gain = sampled([np.where(side.trusted, side.gain, np.float32(0)) for side in sides], cv2.INTER_LINEAR)
    # Between any two steps may be the border: what lies within it is inside, the rest outside.
    cost = np.zeros((*gain.shape[:2], STEPS + 1))
    cost[..., 1:] = -gain.cumsum(axis=2) * (step_px / PIXELS_PER_SAMPLE)[..., None]
    ends = np.append(steps, steps[:, -1:] + step_px, axis=1) - step_px / 2
    total = cost + (ends / (EXPECTED_SHARE * reach_px[:, None]))[:, None] ** 2
    best = total.argmin(axis=2)[..., None]
    likely = np.exp(-0.5 * (total - np.take_along_axis(total, best, axis=2)))
    likely /= likely.sum(axis=2, keepdims=True)
    away = (likely @ ends[..., None])[..., 0]
    variance = (likely @ ends[..., None] ** 2)[..., 0] - away**2 + LEAST_VARIANCE

    def holds(masks: Sequence[Mask]) -> Mask:
        """(n, p) both at the place and where its border is."""
        seen = sampled([mask.view(np.uint8) for mask in masks], cv2.INTER_NEAREST)
        there = np.take_along_axis(seen, np.minimum(best, STEPS - 1), axis=2)[..., 0]
        return np.asarray(np.minimum(seen[..., STEPS // 2], there) > 0)

    is_trusted, is_visible = holds([side.trusted for side in sides]), holds([side.visible for side in sides])
    # What seems to end where the picture or the ground does may go on there: the last place before counts for nothing.
    in_view = is_trusted & np.roll(is_trusted, 1, axis=1) & np.roll(is_trusted, -1, axis=1)
    is_known = is_visible & in_view
    is_at_end = np.abs(np.take_along_axis(ends[:, None], best, axis=2)[..., 0]) > reach_px[:, None] - 1
    weight = is_known * np.where(is_at_end, AT_THE_END, 1.0)
    gained = np.minimum(cost[..., 0], cost[..., -1]) - np.take_along_axis(cost, best, axis=2)[..., 0]
    clarity = np.where(is_known, np.clip(gained / CLEAR, 0, 1), np.nan)
    return Borders(away, weight / variance, clarity, in_view)
