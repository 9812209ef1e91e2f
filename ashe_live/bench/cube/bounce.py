"""Light that the table sends to a facet of the painted cube, less of it from the cube's shadow; and a facet's to it."""

import math
from collections.abc import Callable, Sequence

import cv2
import numpy as np

from ashe_live.core.arrays import GOLDEN_ANGLE_RAD, Float

Lit = tuple[Float, Float]  # (3,) what a light gives to the open table, and (m, 2) points whose hull its shadow is

PIECES = 12  # of a facet along each edge, as it lights the table
RAYS = 256  # spread over the half-space before a facet by the cosine


def light_from_table(normal: Float, place: Float, sky: Callable[[Float, Float], Float], lights: Sequence[Lit]) -> Float:
    """(3,) irradiance over pi, over the table's reflectance, of a facet at `place` (3,), above the table.

    sky: (n, 3) what the sky gives to the table, at places x (n,) and y (n,). lights: of each light what it gives to the
    open table, and its shadow.
    """
    seen = _places_before(normal, place)
    if not len(seen) or place[2] <= 0:
        return np.zeros(3)
    total = sky(*seen.T).sum(axis=0)
    for level_rgb, shadow in lights:
        total = total + level_rgb * (1 - _are_shaded(seen, shadow)).sum()
    return np.asarray(total / RAYS)


def part_from_facet(corners: Float, x: Float, y: Float) -> Float:
    """(...) of all that a place of the table (x, y) receives, the part that is a facet's with corners (4, 3).

    By adding up its pieces, each as far as its middle.
    """
    across, down = corners[1] - corners[0], corners[3] - corners[0]
    normal = np.cross(down, across)
    area = float(np.linalg.norm(normal))
    normal = normal / area
    middles = (np.arange(PIECES) + 0.5) / PIECES
    received = np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y)))
    for u in middles:
        for v in middles:
            piece = corners[0] + u * across + v * down
            dx, dy = x - piece[0], y - piece[1]
            squared = dx * dx + dy * dy + piece[2] ** 2
            facing = np.maximum(dx * normal[0] + dy * normal[1] - piece[2] * normal[2], 0.0)
            received += facing * max(float(piece[2]), 0.0) / (math.pi * squared**2)
    return np.asarray(np.minimum(received * area / PIECES**2, 0.5))


def _places_before(normal: Float, place: Float) -> Float:
    """(n, 2) where rays from a facet meet the table: each stands for one of RAYS equal parts of all that reaches it."""
    number = np.arange(RAYS) + 0.5
    radius, angle = np.sqrt(number / RAYS), number * GOLDEN_ANGLE_RAD
    aside = np.linalg.svd(normal[None])[2][1:]
    rays = (radius * np.cos(angle))[:, None] * aside[0] + (radius * np.sin(angle))[:, None] * aside[1]
    rays += np.sqrt(1 - radius**2)[:, None] * normal
    down = rays[rays[:, 2] < -1e-3]
    return np.asarray(place[:2] - down[:, :2] * (place[2] / down[:, 2:]))


def _are_shaded(points: Float, shadow: Float) -> Float:
    """(n,) 1 for the points (n, 2) that lie in the hull of a shadow's points (m, 2), 0 for others."""
    hull = cv2.convexHull(np.asarray(shadow, dtype=np.float32))
    inside = [cv2.pointPolygonTest(hull, (float(x), float(y)), False) >= 0 for x, y in points]
    return np.array(inside, dtype=np.float64)
