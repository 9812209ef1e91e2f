"""The light that no light of an estimate gives, on a known body's table and around it: how much, and how it leans."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.found_light import FoundLight
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.sides.shading import LOWEST_Z, NOISE, OF_LIGHT, SLOPE, TURN_RAD, direct_light

# Of a facet seen from the side, blur mixes the white with the print: in painted pictures its light is right to 3 % from
# here on, and half of what it is where a facet is five pixels wide.
LEAST_PX = 30.0
LEAST_LIGHT = 0.1  # of level ground's, on a level facet beside lamps that give it less


def open_sky_rgb(seen: Seen, lights: Sequence[FoundLight], dark_rgb: Float) -> Float:
    """(3,) the sky's part of the open table's light, R, G, B: in the shadow, the body hides some of it as well.

    dark_rgb: (l, 3) part of the table's light that each light gives.
    """
    in_shadow = np.clip(1 - dark_rgb.sum(axis=0), 1e-3, 1.0)
    shadows = shadows_of(seen.body, np.array([each.light for each in lights])).whole().max(axis=0)
    cells = (shadows * seen.measured.table.seen).reshape(-1)
    hidden = float((seen.templates.hidden_sky * cells).sum() / max(float(cells.sum()), 1e-6))
    # Where a part h of the sky s is hidden, on both sides of a shadow's edge, s (1 - h) / (1 - s h) is left in it.
    return np.asarray(in_shadow / (1 - hidden * (1 - in_shadow)))


def sky_slope_rgb(seen: Seen, lights: Sequence[FoundLight], dark_rgb: Float, sky_rgb: Float) -> Float:
    """(2, 3) slope of the sky's light along x and y, R, G, B, in units of all light on level ground.

    A facet with the normal n gets sky (1 + n_z) / 2 + n_x slope_x + n_y slope_y: spherical harmonics of the first
    order, whose vertical part an even sky's hemisphere fixes (docs/maths.md, "Ambient"). Zeros where the level facet is
    not seen well, which all others are compared with.

    dark_rgb: (l, 3) part of the table's light that each light gives. sky_rgb: (3,) the sky's.
    """
    facets = seen.measured.facets
    is_told = (facets.width_px >= LEAST_PX) & ~facets.is_clipped
    is_level = facets.normals[:, 2] > 0.99
    level = np.flatnonzero(is_told & is_level)
    if not len(level):
        return np.zeros((2, 3))
    points = np.array([each.light for each in lights])
    to_lights = points[:, :3] / np.linalg.norm(points[:, :3], axis=1, keepdims=True)
    given = direct_light(points, facets.normals, facets.centres)
    # Of white paper in all the light of level ground, of which a lamp gives more, or less, to the level facet.
    on_level = 1 + (given[:, level[0]] - 1) @ dark_rgb
    white = np.maximum(facets.light_rgb[level[0]] / np.maximum(on_level, LEAST_LIGHT), 1e-4)
    across = dark_rgb / np.maximum(to_lights[:, 2:], LOWEST_Z)
    turned_level = _change_by_turn(to_lights, across, np.array((0.0, 0.0, 1.0)))
    information, pull = np.tile(np.eye(2) / SLOPE**2, (3, 1, 1)), np.zeros((3, 2))
    for number in np.flatnonzero(is_told & ~is_level):
        normal, relative = facets.normals[number], facets.light_rgb[number] / white
        direct = given[:, number] @ dark_rgb
        from_table = seen.measured.from_table[number] / white
        left = relative - 0.5 * sky_rgb - direct - from_table
        by_turns = _change_by_turn(to_lights, across, normal) ** 2 + (relative * turned_level) ** 2
        weight = 1 / (NOISE**2 + (OF_LIGHT * direct) ** 2 + TURN_RAD**2 * by_turns)
        information += weight[:, None, None] * np.outer(normal[:2], normal[:2])
        pull += (weight * left)[:, None] * normal[:2]
    slope = np.linalg.solve(information, pull[..., None])[..., 0].T
    return np.asarray(slope.clip(-0.5 * sky_rgb, 0.5 * sky_rgb))


def _change_by_turn(to_lights: Float, across: Float, normal: Float) -> Float:
    """(3,) how fast the direct light on a facet changes as that turns, per radian.

    to_lights: (l, 3). across: (l, 3) light of each on what faces it, R, G, B.
    """
    cosines = to_lights @ normal
    sines = np.where(cosines > 0, np.sqrt(np.maximum(1 - cosines**2, 0.0)), 0.0)
    return np.asarray(np.sqrt(((sines[:, None] * across) ** 2).sum(axis=0)))
