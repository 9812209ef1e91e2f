"""The shadows that a known body casts on the cells of its table, in lights of some hundred directions.

They depend on the body's shape alone, in units of its height, so that they are made once for all cubes.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.table import FINER, SIDE, height_of, places
from ashe_live.light.shape.light_points import LOWEST_Z, at_infinity

# Lengths of shadows per unit of height, from lights 82 to 10 degrees high, each longer by a fifth; and how far apart
# the ends of neighbouring shadows are.
LENGTHS = 0.14 * 1.2 ** np.arange(21)
APART, FEWEST_AZIMUTHS, MOST_AZIMUTHS = 0.3, 16, 72
ROUNDED = 6  # bodies are alike to one over so much of their heights, as far as templates go
BITS = 6  # a shadow is painted with fractions of the finer cells
FARTHEST_CELLS = 1e3  # of a shadow's corner: beyond, it is painted as if it were there


@dataclass(frozen=True, slots=True, eq=False)
class Templates:
    """The shadows of one body in many lights."""

    lights: Float  # (m, 4) at infinity, unit (x, y, z)
    solid_angle: Float  # (m,) share of the upper hemisphere that each stands for
    shadows: Float32  # (m, n * n) part of each cell that is in shadow
    filled: Float  # (m,) as by `filled_of`
    hidden_sky: Float32  # (n * n,) fraction of an even sky's light that the body keeps from the table


def templates_of(body: Proxy) -> Templates:
    """Of all directions; made once for all bodies that are alike but for size, place, and how they were folded."""
    spheroids = body.spheroids_marker - np.append(body.foot_marker, (0.0, 0.0))
    rounded = np.round(spheroids * (ROUNDED / height_of(body))) / ROUNDED
    return _templates(body.family, np.unique(rounded + 0.0, axis=0).tobytes())  # without the sign of a zero


@lru_cache(maxsize=4)
def _templates(family: str, spheroids: bytes) -> Templates:
    body = Proxy(family, np.frombuffer(spheroids).reshape(-1, 5))
    displacements = []
    for length in LENGTHS:
        count = int(np.clip(2 * np.pi * length / APART, FEWEST_AZIMUTHS, MOST_AZIMUTHS))
        angles = 2 * np.pi * (np.arange(count) + 0.5) / count
        displacements.append(length * np.column_stack([np.cos(angles), np.sin(angles)]))
    s = np.concatenate(displacements)
    to_light = np.column_stack([s, np.ones(len(s))])
    to_light /= np.linalg.norm(to_light, axis=1, keepdims=True)
    lights = at_infinity(to_light)
    whole = shadows_of(body, lights)
    # Each ring of azimuths stands for the sky around its height, whose light falls by the cosine.
    ring = np.repeat(np.arange(len(LENGTHS)), [len(each) for each in displacements])
    counts = np.bincount(ring)[ring]
    heights = np.arctan(1 / LENGTHS)
    between = np.concatenate([[np.pi / 2], 0.5 * (heights[1:] + heights[:-1]), [0.0]])
    solid_angle = (np.sin(between[:-1]) - np.sin(between[1:]))[ring] / counts
    share = (np.sin(between[:-1]) ** 2 - np.sin(between[1:]) ** 2)[ring] / counts
    return Templates(lights, solid_angle, whole, filled_of(whole), (share @ whole).astype(np.float32))


def shadows_of(body: Proxy, lights: Float) -> Float32:
    """(m, n * n) part of each cell in the body's shadow, in each of lights (m, 4); none where that is infinite."""
    shadows = np.zeros((len(lights), SIDE, SIDE), np.float32)
    fine = np.zeros((FINER * SIDE, FINER * SIDE), np.float32)
    for number, corners in _corners(body, lights):
        fine[:] = 0
        cv2.fillConvexPoly(fine, cv2.convexHull(corners), 1, shift=BITS)
        cv2.resize(fine, (SIDE, SIDE), shadows[number], interpolation=cv2.INTER_AREA)
    return shadows.reshape(len(lights), SIDE * SIDE)


def filled_of(shadows: Float32) -> Float:
    """(m,) sum of squares over the sum, of shadows (m, n * n): 1 where no cell is in shadow only in part."""
    squares = np.einsum("mi,mi->m", shadows, shadows)
    return np.asarray(squares / np.maximum(shadows.sum(axis=1), 1e-6), dtype=np.float64)


def _corners(body: Proxy, lights: Float) -> Iterator[tuple[int, np.ndarray[tuple[int, int], np.dtype[np.int32]]]]:
    """Of each light whose shadow is finite, its number and the (k, 2) cast points in fractions of finer cells."""
    points = body.points_marker(12)
    is_above = lights[:, 2] > LOWEST_Z * np.linalg.norm(lights[:, :3], axis=1)
    by_height = lights[:, [0, 1, 3]] / np.where(is_above, lights[:, 2], 1.0)[:, None]
    left = 1 - by_height[:, 2:] * points[:, 2]
    is_finite = is_above & (left > 0).all(axis=1)
    cast = points[:, :2] - by_height[:, None, :2] * points[:, 2:]
    cast = cast / np.where(is_finite[:, None], left, 1.0)[..., None] - body.foot_marker[:2]
    along = places(body)
    cells = (cast / float(along[1] - along[0])).clip(-FARTHEST_CELLS, FARTHEST_CELLS)
    fixed = np.round(((cells + SIDE // 2 + 0.5) * FINER - 0.5) * 2**BITS).astype(np.int32)
    return ((int(number), fixed[number]) for number in np.flatnonzero(is_finite))
