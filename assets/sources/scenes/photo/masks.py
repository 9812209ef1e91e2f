"""Masks of a rendered scene: what is seen of its objects, and their shadows by projecting the rendered triangles."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scenes.geometry.index import CASTER, CLUTTER, GROUND, OUTSIDE, SHEET
from scenes.geometry.poses import cast, projected

Params = dict[str, Any]
Masks = NDArray[np.bool_]
NEAR_M = 0.04  # what lies nearer to the camera's plane is cut off; no ground that is seen does
SUBPIXEL_BITS = 4
FARTHEST_PX = 30000  # what OpenCV fills without overflow


def mask_of_triangles(camera: Params, size: list[int], points: Any, faces: Any) -> Masks:
    """(h, w) pixels that any of the triangles (m, 3) of points (n, 3) in the marker's frame covers."""
    canvas = np.zeros((size[1], size[0]), np.uint8)
    pixels, depth = projected(camera, points)
    ahead = depth[faces] > NEAR_M
    whole = faces[ahead.all(axis=1)]
    corners = np.clip(pixels[whole], -FARTHEST_PX, FARTHEST_PX)
    keep = (corners.max(axis=1) > -1).all(axis=1) & (corners.min(axis=1) < np.asarray(size)).all(axis=1)
    polygons = np.round(corners[keep] * 2**SUBPIXEL_BITS).astype(np.int32)
    for polygon in polygons:
        cv2.fillConvexPoly(canvas, polygon, 1, shift=SUBPIXEL_BITS)
    for face in faces[ahead.any(axis=1) & ~ahead.all(axis=1)]:
        cut = _in_front(camera, np.asarray(points, np.float64)[face])
        if len(cut) < 3:  # it only just reaches the plane before the camera
            continue
        polygon = np.clip(projected(camera, cut)[0], -FARTHEST_PX, FARTHEST_PX)
        cv2.fillConvexPoly(canvas, np.round(polygon * 2**SUBPIXEL_BITS).astype(np.int32), 1, shift=SUBPIXEL_BITS)
    return canvas > 0


def _in_front(camera: Params, triangle: Any) -> Any:
    """A triangle without what lies behind the camera."""
    depth = triangle @ np.asarray(camera["R"])[2] + camera["t"][2] - NEAR_M
    kept = []
    for a in range(3):
        b = (a + 1) % 3
        if depth[a] > 0:
            kept.append(triangle[a])
        if (depth[a] > 0) != (depth[b] > 0):
            kept.append(triangle[a] + (triangle[b] - triangle[a]) * depth[a] / (depth[a] - depth[b]))
    return np.array(kept)


def masks(spec: Params, shining: list[int], raw: Any) -> dict[str, Masks]:
    """By name as in the scenes' format: what is seen of caster, clutter, and the shadows of every light that shines."""
    index, size, camera = raw["index"], spec["size"], spec["camera"]
    ground_z = spec["ground"]["z_m"]
    level = np.isin(index, (GROUND, SHEET))
    found = {"object": index == CASTER}
    others = any(each["role"] != "caster" for each in spec["objects"])
    if others:
        found["clutter"] = np.isin(index, (CLUTTER, OUTSIDE))
    for number, light in enumerate(shining):
        everything, of_caster = np.zeros_like(level), np.zeros_like(level)
        for k, each in enumerate(spec["objects"]):
            fallen = cast(np.maximum(raw[f"points{k}"], [-np.inf, -np.inf, ground_z]), spec["lights"][light], ground_z)
            covered = mask_of_triangles(camera, size, fallen, raw[f"faces{k}"]) & level
            everything |= covered
            if each["role"] == "caster":
                of_caster |= covered
        name = "shadow" if number == 0 else f"shadow{number + 1}"
        found[name] = everything
        if others:
            found[f"{name}_caster"] = of_caster
    return found
