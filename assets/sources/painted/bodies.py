"""Convex bodies as intersections of half spaces, and where rays meet them."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from painted.lights import seen_from

Floats = NDArray[np.float64]
Masks = NDArray[np.bool_]
Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Convex:
    """n·x <= d for every face."""

    normals: Floats  # (f, 3) outward
    offsets: Floats  # (f,)
    middle: Floats  # (3,) of a ball that holds it
    reach: float  # that ball's radius
    albedo: Colour = (0.5, 0.5, 0.5)

    def hit(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.intp]]:
        """(n,) the distance to where unit rays enter, inf where they miss or it is behind, and the face there."""
        distance, face = np.full(len(origins), np.inf), np.zeros(len(origins), np.intp)
        away = self.middle - origins
        along = (away * directions).sum(axis=1)
        near = ((away**2).sum(axis=1) - along**2 <= self.reach**2) & (along > -self.reach)
        distance[near], face[near] = self._hit(origins[near], directions[near])
        return distance, face

    def _hit(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.intp]]:
        if not len(origins):
            return np.empty(0), np.empty(0, np.intp)
        speed = directions @ self.normals.T
        gap = self.offsets - origins @ self.normals.T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = gap / speed
        enter = np.where(speed < -1e-12, at, -np.inf)
        leave = np.where(speed > 1e-12, at, np.where((np.abs(speed) <= 1e-12) & (gap < 0), -np.inf, np.inf))
        face = enter.argmax(axis=1)
        first, last = enter.max(axis=1), leave.min(axis=1)
        return np.where((first < last) & (first > 1e-6), first, np.inf), face

    def blocks(self, origins: Floats, directions: Floats) -> Masks:
        return np.isfinite(self.hit(origins, directions)[0])

    def shades(self, points: Floats, sun: Floats) -> Masks:
        """(n,) whether the body is between points (n, 3) and a light (4,)."""
        away = seen_from(points, sun)
        length = np.linalg.norm(away, axis=1)
        at = self.hit(points, away / length[:, None])[0]
        return np.isfinite(at) & (np.where(np.isfinite(at), at, 0) * sun[3] < length)


def box(x: float, y: float, size: tuple[float, float, float], yaw_deg: float, **kwargs: Colour) -> Convex:
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    axes = np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    centre = np.array([x, y, size[2] / 2])
    normals = np.concatenate([axes, -axes])
    half = np.array(size) / 2
    return Convex(normals, normals @ centre + np.tile(half, 2), centre, float(np.linalg.norm(half)), **kwargs)


def frustum(x: float, y: float, below: float, above: float, height: float, sides: int = 64, **kwargs: Colour) -> Convex:
    angles = np.arange(sides) * (2 * math.pi / sides)
    slope = (below - above) / height
    around = np.column_stack([np.cos(angles), np.sin(angles), np.full(sides, slope)]) / math.hypot(1, slope)
    foot = np.array([x, y, 0.0]) + below * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(sides)])
    normals = np.concatenate([around, [(0, 0, 1.0)], [(0, 0, -1.0)]])
    reach = math.hypot(max(below, above), height / 2)
    offsets = np.append((around * foot).sum(axis=1), [height, 0.0])
    return Convex(normals, offsets, np.array([x, y, height / 2]), reach, **kwargs)


def upright(x: float, y: float, radius: float, height: float, **kwargs: Colour) -> Convex:
    return frustum(x, y, radius, radius, height, **kwargs)


def ball(x: float, y: float, radius: float, **kwargs: Colour) -> Convex:
    count = 300
    z = 1 - 2 * (np.arange(count) + 0.5) / count
    turn = np.arange(count) * math.pi * (3 - math.sqrt(5))
    flat = np.sqrt(1 - z**2)
    normals = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])
    centre = np.array([x, y, radius])
    return Convex(normals, normals @ centre + radius, centre, 1.1 * radius, **kwargs)
