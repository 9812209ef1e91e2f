"""Open hexagonal lantern with a candle: bars and crossed wires for the shadow."""

import math

import numpy as np
from mesh_grids import lathe, lathe_at, ring, tube
from model_mesh import Model, palette, tint


def lantern(rng):
    """Hexagonal open lantern: stepped foot, six posts with crossed wires, roof, ring, candle."""
    model, iron, brass, wax, flame = Model(), 0, 1, 2, 3
    paint = palette(
        [
            ((28, 44, 46), (58, 84, 84)),
            ((122, 84, 30), (226, 178, 84)),
            ((206, 190, 160), (250, 242, 222)),
            ((232, 128, 24), (255, 226, 130)),
        ],
        rng,
    )
    hexagon = math.pi / 6

    def add(made, column, low, high, crease):
        points, faces = made[:2]
        height = points[:, 1] - points[:, 1].min()
        model.shell(
            points, faces, tint(len(points), column, low + (high - low) * height / max(height.max(), 1e-9)), crease
        )

    add(
        lathe(
            [(0, 0), (0.036, 0), (0.036, 0.004), (0.032, 0.006), (0.032, 0.010), (0.029, 0.012), (0, 0.012)], 6, hexagon
        ),
        iron,
        0.2,
        0.7,
        20,
    )
    add(
        lathe(
            [
                (0, 0.077),
                (0.033, 0.077),
                (0.035, 0.0780),
                (0.035, 0.0805),
                (0.025, 0.0855),
                (0.016, 0.0930),
                (0.010, 0.0985),
                (0.010, 0.1015),
                (0.006, 0.1035),
                (0, 0.1035),
            ],
            6,
            hexagon,
        ),
        iron,
        0.3,
        0.9,
        20,
    )
    for k in range(6):
        here, there = (
            (0.0290 * math.cos(hexagon + (k + d) * math.pi / 3), 0.0290 * math.sin(hexagon + (k + d) * math.pi / 3))
            for d in (0, 1)
        )
        at = lambda p, h: np.array([p[0], h, p[1]])  # noqa: E731
        add(tube([at(here, 0.0115), at(here, 0.0775)], 0.0018, 8), iron, 0.3, 0.6, 50)
        for a, b in (((here, 0.014), (there, 0.075)), ((there, 0.014), (here, 0.075))):
            add(tube([at(*a), at(*b)], 0.0007, 6), brass, 0.4, 0.8, 70)
        for height in (0.0135, 0.0755):
            ends = at(here, height), at(there, height)
            add(
                tube([0.98 * ends[0] + 0.02 * ends[1], 0.02 * ends[0] + 0.98 * ends[1]], 0.0012, 6), brass, 0.3, 0.7, 70
            )
        add(
            lathe_at(
                [(0, -0.0034), (0.0024, -0.0024), (0.0034, 0), (0.0024, 0.0024), (0, 0.0034)], 10, at(here, 0.0095)
            ),
            brass,
            0.4,
            1.0,
            70,
        )
    points, faces = ring(np.array([0, 0.1122, 0]), 0.0085, 0.0013)
    add((points, faces), brass, 0.4, 0.9, 90)
    add(
        lathe(
            [
                (0, 0.0115),
                (0.0100, 0.0115),
                (0.0100, 0.0140),
                (0.0075, 0.0145),
                (0.0075, 0.0330),
                (0.0070, 0.0341),
                (0.0055, 0.0330),
                (0, 0.0323),
            ],
            28,
        ),
        wax,
        0.3,
        1.0,
        45,
    )
    add(lathe([(0, 0.0320), (0.0007, 0.0320), (0.0007, 0.0365), (0, 0.0368)], 8), iron, 0.0, 0.1, 60)
    add(
        lathe([(0, 0.0355), (0.0022, 0.0375), (0.0031, 0.0405), (0.0026, 0.0440), (0.0012, 0.0480), (0, 0.0510)], 14),
        flame,
        0.1,
        1.0,
        70,
    )
    return model, paint, 0.45
