"""What the lit sides of a known body send to its table: cells before a side in the sun are brighter than the rest."""

import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.sides.facets import NORMALS, Facets
from ashe_live.light.known_body.sides.shading import PAPER
from ashe_live.light.known_body.table import SIDE, cell_m, places

# Of what falls on a printed face, over what white paper sends back of it: about 0.37 of the cube's faces is ink.
WHITE_SHARE = 0.63
SIDES: Float = NORMALS[NORMALS[:, 2] == 0]
BRIGHTEST = 4.0  # a side's light over the level facet's, as a sun 14 degrees high makes it
LEAST_ANGLE = 1e-6


def form_factors(body: Proxy) -> Float32:
    """(4, n, n) of the table's cells to each of SIDES: the part of what a cell receives from all around that is its.

    By Lambert's formula for a polygon: the angles that its edges subtend at the cell, each times the upward part of the
    normal of the plane through both.
    """
    along, foot = places(body), body.foot_marker
    x, y = (each.ravel() for each in np.meshgrid(along, along))
    points = body.points_marker(4)
    middle = np.stack([x, y, np.zeros_like(x)], axis=1)
    factors = np.zeros((len(SIDES), SIDE * SIDE), np.float32)
    for number, normal in enumerate(SIDES):
        across = np.array((-normal[1], normal[0], 0.0))
        from_foot = points[:, :2] - foot[:2]
        out, wide = float((from_foot @ normal[:2]).max()), from_foot @ across[:2]
        before = np.flatnonzero(middle @ normal > out + 0.25 * cell_m(body))
        ends = [out * normal + side * across for side in (wide.min(), wide.max())]
        up = np.array((0.0, 0.0, body.height_m))
        corners = [ends[0], ends[1], ends[1] + up, ends[0] + up]
        rays = [corner - middle[before] for corner in corners]
        total = np.zeros(len(before))
        for one, other in zip(rays, [*rays[1:], rays[0]], strict=True):
            crossed = np.cross(one, other)
            sine, cosine = np.linalg.norm(crossed, axis=1), (one * other).sum(axis=1)
            total += np.arctan2(sine, cosine) * crossed[:, 2] / np.maximum(sine, LEAST_ANGLE * body.height_m**2)
        factors[number, before] = np.abs(total) / (2 * np.pi)
    return factors.reshape(-1, SIDE, SIDE)


def sent_by_sides(factors: Float32, facets: Facets) -> Float32:
    """(n, n, 3) light that the sides in view send to the cells, over that of level ground in all light, R, G, B.

    Zeros where the level facet is not seen, which all others are compared with.
    """
    is_level = facets.is_level
    sent = np.zeros((SIDE, SIDE, 3), np.float32)
    if not is_level.any():
        return sent
    level = np.maximum(facets.light_rgb[is_level].mean(axis=0), 1e-4)
    for normal, light in zip(facets.normals[~is_level], facets.light_rgb[~is_level], strict=True):
        over_level = np.minimum(light / level, BRIGHTEST)
        sent += factors[int((SIDES @ normal).argmax()), ..., None] * (PAPER * WHITE_SHARE * over_level).astype(
            np.float32
        )
    return sent
