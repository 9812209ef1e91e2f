"""Places a scene's things so that the picture is of use: the marker readable, object and shadow to be seen."""

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scenes.drawing import families
from scenes.drawing.distractors import outside_caster, patches
from scenes.drawing.families import HELD_OUT, Params, Rng, between, pick
from scenes.drawing.lights import LIGHT_KINDS, lamp, sun
from scenes.geometry.poses import cast, intrinsics, look_at, projected, share_in_frame, square
from scenes.geometry.shapes import placed_points

MARGIN_PX = 5
SIZES = {(480, 360): 4, (400, 300): 6, (360, 480): 0.8, (300, 400): 1, (480, 320): 1}
DICTIONARIES = {"DICT_4X4_50": 5, "DICT_5X5_50": 2, "DICT_6X6_250": 2, "DICT_APRILTAG_36h11": 2}
HELD_OUT_SHARE = 0.6  # of the sealed set's objects, and of its grounds
CELL_PX = 4.6  # a marker's narrowest cell that detectors read through blur and noise
LIGHTS = 3
LIGHT_TRIES = 15
MOST_OF_MARKER_SHADED = 0.55
NEAR_M = 0.05  # what comes nearer to the camera's plane counts as not to be seen


def layout(rng: Rng, base: str, ground: Params, sealed: bool, dark: bool, lamps: bool) -> Params | None:
    """One try at placing everything; None where the picture would be of no use. `lamps`: two lights are near."""
    sheet = marker(rng)
    ground_z = -sheet["card_m"]
    alone = base == "misleading" and rng.random() < 0.3  # the marker, and no object
    caster = thing(rng, ground, sealed, dark, (0, 0))
    reach = float(np.linalg.norm(placed_points(caster, 0)[:, :2], axis=1).max())
    apart, turn = sheet["paper_side_m"] * 0.62 + reach + rng.uniform(0.005, 0.09), rng.uniform(0, 2 * math.pi)
    caster["xy_m"] = [round(apart * math.cos(turn), 5), round(apart * math.sin(turn), 5)]
    points = placed_points(caster, ground_z)
    caster["height_m"] = round(float(points[:, 2].max()) - ground_z, 5)

    camera, size = view(rng, caster, base)
    hull, paper = hull_px(camera, points), square(sheet["paper_side_m"])
    if share_in_frame(camera, paper, size, MARGIN_PX) < 1 or not marker_readable(camera, sheet):
        return None
    partial = str(rng.choice(["object_out", "shadow_out", "occluded"])) if base == "partial" else None
    cut = partial == "object_out"
    seen = share_in_frame(camera, points, size, 2)
    too_small = cv2.contourArea(hull) < 0.008 * size[0] * size[1]
    if not alone and (
        too_small or not (0.45 < seen < 0.9 if cut else seen == 1) or overlap(hull_px(camera, paper), hull) > 0.02
    ):
        return None
    objects: list[Params] = [] if alone else [caster | {"role": "caster"}]
    occluded = partial == "occluded"
    count = int(rng.integers(1, 4)) if base == "clutter" else 1 if occluded else int(rng.random() < 0.1)
    if lamps:
        count = int(rng.integers(0, 3))
    for _ in range(0 if alone else count):
        other = neighbour(rng, ground, sealed, camera, size, objects, sheet, hull, occluded)
        if other is None:
            return None
        objects.append(other)
    lights = _lights(rng, lamps, camera, size, sheet, objects, points, hull, partial)
    if lights is None:
        return None
    if (base == "misleading" and alone) or rng.random() < 0.1:
        outside = outside_caster(rng, camera, size, lights, points, ground_z, alone)
        if outside is None and alone:
            return None
        objects += [outside] if outside is not None else []
    marks = []
    if base == "misleading" or rng.random() < 0.12:
        marks = patches(rng, ground, None if alone else caster, points, sheet, base == "misleading")
    if base == "misleading" and not alone and not mark_seen(camera, size, hull, marks, ground_z):
        return None
    return {
        "size": size, "camera": camera, "ground": ground | {"z_m": ground_z}, "marker": sheet, "objects": objects,
        "patches": marks, "lights": lights, "without_object": alone,
        "partial_kind": partial,
    }  # fmt: skip


def thing(rng: Rng, ground: Params, sealed: bool, dark: bool, at: Any) -> Params:
    """An object's specification."""
    held_out = sealed and rng.random() < HELD_OUT_SHARE
    family = str(rng.choice(HELD_OUT["object"])) if held_out else pick(rng, families.OBJECTS)
    return {
        "family": family, "params": families.object_params(rng, family),
        "material": families.material(rng, ground, dark),
        "xy_m": [round(float(v), 5) for v in at], "yaw_deg": between(rng, 0, 360),
    }  # fmt: skip


def marker(rng: Rng) -> Params:
    """A printed marker: black or grey, on paper that may be curled, or on a card that lifts it over the ground."""
    dictionary, number = pick(rng, DICTIONARIES), int(rng.integers(50))
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    across = known.markerSize + 2
    cells = cv2.aruco.generateImageMarker(known, number, across)
    side = between(rng, 0.05, 0.1)
    card = between(rng, 0.0015, 0.005) if rng.random() < 0.15 else 0.0002
    return {
        "dictionary": dictionary, "id": number, "side_m": side,
        "paper_side_m": round(side * between(rng, 1 + 2 / across, 1.7), 5),
        "cells": (cells > 127).astype(int).tolist(),
        "ink": between(rng, 0.12, 0.3) if rng.random() < 0.15 else between(rng, 0.02, 0.06),
        "paper": between(rng, 0.6, 0.85), "card_m": card,
        "curl_m": between(rng, 0.0005, 0.004) if card < 0.001 and rng.random() < 0.35 else 0.0,
        "curl_azimuth_deg": between(rng, 0, 180), "cut_deg": between(rng, -3, 3),
    }  # fmt: skip


def view(rng: Rng, caster: Params, base: str) -> tuple[Params, list[int]]:
    """A camera that looks between marker and object, from a hand's distance to an arm's length; its picture's size."""
    chance = np.array([*SIZES.values()])
    size = [int(v) for v in list(SIZES)[rng.choice(len(SIZES), p=chance / chance.sum())]]
    hfov = between(rng, 45, 80) if size[0] > size[1] else between(rng, 40, 60)
    middle = np.array([*caster["xy_m"], 0.0]) * rng.uniform(0.35, 0.75) + [*rng.normal(0, 0.03, 2), 0.02]
    if base == "partial":
        middle[:2] += rng.normal(0, 0.09, 2)
    pitch = min(max(rng.normal(43, 15), 15), 80)
    R, t = look_at(middle, rng.uniform(0, 360), pitch, rng.uniform(0.25, 0.85), rng.normal(0, 5))
    camera = {"K": intrinsics(size, hfov).tolist(), "hfov_deg": hfov, "R": np.round(R, 9).tolist(),
              "t": np.round(t, 7).tolist(), "pitch_deg": round(float(pitch), 3)}  # fmt: skip
    return camera, size


def marker_readable(camera: Params, sheet: Params) -> bool:
    corners = hull_px(camera, square(sheet["side_m"]))
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    return bool(min(sides.min(), *cv2.minAreaRect(corners)[1]) / len(sheet["cells"]) > CELL_PX)


def neighbour(rng: Rng, ground: Params, sealed: bool, camera: Params, size: list[int], objects: list[Params],
              sheet: Params, caster_hull: Any, before: bool) -> Params | None:  # fmt: skip
    """Another object, at least partly in the frame; `before`: between camera and caster. None: no place found."""
    ground_z = -sheet["card_m"]
    eye = -np.asarray(camera["R"]).T @ np.asarray(camera["t"])
    for _ in range(12):
        other = thing(rng, ground, sealed, False, rng.uniform(-0.3, 0.3, 2)) | {"role": "clutter"}
        if before and objects:
            way = eye[:2] - objects[0]["xy_m"]
            at = objects[0]["xy_m"] + way / np.linalg.norm(way) * rng.uniform(0.08, 0.18) + rng.normal(0, 0.03, 2)
            other["xy_m"] = [round(float(v), 5) for v in at]
        points = placed_points(other, ground_z)
        other["height_m"] = round(float(points[:, 2].max()) - ground_z, 5)
        reach = np.linalg.norm(points[:, :2] - other["xy_m"], axis=1).max()
        free = np.linalg.norm(other["xy_m"]) > reach + 0.7 * sheet["paper_side_m"]
        for each in objects:
            there = placed_points(each, ground_z)[:, :2]
            free &= np.linalg.norm(there - other["xy_m"], axis=1).min() > reach + 0.004
        if not free or share_in_frame(camera, points, size) < 0.4 or not ahead(camera, points):
            continue
        hull = hull_px(camera, points)
        if overlap(hull_px(camera, square(sheet["paper_side_m"])), hull) > 0.01:
            continue
        hidden = overlap(caster_hull, hull)
        if (0.1 < hidden < 0.5) if before else hidden < 0.12:
            return other
    return None


def _lights(rng: Rng, lamps: bool, camera: Params, size: list[int], sheet: Params, objects: list[Params], points: Any,
            hull: Any, partial: str | None) -> list[Params] | None:  # fmt: skip
    """Lights of which each by itself throws a shadow that is to be seen; None where that is not to be had."""
    lights: list[Params] = []
    for _ in range(LIGHT_TRIES * LIGHTS):
        if lamps and len(lights) < LIGHTS - 1:
            light = lamp(rng, max((each["height_m"] for each in objects), default=0.0))
            if share_in_frame(camera, [light["position_m"]], size) > 0:
                continue
        else:
            light = sun(rng, pick(rng, LIGHT_KINDS), [each["azimuth_deg"] for each in lights])
        if not objects or _throws(camera, size, sheet, objects, points, hull, light, partial):
            lights.append(light)
            if len(lights) == LIGHTS:
                return lights
    return None


def _throws(camera: Params, size: list[int], sheet: Params, objects: list[Params], points: Any, hull: Any,
            light: Params, partial: str | None) -> bool:  # fmt: skip
    """Whether the caster's shadow lies in the frame, is not hidden by it, and the marker stays mostly lit."""
    ground_z = -sheet["card_m"]
    fallen = cast(points, light, ground_z)
    inside = share_in_frame(camera, fallen, size)
    least = 0.3 if partial or light["kind"] == "low" else 0.65
    if inside < least or (partial == "shadow_out" and inside > 0.85):
        return False
    if ahead(camera, fallen):
        shadow = hull_px(camera, fallen)
        uncovered = cv2.contourArea(shadow) * (1 - overlap(shadow, hull))
        if uncovered < (0.05 if light["kind"] == "high" else 0.12) * cv2.contourArea(hull):
            return False
    marker_m = np.float32(square(sheet["side_m"])[:, :2])
    for each in objects:
        flat = np.float32(cast(placed_points(each, ground_z), light, ground_z)[:, :2])
        if overlap(marker_m, cv2.convexHull(flat).reshape(-1, 2)) > MOST_OF_MARKER_SHADED:
            return False
    return True


def mark_seen(camera: Params, size: list[int], hull: Any, marks: list[Params], ground_z: float) -> bool:
    """Whether the first mark, the one that misleads, lies in the picture and not behind the object."""
    if not marks or not marks[0]["at_foot"]:
        return False
    flat = np.asarray(marks[0]["outline_m"])
    outline = np.column_stack([flat, np.full(len(flat), ground_z)])
    if share_in_frame(camera, outline, size) < 0.8 or not ahead(camera, outline):
        return False
    mark = hull_px(camera, outline)
    return bool(cv2.contourArea(mark) * (1 - overlap(mark, hull)) > 0.2 * cv2.contourArea(hull))


def ahead(camera: Params, points: Any) -> bool:
    """Whether all points lie before the camera."""
    return bool((np.asarray(points) @ np.asarray(camera["R"])[2] + camera["t"][2] > NEAR_M).all())


def hull_px(camera: Params, points: Any) -> NDArray[np.float32]:
    """(k, 2) convex outline in the picture of points that are all in front of the camera."""
    return cv2.convexHull(np.float32(projected(camera, points)[0])).reshape(-1, 2)  # type: ignore[no-any-return]


def overlap(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """The share of the first convex outline that the second covers."""
    area = abs(cv2.contourArea(one))
    return float(cv2.intersectConvexConvex(one, other)[0] / area) if area > 0 else 0.0
