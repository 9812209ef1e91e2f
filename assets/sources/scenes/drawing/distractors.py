"""What tempts one to see a shadow where there is none: stains, wet spots, stickers, mats, and shadows from outside."""

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scenes.drawing.families import Params, Rng, between, colour, log_between
from scenes.geometry.poses import cast, direction, projected, share_in_frame

Floats = NDArray[np.float64]
OUTLINE_POINTS = 48
UNSEEN_MATERIAL = {"family": "matte", "colour": [0.2, 0.2, 0.2], "second": [0.2, 0.2, 0.2], "roughness": 0.7,
                   "translucent": 0.0, "scale": 50.0, "pattern": "dots", "seed": 0.0}  # fmt: skip


def patches(
    rng: Rng, ground: Params, caster: Params | None, points: Floats, sheet: Params, at_foot: bool
) -> list[Params]:
    """Flat marks on the ground; `at_foot`: the first lies where the object's shadow could be."""
    made = []
    for number in range(int(rng.integers(1, 3 if at_foot else 4))):
        kind = str(rng.choice(["stain", "wet", "sticker", "silhouette", "silhouette"] if at_foot else
                              ["stain", "wet", "sticker", "print"]))  # fmt: skip
        if caster is not None and number == 0 and at_foot:
            outline = _shadow_like(rng, points) if kind == "silhouette" else _blob(rng, caster["xy_m"], 0.9)
            if rng.random() < 0.15:
                kind, outline = "mat", _rectangle(rng, caster["xy_m"])
        else:
            at = rng.uniform(-0.25, 0.25, 2)
            outline = _rectangle(rng, at) if rng.random() < 0.3 else _blob(rng, at, 0.5)
        if _meets_sheet(outline, sheet):
            continue
        opaque = kind in ("sticker", "mat", "print")
        tone = (np.array(ground["colour"]) if opaque else 1) * rng.uniform(0.25, 0.75) * rng.uniform(0.93, 1.05, 3)
        made.append({
            "kind": kind, "at_foot": number == 0 and at_foot,
            "outline_m": np.round(outline, 5).tolist(), "opaque": opaque,
            "colour": colour(rng, (0.05, 0.35), 0.5) if opaque and rng.random() < 0.6
            else [round(float(c), 4) for c in tone],
            "gloss": between(rng, 0.04, 0.2) if kind == "wet" else 0.0,
            "soft_m": log_between(rng, 0.0008, 0.012) if not opaque else 0.0,
        })  # fmt: skip
    return made


def _shadow_like(rng: Rng, points: Floats) -> Floats:
    """The outline of a shadow that no light throws, at the object's foot or a little off it."""
    light = {"azimuth_deg": rng.uniform(0, 360), "elevation_deg": rng.uniform(25, 65)}
    hull = cv2.convexHull(np.float32(cast(points, light, 0.0)[:, :2])).reshape(-1, 2)
    return np.asarray(hull, float) + (rng.normal(0, 0.02, 2) if rng.random() < 0.4 else 0)


def _blob(rng: Rng, at: Any, size: float) -> Floats:
    a = np.arange(OUTLINE_POINTS) * 2 * math.pi / OUTLINE_POINTS
    r = 1 + sum(rng.uniform(-0.28, 0.28) / k * np.cos(k * a + rng.uniform(0, 6.3)) for k in range(2, 7))
    x, y = rng.uniform(0.025, 0.07, 2) * (0.6 + size)
    turn = rng.uniform(0, math.pi)
    flat = np.column_stack([x * r * np.cos(a), y * r * np.sin(a)])
    spin = np.array([(math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))])
    return flat @ spin + np.asarray(at, float) + rng.normal(0, 0.03 * size, 2)


def _rectangle(rng: Rng, at: Any) -> Floats:
    x, y = rng.uniform(0.04, 0.11, 2)
    turn = rng.uniform(0, math.pi)
    spin = np.array([(math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))])
    return np.array([(-x, -y), (x, -y), (x, y), (-x, y)]) @ spin + np.asarray(at, float)


def _meets_sheet(outline: Floats, sheet: Params) -> bool:
    h = 0.56 * sheet["paper_side_m"]
    paper = np.float32([(-h, -h), (h, -h), (h, h), (-h, h)])
    return bool(cv2.intersectConvexConvex(paper, cv2.convexHull(np.float32(outline)).reshape(-1, 2))[0] > 0)


def outside_caster(rng: Rng, camera: Params, size: list[int], lights: list[Params], points: Floats, ground_z: float,
                   anywhere: bool) -> Params | None:  # fmt: skip
    """Something beyond the frame whose shadow, under the first light, falls into it; None: no place found."""
    d = direction(lights[0]["azimuth_deg"], lights[0]["elevation_deg"])
    kind = str(rng.choice(["slab", "foliage", "person"]))
    for _ in range(20):
        spot = np.array([*rng.uniform(-0.35, 0.35, 2), ground_z])
        high = rng.uniform(0.35, 1.2)
        radius = rng.uniform(0.05, 0.16)
        centre = spot + d * (high / d[2])
        pixels, depth = projected(camera, centre[None])
        eye = -np.asarray(camera["R"]).T @ np.asarray(camera["t"])
        corners = centre + radius * 1.5 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        in_view = share_in_frame(camera, corners, size) > 0 or np.linalg.norm(centre - eye) < radius * 2
        if in_view or (depth[0] > 0 and (np.abs(pixels[0] - np.array(size) / 2) < np.array(size) / 2).all()):
            continue
        if share_in_frame(camera, spot[None], size) < 1:
            continue
        falls = [cast(centre[None], light, ground_z)[0] for light in lights]
        spread = [radius * 1.4 / math.sin(math.radians(light["elevation_deg"])) for light in lights]
        near = lambda way, f, r: np.linalg.norm((way - f)[:2]) < r  # noqa: E731
        clear = not any(near(np.zeros(3), f, r + 0.06) for f, r in zip(falls, spread, strict=True))
        if not anywhere:
            foot = np.append(points[:, :2].mean(axis=0), 0)
            clear &= not any(near(foot, f, r + 0.09) for f, r in zip(falls, spread, strict=True))
        if clear:
            return {
                "role": "outside",
                "family": kind,
                "params": {"radius_m": round(radius, 4), "seed": int(rng.integers(1 << 30))},
                "xyz_m": np.round(centre, 5).tolist(),
                "xy_m": np.round(centre[:2], 5).tolist(),
                "yaw_deg": between(rng, 0, 360),
                "material": dict(UNSEEN_MATERIAL),
            }
    return None
