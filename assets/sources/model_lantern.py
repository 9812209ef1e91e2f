"""Open hexagonal lantern with a candle: bars and crossed wires for the shadow."""

import math

import numpy as np
from mesh_grids import lathe, lathe_at, ring, tube
from model_mesh import Model, palette, tint

IRON, BRASS, WAX, FLAME = range(4)  # columns of the palette
COLOURS = [  # of each column, dark and light
    ((28, 44, 46), (58, 84, 84)),
    ((122, 84, 30), (226, 178, 84)),
    ((206, 190, 160), (250, 242, 222)),
    ((232, 128, 24), (255, 226, 130)),
]
HEXAGON = math.pi / 6  # turn of the first of six corners
POSTS_M = 0.0290  # radius of the circle on which the posts stand

# Profiles from the axis to the axis: radius and height, metres.
FOOT = [(0, 0), (0.036, 0), (0.036, 0.004), (0.032, 0.006), (0.032, 0.010), (0.029, 0.012), (0, 0.012)]
ROOF = [
    (0, 0.077), (0.033, 0.077), (0.035, 0.0780), (0.035, 0.0805), (0.025, 0.0855), (0.016, 0.0930), (0.010, 0.0985),
    (0.010, 0.1015), (0.006, 0.1035), (0, 0.1035),
]  # fmt: skip
CANDLE = [
    (0, 0.0115), (0.0100, 0.0115), (0.0100, 0.0140), (0.0075, 0.0145), (0.0075, 0.0330), (0.0070, 0.0341),
    (0.0055, 0.0330), (0, 0.0323),
]  # fmt: skip
WICK = [(0, 0.0320), (0.0007, 0.0320), (0.0007, 0.0365), (0, 0.0368)]
LICK = [(0, 0.0355), (0.0022, 0.0375), (0.0031, 0.0405), (0.0026, 0.0440), (0.0012, 0.0480), (0, 0.0510)]
KNOB = [(0, -0.0034), (0.0024, -0.0024), (0.0034, 0), (0.0024, 0.0024), (0, 0.0034)]


def lantern(rng):
    """Hexagonal open lantern: stepped foot, six posts with crossed wires, roof, ring, candle."""
    model, paint = Model(), palette(COLOURS, rng)
    add(model, lathe(FOOT, 6, HEXAGON), IRON, 0.2, 0.7, 20)
    add(model, lathe(ROOF, 6, HEXAGON), IRON, 0.3, 0.9, 20)
    for k in range(6):
        add_side(model, k)
    add(model, ring(np.array([0, 0.1122, 0]), 0.0085, 0.0013), BRASS, 0.4, 0.9, 90)
    add(model, lathe(CANDLE, 28), WAX, 0.3, 1.0, 45)
    add(model, lathe(WICK, 8), IRON, 0.0, 0.1, 60)
    add(model, lathe(LICK, 14), FLAME, 0.1, 1.0, 70)
    return model, paint, 0.45


def add_side(model, k):
    """The post at corner k with its knob, and wires and rails from it to the next corner."""
    add(model, tube([at_corner(k, 0.0115), at_corner(k, 0.0775)], 0.0018, 8), IRON, 0.3, 0.6, 50)
    for one, other in ((k, k + 1), (k + 1, k)):
        add(model, tube([at_corner(one, 0.014), at_corner(other, 0.075)], 0.0007, 6), BRASS, 0.4, 0.8, 70)
    for height in (0.0135, 0.0755):
        here, there = at_corner(k, height), at_corner(k + 1, height)
        add(model, tube([0.98 * here + 0.02 * there, 0.02 * here + 0.98 * there], 0.0012, 6), BRASS, 0.3, 0.7, 70)
    add(model, lathe_at(KNOB, 10, at_corner(k, 0.0095)), BRASS, 0.4, 1.0, 70)


def at_corner(k, height):
    angle = HEXAGON + k * math.pi / 3
    return np.array([POSTS_M * math.cos(angle), height, POSTS_M * math.sin(angle)])


def add(model, made, column, low, high, crease_deg):
    """A part in a palette's column, from its shade `low` at the foot to `high` at the top."""
    points, faces = made[:2]
    height = points[:, 1] - points[:, 1].min()
    shade = low + (high - low) * height / max(height.max(), 1e-9)
    model.shell(points, faces, tint(len(points), column, shade), crease_deg)
