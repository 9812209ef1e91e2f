"""Meshes of what only the sealed set shows, and of what throws shadows into the picture from outside."""

import math
from typing import Any

import numpy as np

from scenes.geometry.parts import Part, box, ellipsoid, moved, revolved, swept

Params = dict[str, Any]


def hand(p: Params) -> list[Part]:
    """A forearm out of the ground, a palm, a thumb and four fingers, more or less spread."""
    s = p["size_m"]
    parts = [swept([(0, 0, 0), (0, 0, 0.5 * s), (0, 0, 0.9 * s)], [0.2 * s, 0.17 * s, 0.19 * s], flatten=0.75)]
    parts.append(ellipsoid((0.15 * s, 0.34 * s, 0.42 * s), (0, 0, 1.15 * s)))
    for k, length in enumerate((0.62, 0.72, 0.68, 0.5)):
        base = np.array([0, (k - 1.5) * 0.17 * s, 1.42 * s])
        a, bend = (k - 1.5) * p["spread"], p["bend"]
        way = np.array([0, math.sin(a), math.cos(a)])
        mid = base + 0.5 * length * s * way + [0.1 * bend * s, 0, 0]
        parts.append(
            swept([base, mid, mid + length * s * 0.5 * (way + np.array([1.2 * bend, 0, -0.5 * bend]))], 0.075 * s)
        )
    thumb = [(0, -0.25 * s, 1.0 * s), (0.05 * s, -0.5 * s, 1.25 * s), (0.08 * s, -0.56 * s, 1.5 * s)]
    return [*parts, swept(thumb, 0.085 * s)]


def tape_roll(p: Params) -> list[Part]:
    r, w = p["radius_m"], p["width_m"]
    ring = revolved([(0.7 * r, 0), (r, 0), (r, w), (0.7 * r, w), (0.7 * r, 0)])
    if not p["standing"]:
        return [ring]
    return [Part(ring.points[:, [0, 2, 1]] + [0, -w / 2, r], ring.faces[:, ::-1])]


def chair(p: Params) -> list[Part]:
    s, t = p["size_m"], 0.07 * p["size_m"]
    legs = [box((t, t, 0.5 * s), (0.22 * s * sx, 0.22 * s * sy, 0)) for sx in (-1, 1) for sy in (-1, 1)]
    posts = [box((t, t, 0.5 * s), (-0.22 * s, 0.22 * s * sy, 0.5 * s)) for sy in (-1, 1)]
    rails = [box((0.6 * t, 0.44 * s, 1.4 * t), (-0.22 * s, 0, s * h)) for h in (0.66, 0.84)]
    return [*legs, box((0.52 * s, 0.52 * s, 0.05 * s), (0, 0, 0.5 * s), 1), *posts, *rails]


def teapot(p: Params) -> list[Part]:
    r = p["radius_m"]
    h = 1.35 * r
    body = revolved(
        [(0, 0), (0.6 * r, 0), (0.9 * r, 0.3 * h), (r, 0.55 * h), (0.85 * r, 0.85 * h), (0.5 * r, h), (0, h)]
    )
    lid = revolved([(0.5 * r, h), (0.35 * r, 1.1 * h), (0.1 * r, 1.16 * h), (0.14 * r, 1.3 * h), (0, 1.36 * h)], 1)
    spout = swept([(0.8 * r, 0, 0.35 * h), (1.3 * r, 0, 0.6 * h), (1.45 * r, 0, 0.9 * h), (1.7 * r, 0, 1.02 * h)],
                  np.array([0.2, 0.15, 0.11, 0.09]) * r)  # fmt: skip
    s = np.linspace(-1, 1, 13) * math.pi / 2
    handle = np.column_stack([-0.9 * r - 0.6 * r * np.cos(s), 0 * s, h * (0.58 + 0.3 * np.sin(s))])
    return [body, lid, spout, swept(handle, 0.08 * r)]


def pyramid(p: Params) -> list[Part]:
    n, r, h = p["sides"], p["radius_m"], p["height_m"]
    a = np.arange(n) * 2 * math.pi / n
    points = np.vstack([np.column_stack([r * np.cos(a), r * np.sin(a), 0 * a]), (p["lean"] * r, 0, h), (0, 0, 0)])
    k = np.arange(n)
    sides = np.column_stack([k, (k + 1) % n, np.full(n, n)])
    return [Part(points, np.vstack([sides, np.column_stack([(k + 1) % n, k, np.full(n, n + 1)])]), smooth=False)]


def slab(p: Params) -> list[Part]:
    r = p["radius_m"]
    return [box((2 * r, 0.2 * r, 2 * r), (0, 0, -r))]


def foliage(p: Params) -> list[Part]:
    """Leaves of a branch: flat ellipses in a ball."""
    rng, r = np.random.default_rng(p["seed"]), p["radius_m"]
    leaves = []
    for at in rng.normal(0, 0.5 * r, (26, 3)):
        leaf = ellipsoid(r * np.array([0.28, 0.13, 0.02]), (0, 0, 0), turns=10)
        lean = rng.uniform(-0.7, 0.7)
        c, s = math.cos(lean), math.sin(lean)
        tilted = leaf.points @ np.array([(c, 0, s), (0, 1, 0), (-s, 0, c)])
        leaves.append(moved(Part(tilted, leaf.faces), at, float(rng.uniform(0, 360))))
    return leaves


def person(p: Params) -> list[Part]:
    """A head and shoulders, or a hand that holds a telephone."""
    r = p["radius_m"]
    return [
        ellipsoid((0.4 * r, 0.4 * r, 0.5 * r), (0, 0, 0.5 * r)),
        ellipsoid((0.9 * r, 0.6 * r, 0.6 * r), (0, 0, -0.5 * r)),
    ]
