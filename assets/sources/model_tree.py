"""Bonsai in a tray: trunk, boughs and faceted pads of leaves."""

import math

import numpy as np
import trimesh
from mesh_grids import lathe, tube
from model_mesh import Model, palette, tint


def tree(rng):
    """Bonsai: glazed tray, earth, a leaning trunk with boughs, faceted pads of leaves."""
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
    points, faces, _ = lathe(
        [(0, 0.0145), (0.0294, 0.0145), (0.0294, 0.0166), (0.022, 0.0184), (0.010, 0.0198), (0, 0.0205)], 40
    )
    model.shell(points, faces, tint(len(points), earth, rng.uniform(0.2, 0.9, len(points))), 60)
    s = np.linspace(0, 1, 22)
    trunk = np.column_stack([-0.004 + 0.016 * np.sin(3.3 * s), 0.017 + 0.070 * s, 0.006 * np.sin(5.5 * s)])
    trunk_radius = 0.0062 * (1 - s) ** 0.8 + 0.0016 + 0.0045 * np.exp(-s / 0.05)
    points, faces = tube(trunk, trunk_radius, 14)
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
        for k in range(3):
            angle = 2 * math.pi * (k / 3 + rng.random())
            shift = (
                np.array([math.cos(angle), 0.22 * rng.uniform(-1, 1), math.sin(angle)]) * size * (0.42 if k else 0.0)
            )
            blob = trimesh.creation.icosphere(subdivisions=1 if k else 2)
            waves = rng.normal(0, 2.2, (5, 3))
            bumps = 1 + 0.07 * np.sin(blob.vertices @ waves.T + rng.uniform(0, 6.3, 5)).sum(1)
            shape = blob.vertices * bumps[:, None] * np.array([1, 0.56, 1]) * size * (1.0 if k == 0 else 0.78)
            up = blob.triangles_center[:, 1]
            tone = 0.48 + 0.32 * up + rng.uniform(-0.10, 0.10, len(up))
            model.shell(shape + end + shift, blob.faces, tint((len(up), 3), leaf, np.repeat(tone[:, None], 3, 1)), 1)
    return model, paint, 0.7
