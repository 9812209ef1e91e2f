"""A marker's square: its corners in the marker frame, its sides in a picture, and where another one lies beside it."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, frozen_floats, read_only_copies, set_frozen
from ashe_live.core.ranges import MARKER_SIDE

PAGE_FOOT_MM = 45  # of a page as it is printed: below the middle part, in whose middle the marker is


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class PlaneMarker:
    """Where another marker lies on the plane z = 0 of the one that is followed, and how large it is there."""

    spec: str
    centre_m: Float  # (2,) x, y; metres, frame of the marker that is followed
    turn_rad: float  # from that marker's x to its own, counter-clockwise seen from above
    side_m: float  # black square's side, by the size of the marker that is followed

    def __post_init__(self) -> None:
        set_frozen(self, centre_m=frozen_floats(self.centre_m, (2,), "centre_m"))
        MARKER_SIDE.checked(self.side_m, "side_m")

    def on_plane(self, points: Float) -> Float:
        """(n, 3) points of its own frame, metres, in the frame of the marker that is followed."""
        cosine, sine = math.cos(self.turn_rad), math.sin(self.turn_rad)
        turned = points @ np.array([(cosine, sine, 0), (-sine, cosine, 0), (0, 0, 1)])
        return np.asarray(turned + np.append(self.centre_m, 0.0))


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


def along_sides(corners_px: Float, places: Float) -> tuple[Float, Float]:
    """(k, n, 2) pixels on the sides of a square, or of any convex polygon (k, 2), and (k, 2) unit normals out of it.

    places: (n,) in fractions of a side, from its corner to the next.
    """
    sides = np.roll(corners_px, -1, axis=0) - corners_px
    lengths = np.maximum(np.linalg.norm(sides, axis=1), 1e-9)
    outwards = np.column_stack([sides[:, 1], -sides[:, 0]]) / lengths[:, None]
    outwards *= np.sign(((corners_px - corners_px.mean(axis=0)) * outwards).sum(axis=1))[:, None]
    return corners_px[:, None] + places[:, None] * sides[:, None], outwards


def mean_side_px(corners_px: Float) -> float:
    """The mean length of the sides of a quadrilateral (4, 2)."""
    # Plain numbers, as four corners are too few for arrays to be fast.
    corners = corners_px.tolist()
    return sum(math.dist(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)) / 4
