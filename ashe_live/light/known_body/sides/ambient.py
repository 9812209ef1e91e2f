"""The light that no light of an estimate gives, on a known body's table and around it: how much, and how it leans."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.found_light import FoundLight, points_of
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.sides.shading import SLOPE, UNEVEN, Sides

LEAST_GIVEN = 1e-3  # part of the table's light, by all lights together


def open_sky_rgb(seen: Seen, lights: Sequence[FoundLight], dark_rgb: Float) -> Float:
    """(3,) the sky's part of the open table's light, R, G, B: in the shadow, the body hides some of it as well.

    dark_rgb: (l, 3) part of the table's light that each light gives.
    """
    in_shadow = np.clip(1 - dark_rgb.sum(axis=0), 1e-3, 1.0)
    shadows = shadows_of(seen.body, points_of(lights)).whole().max(axis=0)
    cells = (shadows * seen.measured.table.seen).reshape(-1)
    hidden = float((seen.templates.hidden_sky * cells).sum() / max(float(cells.sum()), 1e-6))
    # Where a part h of the sky s is hidden, on both sides of a shadow's edge, s (1 - h) / (1 - s h) is left in it.
    return np.asarray(in_shadow / (1 - hidden * (1 - in_shadow)))


def sky_slope_rgb(seen: Seen, lights: Sequence[FoundLight], dark_rgb: Float, sky_rgb: Float) -> Float:
    """(2, 3) slope of the sky's light along x and y, R, G, B, in units of all light on level ground.

    A facet with the normal n gets sky (1 + n_z) / 2 + n_x slope_x + n_y slope_y: spherical harmonics of the first
    order, whose vertical part an even sky's hemisphere fixes (docs/maths, "Ambient"). Zeros where the level facet's
    light, which all others are compared with, is unknown.

    dark_rgb: (l, 3) part of the table's light that each light gives. sky_rgb: (3,) the sky's.
    """
    points = np.array([each.light for each in lights])
    points /= np.linalg.norm(points[:, :3], axis=1, keepdims=True)
    given = dark_rgb * (1 - sky_rgb) / np.maximum(dark_rgb.sum(axis=0), LEAST_GIVEN)
    slope = np.zeros((2, 3))
    for channel, (by_lights, sky) in enumerate(zip(given.T, sky_rgb.tolist(), strict=True)):
        sides = Sides.of(seen.measured.facets, seen.measured.from_table, np.eye(3)[channel])
        reached = sides.reached(points)
        left = sides.residual - by_lights @ reached
        variance = sides.noise**2 + by_lights**2 @ sides.spread(points, reached) + (UNEVEN * sky) ** 2
        # Of a clipped side only a bound is known; what the level facet's own light leaves open, all sides share.
        is_measured = ~sides.is_clipped
        across, shared = sides.normals[is_measured, :2], sides.by_level[is_measured]
        weighted = np.linalg.solve(np.diag(variance[is_measured]) + np.outer(shared, shared), across)
        information = across.T @ weighted + np.eye(2) / (SLOPE * sky) ** 2
        slope[:, channel] = np.linalg.solve(information, weighted.T @ left[is_measured])
    return slope.clip(-0.5 * sky_rgb, 0.5 * sky_rgb)
