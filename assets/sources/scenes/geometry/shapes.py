"""Meshes of every family of objects, from named parameters, standing on z = 0 (NumPy alone; metres, z up)."""

import math
from typing import Any

import numpy as np
from mesh_grids import grid_faces

from scenes.geometry import rare_shapes
from scenes.geometry.paper_cube import paper_cube
from scenes.geometry.parts import Floats, Part, box, cylinder, ellipsoid, moved, revolved, swept, turned_z, vessel

Params = dict[str, Any]


def cup(p: Params) -> list[Part]:
    b, a, h = p["below_m"], p["above_m"], p["height_m"]
    parts = [revolved(vessel(b, a, h, 0.0012))]
    if p["lid"]:
        e = 0.10 * a
        lid = [(0, h), (a + e / 2, h), (a + e, h + e), (a + e * 0.6, h + 2.4 * e), (a * 0.86, h + 2.6 * e),
               (a * 0.82, h + 4.2 * e), (a * 0.76, h + 4.4 * e), (a * 0.72, h + 3.4 * e), (0, h + 3.3 * e)]  # fmt: skip
        parts.append(revolved(lid, 1))
        parts.append(moved(ellipsoid((0.14 * a, 0.06 * a, 0.0006), (0, 0.55 * a, h + 3.4 * e), 2, 16), (0, 0, 0)))
    if p["sleeve"]:
        low, high = 0.28, 0.72
        r = [b + (a - b) * f + 0.0008 for f in (low, high)]
        parts.append(revolved([(r[0], low * h), (r[1], high * h)], 1))
    return parts


def tumbler(p: Params) -> list[Part]:
    return [revolved(vessel(p["below_m"], p["above_m"], p["height_m"], p["wall_m"], p.get("bulge_m", 0.0)))]


def mug(p: Params) -> list[Part]:
    r, h = p["above_m"], p["height_m"]
    s = np.linspace(-1, 1, 17) * math.pi / 2
    reach = p["handle"] * h
    path = np.column_stack([r * 0.96 + reach * np.cos(s) ** 0.7, 0 * s, h * (0.5 + 0.33 * np.sin(s))])
    return [*tumbler(p), swept(path, 0.055 * h, sides=10, flatten=1.4)]


def bottle(p: Params) -> list[Part]:
    r, h, n = p["above_m"], p["height_m"], p["neck"]
    t = np.linspace(0, 1, 12)
    shoulder = [(float(r + (n * r - r) * (3 * u * u - 2 * u**3)), float(h * (p["body"] + 0.2 * u))) for u in t]
    top = [(n * r, 0.93 * h), (n * r, h), (0, h)]
    body = revolved([(0, 0.004), (0.85 * r, 0), (0.97 * r, 0.004), (r, 0.012), (r, p["body"] * h), *shoulder, *top])
    cap = revolved([(1.25 * n * r, 0.92 * h), (1.25 * n * r, 1.005 * h), (0, 1.005 * h)], 1)
    return [body, cap]


def tin(p: Params) -> list[Part]:
    r, h = p["above_m"], p["height_m"]
    rim = 0.0025
    metal = [(0, 0), (r, 0), (r, rim), (r - 0.001, 2 * rim), (r - 0.001, h - 2 * rim), (r, h - rim), (r, h),
             (r - rim, h), (r - rim, h - rim), (0, h - rim)]  # fmt: skip
    label = [(r - 0.0004, 3 * rim), (r - 0.0004, h - 3 * rim)]
    return [revolved(metal, 1), revolved(label, 0)]


def vase(p: Params) -> list[Part]:
    radii, h = np.asarray(p["radii_m"]), p["height_m"]
    t = np.linspace(0, 1, 28)
    knots = np.linspace(0, 1, len(radii))
    smooth = np.interp(t, knots, radii)
    for _ in range(3):
        smooth[1:-1] = (smooth[:-2] + 2 * smooth[1:-1] + smooth[2:]) / 4
    outer = [(float(r), float(u * h)) for r, u in zip(smooth, t, strict=True)]
    inner = [(max(r - 0.003, 0.001), max(z, 0.005)) for r, z in outer]
    return [revolved([(0, 0), *outer, *inner[::-1], (0, 0.005)])]


def ball(p: Params) -> list[Part]:
    r, f = p["radius_m"], p.get("flatten", 1.0)
    return [ellipsoid((r, r, f * r), (0, 0, f * r), turns=48)]


def cone(p: Params) -> list[Part]:
    foot = [box((2.3 * p["below_m"], 2.3 * p["below_m"], 0.008), slot=1, bevel_m=0.001)] if p["foot"] else []
    lift = 0.008 if p["foot"] else 0.0
    return [*foot, cylinder(p["below_m"], p["height_m"], (0, 0, lift), top=p["above_m"])]


def carton(p: Params) -> list[Part]:
    return [box(p["size_m"], bevel_m=p["bevel_m"])]


def book(p: Params) -> list[Part]:
    x, y, z = p["size_m"]
    cover = 0.0025
    if p["standing"]:
        pages = box((x - 0.006, z - 2 * cover, y - 0.004), (0.002, 0, 0.002), slot=1)
        sides = [box((x, cover, y), (0, s * (z - cover) / 2, 0)) for s in (-1, 1)]
        return [pages, *sides, box((cover, z, y), (-x / 2, 0, 0))]
    pages = box((x - 0.006, y - 0.006, z - 2 * cover), (0.002, 0, cover), slot=1)
    return [pages, box((x, y, cover)), box((x, y, cover), (0, 0, z - cover)), box((cover, y, z), (-x / 2, 0, 0))]


def blocks(p: Params) -> list[Part]:
    """A toy of parts, one on the other, none of them quite in the middle."""
    parts, z = [], 0.0
    for number, piece in enumerate(p["pieces"]):
        a, b, h = piece["size_m"]
        at, slot = (*piece["at_m"], z), number % 2
        if piece["kind"] == "box":
            parts.append(box((a, b, h), at, slot, 0.0012, piece["yaw_deg"]))
        elif piece["kind"] == "roll":
            lying = cylinder(h / 2, a, (0, 0, -a / 2), slot).points[:, [2, 1, 0]] + [0, 0, h / 2]
            faces = cylinder(h / 2, a).faces[:, ::-1]
            parts.append(moved(Part(lying, faces, slot), at, piece["yaw_deg"]))
        else:
            parts.append(cylinder(a / 2, h, at, slot, top=a / 2 * piece["taper"]))
        z += h
    return parts


def animal(p: Params) -> list[Part]:
    s, lean = p["size_m"], p["lean"]
    leg, body = 0.35 * s, 0.28 * s
    parts = [ellipsoid((0.5 * s, body, 0.9 * body), (0, 0, leg + 0.7 * body))]
    head = (0.55 * s, 0, leg + body * (1.2 + lean))
    parts += [ellipsoid((0.24 * s, 0.2 * s, 0.2 * s), head), ellipsoid((0.12 * s, 0.1 * s, 0.09 * s),
              (head[0] + 0.22 * s, 0, head[2] - 0.04 * s), 1)]  # fmt: skip
    for sx, sy in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        parts.append(cylinder(0.09 * s, leg + 0.3 * body, (0.3 * s * sx, 0.15 * s * sy, 0), top=0.11 * s))
    for sy in (-1, 1):
        parts.append(ellipsoid((0.05 * s, 0.07 * s, p["ears"] * s), (head[0] - 0.05 * s, 0.12 * s * sy,
                     head[2] + 0.2 * s), 1))  # fmt: skip
    tail = [(-0.48 * s, 0, leg + body), (-0.6 * s, 0, leg + 1.3 * body), (-0.66 * s, 0.03 * s, leg + 1.9 * body)]
    return [*parts, swept(tail, 0.03 * s)]


def figure(p: Params) -> list[Part]:
    h, arm = p["height_m"], p["arm_deg"]
    w = 0.12 * h
    parts = [cylinder(0.06 * h, 0.42 * h, (0, s * 0.075 * h, 0), 1) for s in (-1, 1)]
    parts += [box((0.13 * h, 0.28 * h, 0.3 * h), (0, 0, 0.42 * h), bevel_m=0.01 * h)]
    parts += [ellipsoid((0.1 * h, 0.1 * h, 0.12 * h), (0, 0, 0.87 * h), 1)]
    for s, angle in ((-1, arm), (1, p["other_arm_deg"])):
        a = math.radians(angle)
        shoulder = np.array([0, s * 0.16 * h, 0.69 * h])
        hand = shoulder + 0.3 * h * np.array([0.2, s * math.cos(a), math.sin(a)])
        parts.append(swept([shoulder, (shoulder + hand) / 2, hand], 0.3 * w))
    return parts


def car(p: Params) -> list[Part]:
    length, w, h = p["size_m"]
    r = 0.24 * h
    parts = [box((length, w, 0.42 * h), (0, 0, r), bevel_m=0.06 * h)]
    parts += [box((p["cabin"] * length, 0.86 * w, 0.40 * h), (-0.06 * length, 0, r + 0.42 * h), 1, 0.1 * h)]
    wheel = cylinder(r, 0.18 * w, (0, 0, -0.09 * w), 2)
    for sx, sy in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        parts.append(Part(wheel.points[:, [0, 2, 1]] + [0.3 * length * sx, 0.46 * w * sy, r], wheel.faces[:, ::-1], 2))
    return parts


def plant(p: Params) -> list[Part]:
    r, h = p["pot_m"], 1.7 * p["pot_m"]
    pot = [(0, 0), (0.72 * r, 0), (0.95 * r, 0.8 * h), (1.05 * r, 0.8 * h), (1.05 * r, h), (0.92 * r, h),
           (0.9 * r, 0.86 * h), (0, 0.86 * h)]  # fmt: skip
    parts = [revolved(pot)]
    rng = np.random.default_rng(p["seed"])
    u = np.linspace(0, 1, 8)
    for _ in range(p["leaves"]):
        lean, turn = rng.uniform(0.15, 1.0), rng.uniform(0, 2 * math.pi)
        length, width = p["leaf_m"] * rng.uniform(0.6, 1.1), p["leaf_m"] * p["leaf_width"] * rng.uniform(0.8, 1.2)
        out = length * (lean * u + 0.2 * u**2)
        up = 0.86 * h + length * (u * (1.2 - 0.5 * lean) - 0.55 * lean * u**2)
        half = width / 2 * np.sin(math.pi * np.clip(u, 0.04, 0.985)) ** 0.8
        side = np.stack([np.stack([out, s * half, up + 0.25 * half * abs(s)], -1) for s in (-1, 0, 1)], 1)
        parts.append(Part(turned_z(side.reshape(-1, 3), math.degrees(turn)), grid_faces(7, 2), 3))
    return parts


def heap(p: Params) -> list[Part]:
    """A cloth let fall: a bump with folds that run down and out."""
    rng = np.random.default_rng(p["seed"])
    n = 64
    r, a = np.linspace(0, 1, n)[:, None], np.linspace(0, 2 * math.pi, n + 1)[None]
    folds = sum(rng.uniform(0.3, 1) / k * np.cos(k * a + rng.uniform(0, 6.3) + 2.5 * rng.uniform(-1, 1) * r)
                for k in range(2, 10))  # fmt: skip
    reach = p["radius_m"] * r * (1 + 0.16 * folds * r)
    dome = np.cos(math.pi / 2 * r ** p["steep"]) * (1 + 0.22 * folds * np.sin(math.pi * r))
    z = np.maximum(p["height_m"] * dome, 0)
    points = np.stack([reach * np.cos(a), reach * np.sin(a), z * np.ones_like(a)], -1)
    points[:, -1] = points[:, 0]
    return [Part(points.reshape(-1, 3), grid_faces(n - 1, n))]


def ell(p: Params) -> list[Part]:
    x, y, z = p["size_m"]
    return [box((x, y, z * p["low"]), bevel_m=0.001), box((x * 0.36, y, z), (-0.32 * x, 0, 0), bevel_m=0.001)]


def monkey(p: Params) -> list[Part]:
    """A stand-in of the size of Blender's own monkey, which the renderer puts in its place."""
    s = p["size_m"]
    return [ellipsoid((0.36 * s, 0.60 * s, 0.43 * s), (0, 0, 0.43 * s))]


FAMILIES = {each.__name__: each for each in (
    cup, tumbler, mug, bottle, tin, vase, ball, cone, carton, book, blocks, animal, figure, car, plant, heap,
    ell, monkey, paper_cube,
    rare_shapes.hand, rare_shapes.tape_roll, rare_shapes.chair, rare_shapes.teapot, rare_shapes.pyramid,
    rare_shapes.slab, rare_shapes.foliage, rare_shapes.person,
)}  # fmt: skip


def built(family: str, params: Params) -> list[Part]:
    """The parts of an object; raises KeyError for a family that does not exist."""
    return FAMILIES[family](params)


def placed_points(spec: dict[str, Any], ground_z: float) -> Floats:
    """(n, 3) every vertex of a specified object where it stands, or hangs if it has `xyz_m`."""
    points = np.concatenate([part.points for part in built(spec["family"], spec["params"])])
    return turned_z(points, spec["yaw_deg"]) + np.array(spec.get("xyz_m", [*spec["xy_m"], ground_z]))
