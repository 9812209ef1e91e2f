"""Contours of masks at sub-pixel accuracy, without specks, and where they may be truncated."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.pixels.areas import labelled, window_around

# Blurring a binary mask before its contour is extracted halves the error of pixel steps in a slanted edge.
ANTIALIASING_PX = 0.7
PAD = 3  # around a mask's window, for the blur
CUT_PX = 4  # the blur rounds the corners of a mask that is cut off by the frame or by unreliable pixels
EVERY_OTHER = np.array([1, 0, 1, 0, 1], np.uint8)
BESIDE = np.outer(EVERY_OTHER, EVERY_OTHER)  # kernel of the dilation of unreliable pixels
LEAST_PX = 3  # of the largest component
SPECK_SHARE = 0.03  # fraction of that component's area; smaller ones are no part of the silhouette


@dataclass(frozen=True, slots=True)
class Contour:
    """The contour of a mask, and its convex hull."""

    points_px: Float  # (n, 2) the level set's first and last crossing of each row and column
    hull_px: Float  # (m, 2) corners of their convex hull, in order


def contour_of(mask: Mask) -> Contour | None:
    """The contour of a mask (h, w), blurred, at its level 0.5; None for one of hardly any pixels."""
    if not mask.size:
        return None
    # With one pixel more on every side, as the level set lies between pixels.
    window = window_around(mask, 1)
    labels, sizes = labelled(mask[window], connectivity=8)
    if sizes.max() < LEAST_PX:
        return None
    kept = sizes >= SPECK_SHARE * sizes.max()
    values = kept[labels].astype(np.float32)
    level = cv2.copyMakeBorder(values, PAD, PAD, PAD, PAD, cv2.BORDER_CONSTANT)
    level = cv2.GaussianBlur(level, (0, 0), ANTIALIASING_PX)
    crossings = np.concatenate([_crossings(level), _crossings(level.T)[:, ::-1]])
    if len(crossings) < 3:
        return None
    hull = cv2.convexHull(crossings).reshape(-1, 2)
    corner = np.array([window[1].start - PAD, window[0].start - PAD], dtype=np.float64)
    return Contour(crossings + corner, hull + corner) if len(hull) >= 3 else None


def _crossings(level: NDArray[Any]) -> NDArray[np.float32]:
    """(n, 2) points x, y where the level first and last passes 0.5 in each row."""
    inside = level > 0.5
    y = np.flatnonzero(inside.any(axis=1))
    first = inside[y].argmax(axis=1) - 1
    last = inside.shape[1] - 1 - inside[y, ::-1].argmax(axis=1)
    points = []
    for x in (first, last):
        left, right = level[y, x], level[y, x + 1]
        points.append(np.column_stack([x + (0.5 - left) / (right - left), y]))
    return np.concatenate(points).astype(np.float32)


def truncation_mask(shape: tuple[int, ...], unreliable: Mask | None) -> Mask:
    """(h, w) where an outline may be truncated: at the frame's border, and beside unreliable pixels (h, w)."""
    border = np.ones(shape, np.bool_)
    border[CUT_PX:-CUT_PX, CUT_PX:-CUT_PX] = False
    return border if unreliable is None else border | (cv2.dilate(unreliable.astype(np.uint8), BESIDE) > 0)


def values_at(points: Float, mask: Mask) -> Mask:
    """(m,) the mask's values at points (m, 2); outside of the picture, at its nearest pixel."""
    x, y = np.rint(points).astype(np.intp).T
    return np.asarray(mask[np.clip(y, 0, mask.shape[0] - 1), np.clip(x, 0, mask.shape[1] - 1)])


def are_beside(points: Float, contour: Contour, margin: float) -> Mask:
    """(m,) whether points (m, 2) lie within `margin` pixels of a contour."""
    squared = (contour.points_px**2).sum(axis=1) - 2 * points @ contour.points_px.T
    return np.asarray(squared.min(axis=1) + (points**2).sum(axis=1) <= margin**2)
