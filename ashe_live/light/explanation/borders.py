"""Borders in pictures across predicted outlines: their positions, the variances of these, and their clarity."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.edges.outline_points import EXPECTED_SHARE, OutlinePoints
from ashe_live.light.labels.costs import Side

STEPS = 33  # samples of the search along the normal at a point, from inside to outside
# Pixels over their effective sample size: the picture is blurred and costs are smoothed, so neighbours are correlated.
PIXELS_PER_SAMPLE = 2.0
LEAST_VARIANCE = 0.35**2  # px^2, of a border's position, however clear it is
AT_THE_END = 0.2  # weight of a border found at the end of the search range, which may lie beyond it
CLEAR = 4.0  # extra cost of taking both sides for the same material, from which on a border is fully clear


@dataclass(frozen=True, slots=True, eq=False)
class Borders:
    """The borders measured at p points of each of n outlines."""

    offset_px: Float  # (n, p) distance of the border outside of the point, along the normal
    information: Float  # (n, p) one over the variance of that distance; 0 where no border can be observed
    clarity: Float  # (n, p) 0: both sides look like one material, 1: they surely do not; nan: cannot be observed
    in_view: Mask  # (n, p) whether the point lies on ground inside the picture, even if the object hides it


def borders_at(places: OutlinePoints, sides: Sequence[Side], reach_px: Float) -> Borders:
    """The borders within `reach_px` (n,) of the points of n outlines, one `Side` for each outline.

    The posterior of a border's position along the normal follows from the costs of both sides (docs/maths, (17)).
    """
    steps = reach_px[:, None] * np.linspace(-1, 1, STEPS)
    step_px = steps[:, 1:2] - steps[:, :1]
    lines = places.points[..., None] + steps[:, None, None] * places.normals[..., None]
    x, y = np.moveaxis(lines, 2, 0).astype(np.float32)

    gain = _sampled([np.where(side.trusted, side.gain, np.float32(0)) for side in sides], x, y, cv2.INTER_LINEAR)
    # The border may lie between any two samples: those before it are then inside, those after it outside.
    cost = np.zeros((*gain.shape[:2], STEPS + 1))
    cost[..., 1:] = -gain.cumsum(axis=2) * (step_px / PIXELS_PER_SAMPLE)[..., None]
    ends = np.append(steps, steps[:, -1:] + step_px, axis=1) - step_px / 2
    total = cost + (ends / (EXPECTED_SHARE * reach_px[:, None]))[:, None] ** 2
    best = total.argmin(axis=2)[..., None]
    away, variance = _mean_and_variance(total, ends)

    there = np.minimum(best, STEPS - 1)
    x, y = (np.append(each[..., STEPS // 2, None], np.take_along_axis(each, there, axis=2), axis=2) for each in (x, y))
    is_trusted = _all_hold([side.trusted for side in sides], x, y)
    # An outline that seems to end where the picture or the ground does may go on beyond: drop the last point before it.
    in_view = is_trusted & np.roll(is_trusted, 1, axis=1) & np.roll(is_trusted, -1, axis=1)
    is_observable = in_view & _all_hold([side.visible for side in sides], x, y)
    is_at_end = np.abs(np.take_along_axis(ends[:, None], best, axis=2)[..., 0]) > reach_px[:, None] - 1
    weight = is_observable * np.where(is_at_end, AT_THE_END, 1.0)
    gained = np.minimum(cost[..., 0], cost[..., -1]) - np.take_along_axis(cost, best, axis=2)[..., 0]
    clarity = np.where(is_observable, np.clip(gained / CLEAR, 0, 1), np.nan)
    return Borders(away, weight / variance, clarity, in_view)


def _mean_and_variance(costs: Float, places: Float) -> tuple[Float, Float]:
    """(n, p) mean and variance of a border's place by costs (n, p, k), twice negative logs, of k places (n, k)."""
    likely = np.exp(-0.5 * (costs - costs.min(axis=2, keepdims=True)))
    likely /= likely.sum(axis=2, keepdims=True)
    mean = (likely @ places[..., None])[..., 0]
    return mean, (likely @ places[..., None] ** 2)[..., 0] - mean**2 + LEAST_VARIANCE


def _all_hold(masks: Sequence[Mask], x: Float32, y: Float32) -> Mask:
    """(n, p) whether each of n masks holds at all s places (n, p, s) beside a point."""
    return np.asarray(_sampled([mask.view(np.uint8) for mask in masks], x, y, cv2.INTER_NEAREST).all(axis=2))


def _sampled(pictures: Sequence[NDArray[Any]], x: Float32, y: Float32, interpolation: int) -> NDArray[Any]:
    """(n, p, s) values of n pictures at places (n, p, s), 0 outside of the picture."""
    return np.array([cv2.remap(one, x[i], y[i], interpolation) for i, one in enumerate(pictures)])
