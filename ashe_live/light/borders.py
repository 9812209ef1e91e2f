"""Borders of the picture across predicted outlines: where they are, how surely, and how clearly."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.log_colour import Float32

PLACES = 48  # of an outline at which its border is looked for
STEP_PX = 0.5
BENT_PX = 0.01  # a corner that stands out less than this from an edge lies on it
EXPECTED_SHARE = 0.6  # of the reach: how far off a border is expected to be
CORRELATED_PX = 2.0  # of a picture that tell what one independent pixel would: it is blurred, and so are its costs
LEAST_VARIANCE = 0.35**2
AT_THE_END = 0.2  # weight of a border that may be farther off than it was looked for
CLEAR = 4.0  # cost of taking both sides for the same material at which a border is clear


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Evenly spread over a closed outline."""

    points: Float  # (n, 2) pixels
    normals: Float  # (n, 2) outward
    share: Float  # (n,) where each is between the ends of its straight edge; those turn from x to y


@dataclass(frozen=True, slots=True, eq=False)
class Borders:
    """What the picture says at n places of outlines."""

    away_px: Float  # (n,) how far outside of the place its border is
    information: Float  # (n,) one over the variance of that; 0 where nothing is known
    clarity: Float  # (n,) 0 where both sides look like the same material, 1 where they surely do not; nan: not known

    @staticmethod
    def joined(several: Sequence["Borders"]) -> "Borders":
        return Borders(
            np.concatenate([one.away_px for one in several]),
            np.concatenate([one.information for one in several]),
            np.concatenate([one.clarity for one in several]),
        )


def evenly_spread(hull_px: Float) -> Places:
    """Places on the outline of a convex hull (m, 2)."""
    hull_px = cv2.approxPolyDP(hull_px.astype(np.float32), BENT_PX, True)[:, 0].astype(np.float64)
    edges = np.roll(hull_px, -1, axis=0) - hull_px
    lengths = np.maximum(np.linalg.norm(edges, axis=1), 1e-9)
    marks = np.concatenate([[0.0], np.cumsum(lengths)])
    at = (np.arange(PLACES) + 0.5) / PLACES * marks[-1]
    edge = np.clip(np.searchsorted(marks, at, side="right") - 1, 0, len(hull_px) - 1)
    share = (at - marks[edge]) / lengths[edge]
    points = hull_px[edge] + share[:, None] * edges[edge]
    normals = edges[edge][:, ::-1] * (1, -1) / lengths[edge, None]
    turns_from_x_to_y = float((hull_px[:, 0] * edges[:, 1] - hull_px[:, 1] * edges[:, 0]).sum()) > 0
    return Places(points, normals, share) if turns_from_x_to_y else Places(points, -normals, 1 - share)


def borders_at(places: Places, gain: Float32, trusted: Mask, visible: Mask, reach_px: float) -> Borders:
    """The borders nearer than `reach_px` to the places.

    `gain`: (h, w) how much less a pixel costs inside of the outline than outside. `trusted`: (h, w) where that is
    known. `visible`: (h, w) where a border can be seen.
    """
    steps = np.arange(-reach_px, reach_px + STEP_PX / 2, STEP_PX)
    x, y = (places.points.T[..., None] + steps * places.normals.T[..., None]).astype(np.float32)
    layers = np.dstack([np.where(trusted, gain, 0), trusted, visible]).astype(np.float32)
    seen = cv2.remap(layers, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    # Between any two steps may be the border: what lies within it is inside, the rest outside.
    cost = np.zeros((len(x), len(steps) + 1))
    cost[:, 1:] = -np.cumsum(seen[..., 0], axis=1) * (STEP_PX / CORRELATED_PX)
    ends = np.append(steps, steps[-1] + STEP_PX) - STEP_PX / 2
    total = cost + (ends / (EXPECTED_SHARE * reach_px)) ** 2
    row, best = np.arange(len(x)), total.argmin(axis=1)
    likely = np.exp(-0.5 * (total - total[row, best][:, None]))
    likely /= likely.sum(axis=1, keepdims=True)
    away = likely @ ends
    variance = (likely * (ends - away[:, None]) ** 2).sum(axis=1) + LEAST_VARIANCE
    here, there = seen[:, len(steps) // 2, 1:], seen[row, np.minimum(best, len(steps) - 1), 1:]
    is_trusted, is_visible = (np.minimum(here, there) > 0.5).T
    # What seems to end where the picture or the ground does may go on there: the last place before counts for nothing.
    is_known = is_visible & is_trusted & np.roll(is_trusted, 1) & np.roll(is_trusted, -1)
    weight = is_known * np.where(np.abs(ends[best]) > reach_px - 1, AT_THE_END, 1.0)
    clarity = np.clip((np.minimum(cost[:, 0], cost[:, -1]) - cost[row, best]) / CLEAR, 0, 1)
    return Borders(away, weight / variance, np.where(is_known, clarity, np.nan))
