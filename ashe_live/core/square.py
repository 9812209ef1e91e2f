"""A marker's square: its corners in the marker frame, and the lengths of its sides in a picture."""

import math

import numpy as np

from ashe_live.core.arrays import Float


def square_corners(side_m: float) -> Float:
    """(4, 3) metres, marker frame: a square around the marker's centre.

    Top-left, top-right, bottom-right, bottom-left of the upright print.
    """
    half = side_m / 2
    return np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])


def side_lengths_px(corners_px: Float) -> Float:
    """(4,) lengths of the sides of a quadrilateral (4, 2), each from its corner to the next."""
    sides = corners_px[[1, 2, 3, 0]] - corners_px
    return np.asarray(np.hypot(sides[:, 0], sides[:, 1]))


def mean_side_px(corners_px: Float) -> float:
    """The mean length of the sides of a quadrilateral (4, 2)."""
    # Plain numbers, as four corners are too few for arrays to be fast.
    corners = corners_px.tolist()
    return sum(math.dist(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)) / 4
