"""How much bare table surrounds a place in the picture, which limits how far an edge may be searched for there."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.light.pixels.view import View, ground_line

BESIDE_PX = 2.5  # of the body, whose rim is neither table nor shadow
LEAST_LEFT = 0.03  # of the table's light, in the deepest shadow
SHORTEST = 1e-9  # of an outline's side: a shorter one is a corner that is given twice


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A convex outline, with what its distances need."""

    along: Float  # (k, 2) unit vectors from each corner to the next
    outwards: Float  # (k, 2) unit normals
    start: Float  # (k, 1) of each side, along it
    level: Float  # (k, 1) of each side, along its normal
    lengths: Float  # (k, 1) of the sides

    @staticmethod
    def of(corners: Float) -> "Outline":
        """Of corners (k, 2) in turn, whichever way around; at least two of them differ."""
        sides = np.concatenate([corners[1:], corners[:1]]) - corners
        lengths = np.hypot(sides[:, 0], sides[:, 1])
        is_side = lengths > SHORTEST
        corners, sides, lengths = corners[is_side], sides[is_side], lengths[is_side, None]
        along = sides / lengths
        from_first = corners - corners[:1]
        area = (from_first[:, 0] * sides[:, 1] - from_first[:, 1] * sides[:, 0]).sum()
        outwards = np.stack([along[:, 1], -along[:, 0]], axis=1) * (1.0 if area > 0 else -1.0)
        start, level = ((corners * axes).sum(axis=1, keepdims=True) for axes in (along, outwards))
        return Outline(along, outwards, start, level, lengths)

    def distances(self, points: Float) -> Float:
        """(n,) of points (n, 2) from it, negative inside."""
        beside = self.outwards @ points.T - self.level
        along = self.along @ points.T - self.start
        beyond = along - np.minimum(np.maximum(along, 0.0), self.lengths)
        away = np.sqrt((beside * beside + beyond * beyond).min(axis=0))
        return np.asarray(np.where(beside.max(axis=0) <= 0, -away, away))


@dataclass(frozen=True, slots=True, eq=False)
class KnownShade:
    """The shadow of a light that is known."""

    outline: Outline
    broad_px: float  # beside the outline, in which the table is not clear
    darkening: float  # part of its light that the table lacks within


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """The part of the picture that shows the bare table, as lines and outlines that bound it."""

    size: tuple[int, int]  # width and height of the picture
    ground_line: Float  # (3,) of a pixel (x, y, 1), positive where the ray meets the table, unit (x, y)
    solid: tuple[Outline, ...]  # in which no table is seen
    shades: tuple[KnownShade, ...] = ()

    @staticmethod
    def of(view: View, body: Proxy) -> "Room":
        """All of the table that is in view beside the body."""
        pixels = project(view.camera, view.T_cam_marker, body.points_marker())
        hull = cv2.convexHull(np.nan_to_num(pixels, nan=-1e4).clip(-1e4, 1e4).astype(np.float32))[:, 0]
        return Room(view.size, ground_line(view.camera, view.T_cam_marker), (Outline.of(hull.astype(np.float64)),))

    def beside_shadow(self, outline_px: Float, broad_px: float, darkening: float) -> "Room":
        """The same without what lies within `broad_px` of a shadow's convex outline (k, 2), which lacks light."""
        return replace(self, shades=(*self.shades, KnownShade(Outline.of(outline_px), broad_px, darkening)))

    def outside(self, hull_px: Float) -> "Room":
        """The same without what lies in a convex outline (k, 2)."""
        return replace(self, solid=(*self.solid, Outline.of(hull_px)))

    def from_border(self, points_px: Float) -> Float:
        """(n,) pixels from points (n, 2) in the picture to its border; negative beyond."""
        x, y = points_px.T
        width, height = self.size
        return np.asarray(np.minimum(np.minimum(x, width - 1 - x), np.minimum(y, height - 1 - y)))

    def around(self, points_px: Float) -> Float:
        """(n,) pixels from points (n, 2) to what is no bare table; negative on it."""
        return self.around_and_left(points_px)[0]

    def around_and_left(self, points_px: Float) -> tuple[Float, Float]:
        """The same, and (n,) what part of the table's light the shadows that are known leave there."""
        least = np.minimum(self.from_border(points_px), points_px @ self.ground_line[:2] + self.ground_line[2])
        left = np.ones(len(points_px))
        for outline in self.solid:
            least = np.minimum(least, outline.distances(points_px) - BESIDE_PX)
        for shade in self.shades:
            away = shade.outline.distances(points_px)
            least = np.minimum(least, np.abs(away) - shade.broad_px)
            left -= shade.darkening * (away < 0)
        return least, np.maximum(left, LEAST_LEFT)
