"""How much of the bare table is around a place in the picture: how far an edge may be looked for there."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.light.pixels.view import View, ground_line

BESIDE_PX = 2.5  # of the body, whose rim is neither table nor shadow


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """The part of the picture that shows the bare table, as lines and outlines that bound it."""

    size: tuple[int, int]  # width and height of the picture
    ground_line: Float  # (3,) of a pixel (x, y, 1), positive where the ray meets the table, unit (x, y)
    solid_px: tuple[Float, ...]  # (m, 2) convex outlines, in which no table is seen
    edges_px: tuple[tuple[Float, float], ...] = ()  # (k, 2) outlines beside which none is seen, and how far beside

    @staticmethod
    def of(view: View, body: Proxy) -> "Room":
        """All of the table that is in view beside the body."""
        pixels = project(view.camera, view.T_cam_marker, body.points_marker())
        hull = cv2.convexHull(np.nan_to_num(pixels, nan=-1e4).clip(-1e4, 1e4).astype(np.float32))[:, 0]
        return Room(view.size, ground_line(view.camera, view.T_cam_marker), (hull.astype(np.float64),))

    def without(self, outline_px: Float, broad_px: float) -> "Room":
        """The same without what lies within `broad_px` of an outline (k, 2)."""
        return replace(self, edges_px=(*self.edges_px, (outline_px, broad_px)))

    def outside(self, hull_px: Float) -> "Room":
        """The same without what lies in a convex outline (k, 2)."""
        return replace(self, solid_px=(*self.solid_px, hull_px))

    def around(self, points_px: Float) -> Float:
        """(n,) pixels from points (n, 2) to what is no bare table; negative on it."""
        width, height = self.size
        x, y = points_px.T
        least = np.minimum.reduce([x, y, width - 1 - x, height - 1 - y])
        least = np.minimum(least, points_px @ self.ground_line[:2] + self.ground_line[2])
        for hull_px in self.solid_px:
            beside = _distances(points_px, hull_px)
            beside = np.where(_are_inside(points_px, hull_px), -beside, beside)
            least = np.minimum(least, beside - BESIDE_PX)
        for outline_px, broad_px in self.edges_px:
            least = np.minimum(least, _distances(points_px, outline_px) - broad_px)
        return np.asarray(least)


def _distances(points: Float, outline: Float) -> Float:
    """(n,) of points (n, 2) from the nearest segment of a closed outline (k, 2)."""
    along = np.roll(outline, -1, axis=0) - outline
    offsets = points[:, None] - outline
    lengths = np.maximum((along * along).sum(axis=1), 1e-12)
    part = ((offsets * along).sum(axis=2) / lengths).clip(0.0, 1.0)
    return np.asarray(np.sqrt(((offsets - part[..., None] * along) ** 2).sum(axis=2)).min(axis=1))


def _are_inside(points: Float, hull: Float) -> Mask:
    """(n,) which of points (n, 2) lie in a convex outline (k, 2), whichever way around that is."""
    along = np.roll(hull, -1, axis=0) - hull
    offsets = points[:, None] - hull
    side = along[:, 0] * offsets[..., 1] - along[:, 1] * offsets[..., 0]
    return np.asarray((side >= 0).all(axis=1) | (side <= 0).all(axis=1))
