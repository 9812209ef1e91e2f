"""Which directions of a light explain the darkness on the table by the known body's shadow: a matched filter.

For each of some hundred directions the map of the table is regressed on the shadow that the body would cast, beside
what else varies on a table: the light's slow gradients, and the sky that the body itself hides all around its foot
(docs/maths.md, "A known body").
"""

from dataclasses import dataclass
from functools import cache, lru_cache

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.table import SIDE, Table, height_of, places
from ashe_live.light.shape.light_points import at_infinity, cast_on_ground

# Lengths of shadows per unit of height, from lights 82 to 10 degrees high, each longer by a fifth; and how far apart
# the ends of neighbouring shadows are.
LENGTHS = 0.14 * 1.2 ** np.arange(21)
APART, FEWEST_AZIMUTHS, MOST_AZIMUTHS = 0.3, 16, 72
RIDGE = 1e-6
ROUNDED = 12  # bodies are alike to one over so much of their heights, as far as templates go
# Parts of the table's light that may come from the sky, of which the body's surroundings see less.
SKY_SHARES = np.array([0.0, 0.3, 0.6, 0.9], np.float32)
FINER, BITS = 3, 6  # a shadow is painted on so many times finer cells, and with fractions of these
# Cells whose errors are correlated, as stains and prints on a table are wider than a cell: the sample size is divided
# by this.
CELLS_A_SAMPLE = 13.0
LEAST_NOISE = 0.02  # standard deviation of relative light that every map has
LEAST_TOLD = 0.1  # of a shadow's cells, the part that must be left when what else varies is taken out


@dataclass(frozen=True, slots=True, eq=False)
class Templates:
    """The shadows of one body in many lights."""

    lights: Float  # (m, 4) at infinity, unit (x, y, z)
    solid_angle: Float  # (m,) share of the upper hemisphere that each stands for
    shadows: Float32  # (m, n * n) part of each cell that is in shadow
    hidden_sky: Float32  # (n * n,) fraction of an even sky's light that the body keeps from the table


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """How well each of m directions explains a map, under each of SKY_SHARES."""

    log_likelihood: Float  # (m, k) over that of no light at all
    darkening: Float  # (m, k) part of the table's light that the light there would give


def templates_of(body: Proxy) -> Templates:
    """Of all directions; made once for all bodies that are alike but for how they were folded."""
    grain = height_of(body) / ROUNDED
    return _templates(body.family, (np.round(body.spheroids_marker / grain) * grain).tobytes())


def scanned(light: Float32, weight: Float32, shadows: Float32, hidden_sky: Float32, also: Float32) -> Scan:
    """How well `shadows` (m, n * n) explain a map of relative `light` (n, n), with `weight` (n, n) on its cells.

    hidden_sky: as in Templates. also: (k, n * n) what else may be there, as the shadows of lights that are known.
    """
    w = weight.reshape(-1)
    varied = np.concatenate([_slow(), also]).astype(np.float32)
    weighted = varied * w
    normal = (weighted @ varied.T).astype(np.float64)
    normal += RIDGE * np.trace(normal) * np.eye(len(normal))
    # With each share of the sky, what the slow gradients leave.
    values = light.reshape(-1, 1) + hidden_sky[:, None] * SKY_SHARES
    rest = values - varied.T @ np.linalg.solve(normal, weighted @ values).astype(np.float32)
    product = shadows @ np.column_stack([w[:, None] * rest, w, weighted.T])
    along, area, mixed = np.split(product.astype(np.float64), (len(SKY_SHARES), len(SKY_SHARES) + 1), axis=1)
    alone = area - (mixed * np.linalg.solve(normal, mixed.T).T).sum(axis=1, keepdims=True)
    # A shadow that is hardly seen, or that the rest explains as well, tells nothing.
    is_told = alone > LEAST_TOLD * area + 1
    darkening = np.where(is_told, -along / np.maximum(alone, 1e-9), 0.0)
    explained = np.where(darkening > 0, darkening * darkening * alone, 0.0)
    total = (w[:, None] * rest * rest).sum(axis=0) + 1e-9
    left = np.maximum(total - explained, 1e-6 * total) + float(w.sum()) * LEAST_NOISE**2
    none = total.min() + float(w.sum()) * LEAST_NOISE**2
    return Scan(0.5 * float(w.sum()) / CELLS_A_SAMPLE * np.log(none / left), darkening)


@lru_cache(maxsize=4)
def _templates(family: str, spheroids: bytes) -> Templates:
    body = Proxy(family, np.frombuffer(spheroids).reshape(-1, 5))
    displacements = []
    for length in LENGTHS:
        count = int(np.clip(2 * np.pi * length / APART, FEWEST_AZIMUTHS, MOST_AZIMUTHS))
        angles = 2 * np.pi * (np.arange(count) + 0.5) / count
        displacements.append(length * np.column_stack([np.cos(angles), np.sin(angles)]))
    s = np.concatenate(displacements)
    whole = shadows_of(body, at_infinity(np.column_stack([s, np.ones(len(s))])))
    to_light = np.column_stack([s, np.ones(len(s))])
    to_light /= np.linalg.norm(to_light, axis=1, keepdims=True)
    # Each ring of azimuths stands for the sky around its height, whose light falls by the cosine.
    ring = np.repeat(np.arange(len(LENGTHS)), [len(each) for each in displacements])
    counts = np.bincount(ring)[ring]
    heights = np.arctan(1 / LENGTHS)
    between = np.concatenate([[np.pi / 2], 0.5 * (heights[1:] + heights[:-1]), [0.0]])
    solid_angle = (np.sin(between[:-1]) - np.sin(between[1:]))[ring] / counts
    share = (np.sin(between[:-1]) ** 2 - np.sin(between[1:]) ** 2)[ring] / counts
    return Templates(at_infinity(to_light), solid_angle, whole, (share @ whole).astype(np.float32))


def shadows_of(body: Proxy, lights: Float) -> Float32:
    """(m, n * n) part of each cell in the body's shadow, in each of lights (m, 4); none where that is infinite."""
    points = body.points_marker(12)
    foot, cell = body.foot_marker[:2], float(places(body)[1] - places(body)[0])
    shadows = np.zeros((len(lights), SIDE, SIDE), np.float32)
    fine = np.zeros((FINER * SIDE, FINER * SIDE), np.float32)
    for shadow, light in zip(shadows, lights, strict=True):
        cast = cast_on_ground(points, light)
        if cast is not None:
            cells = ((cast[:, :2] - foot) / cell + SIDE // 2 + 0.5) * FINER - 0.5
            hull = cv2.convexHull(cells.clip(-1e3, 1e3).astype(np.float32))[:, 0]
            fine[:] = 0
            cv2.fillConvexPoly(fine, np.round(hull * 2**BITS).astype(np.int32), 1, shift=BITS)
            cv2.resize(fine, (SIDE, SIDE), shadow, interpolation=cv2.INTER_AREA)
    return shadows.reshape(len(lights), -1)


@cache
def _slow() -> Float32:
    """(6, n * n) a quadratic in the places."""
    y, x = (np.mgrid[:SIDE, :SIDE].reshape(2, -1) / (SIDE // 2) - 1).astype(np.float32)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])


def relative_light(table: Table) -> Float32:
    """(n, n, 3) light over the lit table's; cells that are not seen have 1."""
    seen = table.light_rgb[table.seen]
    # Most of the table is lit, and what is not is darker.
    lit = np.maximum(np.percentile(seen, 65, axis=0), 1e-4)
    return np.where(table.seen[..., None], table.light_rgb / lit, 1).astype(np.float32)
