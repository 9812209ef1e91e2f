"""Points and triangles of what is swept: bodies of revolution, tubes, rings (NumPy alone, y up)."""

import math

import numpy as np


def grid_faces(rows, columns):
    """Triangles of a grid of (rows + 1) x (columns + 1) points."""
    i, k = np.mgrid[:rows, :columns].reshape(2, -1)
    a, b = i * (columns + 1) + k, (i + 1) * (columns + 1) + k
    return np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)])


def lathe(profile, turns, start=0.0):
    """Points, faces and unrolled uv of a closed body of revolution; the profile begins and ends on the axis."""
    profile = np.asarray(profile, float)
    angle = start + np.linspace(0, 2 * math.pi, turns + 1)
    angle[-1] = start  # exactly closed
    r, h = profile[:, :1], profile[:, 1:]
    points = np.stack([r * np.cos(angle), h + 0 * angle, r * np.sin(angle)], -1).reshape(-1, 3)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    u, v = np.meshgrid(np.linspace(0, 1, turns + 1), length / length[-1])
    return points, grid_faces(len(profile) - 1, turns), np.stack([u, v], -1).reshape(-1, 2)


def tube(path, radius, sides, flatten=1.0, turn=0.0):
    """A capped tube along a path; `radius` one each point or one for all."""
    path = np.asarray(path, float)
    radius = np.broadcast_to(radius, len(path))
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along[0], [0.0, 0.0, 1.0] if abs(along[0, 2]) < 0.9 else [1.0, 0.0, 0.0])
    angle = turn + np.linspace(0, 2 * math.pi, sides + 1)
    angle[-1] = turn
    rings = [np.repeat(path[:1], sides + 1, 0)]
    for at, direction, r in zip(path, along, radius, strict=True):
        side = side - direction * (side @ direction)
        side /= np.linalg.norm(side)
        other = np.cross(direction, side)
        rings.append(at + r * (np.outer(np.cos(angle), side) + flatten * np.outer(np.sin(angle), other)))
    rings.append(np.repeat(path[-1:], sides + 1, 0))
    return np.concatenate(rings), grid_faces(len(rings) - 1, sides)


def ring(centre, big, small, turns=32, sides=10):
    """An upright torus."""
    a = np.linspace(0, 2 * math.pi, turns + 1)[:, None]
    b = np.linspace(0, 2 * math.pi, sides + 1)[None]
    a[-1], b[0, -1] = 0, 0
    r = big + small * np.cos(b)
    points = np.stack([r * np.cos(a), r * np.sin(a), small * np.sin(b) + 0 * a], -1).reshape(-1, 3)
    return points + centre, grid_faces(turns, sides)


def lathe_at(profile, turns, centre):
    points, faces, uv = lathe(profile, turns)
    return points + centre, faces, uv
