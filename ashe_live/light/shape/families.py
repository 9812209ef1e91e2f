"""The families of upright bodies that approximate the real object: convex hulls of spheroids."""

import math

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.shape.family import Family, Parts
from ashe_live.light.shape.jets import Jet, joined, parameters, stacked, unit_complex

# Corners of a box: x and y as multiples of half its sides, z of its height; the lower four first.
CORNER_X = np.array([-1.0, 1.0, 1.0, -1.0] * 2)
CORNER_Y = np.array([-1.0, -1.0, 1.0, 1.0] * 2)
CORNER_Z = np.array([0.0] * 4 + [1.0] * 4)
# The four corners of a box at the +x side of another one.
SIDE_X, SIDE_Y, SIDE_Z = np.ones(4), CORNER_Y[::2], CORNER_Z[::2]
HALF, TWICE, NOTHING = np.array([0.5]), np.array([2.0]), np.zeros(4)
UPWARDS = np.array([1j])  # in the plane of complex numbers


def _frustum(theta: Float) -> Parts:
    """Cylinder, cone, cup."""
    x, y, height, below, above = parameters(theta, logs=[2])
    return stacked([(x, y, None, below, None), (x, y, height, above, None)], [1, 1])


def _vase(theta: Float) -> Parts:
    """A frustum with a third radius between."""
    x, y, height, below, between, above, level = parameters(theta, logs=[2], fractions=[6])
    rings = [(x, y, None, below, None), (x, y, level * height, between, None), (x, y, height, above, None)]
    return stacked(rings, [1, 1, 1])


def _sphere(theta: Float) -> Parts:
    x, y, radius = parameters(theta, logs=[2])
    return stacked([(x, y, radius, radius, radius)], [1])


def _box(theta: Float) -> Parts:
    x, y, yaw, breadth, depth, height = parameters(theta, logs=[3, 4, 5])
    corners = _turned(x, y, yaw, breadth.times(CORNER_X), depth.times(CORNER_Y))
    return stacked([(*corners, height.times(CORNER_Z), None, None)], [8])


def _ell(theta: Float) -> Parts:
    """A box and a lower one of the same depth at one of its sides."""
    x, y, yaw, breadth, depth, height, length, level = parameters(theta, logs=[3, 4, 5, 6], fractions=[7])
    across = joined(breadth.times(CORNER_X), (breadth + length).times(SIDE_X))
    along = depth.times(np.append(CORNER_Y, SIDE_Y))
    levels = joined(height.times(CORNER_Z), (level * height).times(SIDE_Z))
    return stacked([(*_turned(x, y, yaw, across, along), levels, None, None)], [12])


def _wagon(theta: Float) -> Parts:
    """An L raised above the ground, on four feet."""
    free = parameters(theta, logs=[3, 4, 5, 6], fractions=[7, 8, 9])
    x, y, yaw, breadth, depth, height, length, level, clearance, inset = free
    lift, front = clearance * height, breadth + length
    rise = height - lift
    middle, span = (front - breadth).times(HALF), (front + breadth).times(HALF)
    feet = middle + (span * inset).times(CORNER_X[:4])
    across = joined(breadth.times(CORNER_X), front.times(SIDE_X), feet)
    along = depth.times(np.concatenate([CORNER_Y, SIDE_Y, CORNER_Y[:4]]))
    tall, low = rise.times(CORNER_Z) + lift, (level * rise).times(SIDE_Z) + lift
    corners = _turned(x, y, yaw, across, along)
    return stacked([(*corners, joined(tall, low, lift.times(NOTHING)), None, None)], [16])


def _pylon(theta: Float) -> Parts:
    """A cone on a square plate."""
    x, y, yaw, breadth, thickness, height, radius = parameters(theta, logs=[3, 5], fractions=[4])
    plate = _turned(x, y, yaw, breadth.times(CORNER_X), breadth.times(CORNER_Y))
    levels = (thickness * height).times(CORNER_Z)
    return stacked([(*plate, levels, None, None), (x, y, height, radius, None)], [8, 1])


def _mug(theta: Float) -> Parts:
    """A frustum with a handle, which is a spheroid at its side."""
    free = parameters(theta, logs=[2, 8, 9], fractions=[7])
    x, y, height, below, above, dx, dy, level, radius, half = free
    handle = (x + dx, y + dy, level * height, radius, half)
    return stacked([(x, y, None, below, None), (x, y, height, above, None), handle], [1, 1, 1])


def _lump(theta: Float) -> Parts:
    """A spheroid with two balls, each anywhere on it: a head with ears, a toy with arms."""
    x, y, breadth, stretch, *balls = parameters(theta, logs=[2, 3, 7, 11], fractions=[6, 10])
    half = breadth * stretch
    spheroids: list[tuple[Jet | None, ...]] = [(x, y, half, breadth, half)]
    for dx, dy, level, radius in (balls[:4], balls[4:]):
        spheroids.append((x + dx, y + dy, (level * half).times(TWICE), radius, radius))
    return stacked(spheroids, [1, 1, 1])


def _turned(x: Jet, y: Jet, yaw: Jet, across: Jet, along: Jet) -> tuple[Jet, Jet]:
    places = x + y.times(UPWARDS) + unit_complex(yaw) * (across + along.times(UPWARDS))
    return places.real, places.imag


# Starts: from the parameters of a member of the family that each one grows from.


def _upright_starts(seed: Float) -> Float:
    x, y, height, below, above = seed
    return np.array([(x, y, height, below, above), (x, y, height, below, below / 3)])


def _vase_starts(seed: Float) -> Float:
    x, y, height, below, above = seed
    middle = 0.5 * (abs(below) + abs(above))
    return np.array([(x, y, height, below, 1.1 * middle, above, level) for level in (0.7, -0.7)])


def _ball_starts(seed: Float) -> Float:
    x, y, _, below, above = seed
    return np.array([(x, y, math.log(max(abs(below), abs(above), 1e-3)))])


def _box_starts(seed: Float) -> Float:
    x, y, height, below, above = seed
    half = math.log(0.8 * max(abs(below), abs(above), 1e-3))
    return np.array([(x, y, yaw, half, half, height) for yaw in _turns(4, math.pi / 2)])


def _ell_starts(seed: Float) -> Float:
    return np.array([(*_turned_box(seed, turn, 0.5), math.log(0.5), 0.0) for turn in _turns(8, 2 * math.pi)])


def _wagon_starts(seed: Float) -> Float:
    shape = (math.log(0.3), 0.7, -2.0, 1.5)
    return np.array([(*_turned_box(seed, turn, 0.7), *shape) for turn in _turns(4, 2 * math.pi)])


def _pylon_starts(seed: Float) -> Float:
    x, y, height, below, _ = seed
    half = math.log(max(0.8 * abs(below), 1e-3))
    return np.array([(x, y, yaw, half, -3.0, height, 0.2 * abs(below)) for yaw in _turns(2, math.pi / 2)])


def _mug_starts(seed: Float) -> Float:
    r = max(abs(seed[3]), abs(seed[4]), 1e-3)
    handle = (0.0, math.log(0.4 * r), math.log(0.3) + seed[2])
    body = (seed[0], seed[1], seed[2], 0.9 * seed[3], 0.9 * seed[4])
    return np.array([(*body, r * math.cos(a), r * math.sin(a), *handle) for a in _turns(6, 2 * math.pi)])


def _lump_starts(seed: Float) -> Float:
    x, y, size = seed[0], seed[1], seed[2] - 0.15
    reach, ball = 1.1 * math.exp(size), (0.2, size + math.log(0.35))
    sides = [(reach * math.cos(a), reach * math.sin(a)) for a in _turns(4, math.pi)]
    return np.array([(x, y, size, 0.0, dx, dy, *ball, -dx, -dy, *ball) for dx, dy in sides])


def _turns(count: int, whole: float) -> list[float]:
    return [whole * i / count for i in range(count)]


def _turned_box(box: Float, turn: float, kept: float) -> tuple[float, ...]:
    """A box rotated by `turn` and cut to the fraction `kept` of its breadth, to leave room at its +x side."""
    x, y, yaw, breadth, depth, height = box
    # At angles between quarter turns, breadth and depth are interpolated.
    c, s = math.cos(turn) ** 2, math.sin(turn) ** 2
    breadth, depth = c * breadth + s * depth, s * breadth + c * depth
    cut = (1 - kept) * math.exp(min(breadth, 5.0))
    return (
        x - cut * math.cos(yaw + turn),
        y - cut * math.sin(yaw + turn),
        yaw + turn,
        breadth + math.log(kept),
        depth,
        height,
    )


INF = math.inf
FAMILIES = {
    family.name: family
    for family in (
        Family("frustum", None, _frustum, _upright_starts, (INF, INF, 1.0, INF, INF), (2,)),
        Family("box", None, _box, _box_starts, (INF, INF, INF, 1.0, 1.0, 1.0), (5,)),
        Family("sphere", None, _sphere, _ball_starts, (INF, INF, 1.0)),
        Family("vase", "frustum", _vase, _vase_starts, (INF, INF, 1.0, INF, INF, INF, 1.5), (2,)),
        Family("mug", "frustum", _mug, _mug_starts, (INF, INF, 1.0, INF, INF, 1.0, 1.0, 1.0, 0.7, 0.7), (2, 9)),
        Family("pylon", "frustum", _pylon, _pylon_starts, (INF, INF, INF, 1.0, 1.0, 1.0, INF), (5,)),
        Family("wagon", "box", _wagon, _wagon_starts, (INF, INF, INF, 1.0, 1.0, 1.0, 1.0, 1.5, 0.7, 0.7), (5,)),
        Family("ell", "box", _ell, _ell_starts, (INF, INF, INF, 1.0, 1.0, 1.0, 1.0, 1.5), (5,)),
        Family("lump", "sphere", _lump, _lump_starts, (INF, INF, 1.0, 0.5, *(0.7, 0.7, 1.0, 0.5) * 2), (3,)),
    )
}
