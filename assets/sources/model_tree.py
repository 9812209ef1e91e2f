"""Bonsai in a tray: trunk, boughs and pads of single leaves."""

import math

import numpy as np
from mesh_grids import lathe, tube
from model_mesh import Model, palette, tint

LEAVES = 360  # of the largest pad
LEAF_M = 0.0062
FLATNESS = 0.56  # of a pad: its height over its width


def tree(rng):
    """Bonsai: glazed tray, earth, a leaning trunk with boughs, pads of leaves."""
    model, glaze, earth, bark, leaf = Model(), 0, 1, 2, 3
    paint = palette(
        [
            ((96, 34, 22), (178, 74, 48)),
            ((52, 38, 26), (92, 70, 46)),
            ((62, 42, 28), (138, 100, 66)),
            ((30, 62, 26), (120, 164, 64)),
        ],
        rng,
    )
    points, faces, _ = lathe(
        [
            (0, 0),
            (0.024, 0),
            (0.0255, 0.002),
            (0.031, 0.015),
            (0.0335, 0.0155),
            (0.0335, 0.0185),
            (0.0300, 0.0185),
            (0.0290, 0.0150),
            (0, 0.0150),
        ],
        40,
    )
    model.shell(points, faces, tint(len(points), glaze, 0.25 + 0.7 * points[:, 1] / 0.0185), 35)
    points, faces, tone = earth_in_tray(rng)
    model.shell(points, faces, tint(len(points), earth, tone), 60)
    s = np.linspace(0, 1, 22)
    trunk = np.column_stack([-0.004 + 0.016 * np.sin(3.3 * s), 0.017 + 0.070 * s, 0.006 * np.sin(5.5 * s)])
    trunk_radius = 0.0062 * (1 - s) ** 0.8 + 0.0016 + 0.0045 * np.exp(-s / 0.05)
    # Upright at its foot, whose end would show above the earth if it leaned.
    foot = trunk[0] - np.outer([0.007, 0.0035], [0.0, 1.0, 0.0])
    points, faces = tube(np.vstack([foot, trunk]), np.concatenate([trunk_radius[[0, 0]], trunk_radius]), 14)
    model.shell(points, faces, tint(len(points), bark, 0.35 + 0.3 * np.sin(np.arange(len(points)) * 2.1)), 70)
    pads = [
        (1.00, (0.000, 0.0915, 0.002), 0.0190),
        (0.40, (0.0330, 0.0560, 0.004), 0.0150),
        (0.55, (-0.0300, 0.0660, -0.004), 0.0165),
        (0.72, (0.0180, 0.0780, -0.014), 0.0150),
        (0.66, (-0.0080, 0.0730, 0.021), 0.0140),
        (0.48, (0.006, 0.0600, -0.0255), 0.0125),
    ]
    for fraction, centre, size in pads:
        start, end = trunk[int(fraction * 21)], np.array(centre)
        if fraction < 1:
            q = np.linspace(0, 1, 9)[:, None]
            bough = start + (end - start) * q + [0, -0.004, 0] * np.sin(math.pi * q)
            points, faces = tube(bough, np.linspace(0.0027, 0.0012, 9), 8)
            model.shell(points, faces, tint(len(points), bark, 0.4), 70)
        for _ in range(round(LEAVES * (size / 0.019) ** 2)):
            outward = rng.normal(0, 1, 3)
            outward /= np.linalg.norm(outward)
            depth = rng.uniform(0.55, 1.0)
            at = end + size * depth * outward * (1.0, FLATNESS, 1.0)
            tone = 0.25 + 0.45 * depth * (0.5 + 0.5 * outward[1]) + rng.uniform(0.0, 0.25)
            points, faces = blade(at, outward, LEAF_M * rng.uniform(0.8, 1.25), rng)
            model.shell(points, faces, tint(len(points), leaf, tone), 100)
    return model, paint, 0.7


def earth_in_tray(rng):
    """Points and faces of a mound of crumbs, as fine in both directions, and the points' tones."""
    reach = np.linspace(0.0294, 0.0, 22)
    mound = [(r, 0.0205 - 0.0039 * (r / 0.0294) ** 2) for r in reach]
    points, faces, _ = lathe([(0, 0.0145), (0.0294, 0.0145), *mound], 88)
    keys, where = np.unique(np.round(points * 1e7), axis=0, return_inverse=True)
    # Where rows end in one point and where they meet, points are the same, and so must be what is drawn for them.
    where = where.ravel()
    away, tone = rng.normal(0, 0.0005, (len(keys), 3)), rng.uniform(0.2, 0.9, len(keys))
    inside = (points[:, 1] > 0.0167) & (np.hypot(points[:, 0], points[:, 2]) > 1e-6)
    return points + away[where] * inside[:, None], faces, tone[where]


def blade(at, outward, length, rng):
    """A leaf as a thin closed shell: six points, rounded by its normals, hanging a little, facing about `outward`."""
    facing = outward * (0.7, 1.0, 0.7) + rng.normal(0, 0.35, 3) + (0, 0.45, 0)
    facing /= np.linalg.norm(facing)
    along = rng.normal(0, 1, 3) + 1.2 * outward
    along -= facing * (along @ facing)
    along /= np.linalg.norm(along)
    across = np.cross(facing, along)
    outline = np.array([(0, 0), (0.42, 0.28), (1, 0), (0.42, -0.28)])  # along and across, in lengths
    arch = np.array([0.0, 0.05, -0.12, 0.05])
    rim = at + length * (outline[:, :1] * along + outline[:, 1:] * across + arch[:, None] * facing)
    middle = at + length * 0.45 * along
    points = np.vstack([rim, middle + 0.10 * length * facing, middle + 0.04 * length * facing])
    around = [(k, (k + 1) % 4) for k in range(4)]
    return points, np.array([(b, a, 4) for a, b in around] + [(a, b, 5) for a, b in around])
