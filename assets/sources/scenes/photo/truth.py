"""The truth about a developed picture: its entry in ground_truth.json."""

from typing import Any

import numpy as np

from scenes.geometry import surroundings
from scenes.geometry.poses import cast, direction, projected, square
from scenes.photo.masks import Masks

Params = dict[str, Any]
MARKER = ("dictionary", "id", "side_m", "paper_side_m", "card_m", "curl_m", "ink")  # the cube has not all of them


def light_entry(spec: Params, light: Params, gain: float) -> Params:
    """A light as the format has it; surroundings give the open ground a luminance of 1."""
    colour = np.asarray(light["colour"])
    ground = colour / (colour @ surroundings.LUMINANCE) * light["strength"] * gain
    entry: Params = {
        "color": light["colour"],
        "relative_strength": 1.0,
        "irradiance_ground": np.round(ground, 5).tolist(),
    }
    if light.get("position_m") is not None:
        at = np.asarray(light["position_m"])
        way = at / np.linalg.norm(at)
        entry["lamp"] = _lamp(spec, light, at)
        diameter_deg = round(float(np.degrees(2 * np.arctan(light["radius_m"] / np.linalg.norm(at)))), 5)
    else:
        way = direction(light["azimuth_deg"], light["elevation_deg"])
        diameter_deg = light["angular_diameter_deg"]
    azimuth, elevation = np.degrees([np.arctan2(way[1], way[0]) % (2 * np.pi), np.arcsin(way[2])])
    return entry | {
        "dir_to_light": np.round(way, 8).tolist(), "azimuth_deg": round(float(azimuth), 4),
        "elevation_deg": round(float(elevation), 4), "angular_diameter_deg": diameter_deg,
        "irradiance_perpendicular": np.round(ground / way[2], 5).tolist(),
    }  # fmt: skip


def _lamp(spec: Params, light: Params, at: Any) -> Params:
    entry = {
        "position_m": light["position_m"], "radius_m": light["radius_m"], "color": light["colour"],
        "distance_m": round(float(np.linalg.norm(at)), 5), "dir_at_marker": (at / np.linalg.norm(at)).tolist(),
    }  # fmt: skip
    for each in spec["objects"]:
        if each["role"] == "caster":
            way = at - [*each["xy_m"], each["height_m"] / 2]
            entry["dir_at_caster"] = (way / np.linalg.norm(way)).tolist()
    return entry


def object_entry(spec: Params, each: Params, points: Any, shining: list[int]) -> Params:
    """Caster or clutter: kind, place, bounds, highest vertex and tips of its shadows."""
    camera, ground_z = spec["camera"], spec["ground"]["z_m"]
    points = np.asarray(points, float)
    top = points[points[:, 2].argmax()]
    entry = {
        "type": each["family"], "material": each["material"]["family"], "albedo": each["material"]["colour"],
        "base_xy_m": each["xy_m"], "yaw_deg": each["yaw_deg"],
        "height_m": round(float(points[:, 2].max() - ground_z), 5),
        "bbox_min_m": np.round(points.min(0), 6).tolist(), "bbox_max_m": np.round(points.max(0), 6).tolist(),
        "top_m": np.round(top, 6).tolist(), "top_px": np.round(projected(camera, top)[0][0], 2).tolist(),
        "shadow_tip_m": [],
    }  # fmt: skip
    for light in shining:
        fallen = cast(points, spec["lights"][light], ground_z)
        away = fallen[:, :2] - np.asarray(each["xy_m"])
        entry["shadow_tip_m"].append(np.round(fallen[np.linalg.norm(away, axis=1).argmax()], 6).tolist())
    return entry


def corners_m(sheet: Params) -> Any:
    """(4, 3) the black square's corners on the sheet as it lies, curled or not."""
    corners = square(sheet["side_m"])
    a = np.radians(sheet["curl_azimuth_deg"])
    along = (corners[:, 0] * np.cos(a) + corners[:, 1] * np.sin(a)) / (sheet["paper_side_m"] / 2)
    corners[:, 2] = sheet["curl_m"] * along**2
    return corners


def scene_entry(spec: Params, picture: Params, raw: Any) -> Params:
    """The entry of a picture or a take in ground_truth.json, without its files, poses, masks and corners."""
    shining, sheet, camera = picture["lights"], spec["marker"], spec["camera"]
    ambient = surroundings.radiance(spec["surroundings"])
    sky = surroundings.irradiance(ambient)
    lights, unseen_lights = (
        [light_entry(spec, spec["lights"][k], g) for k, g in zip(those, picture["gains"], strict=True)] if those else []
        for those in (shining, picture["unseen_lights"])
    )
    suns = np.array([each["irradiance_ground"] for each in lights]).reshape(-1, 3)
    full = sky + suns.sum(axis=0)
    for each, sun in zip(lights, suns, strict=True):
        each["relative_strength"] = round(
            float(sun @ surroundings.LUMINANCE / (suns @ surroundings.LUMINANCE).max()), 4
        )
    entries = [
        object_entry(spec, each, raw[f"points{k}"], shining) | {"role": each["role"]}
        for k, each in enumerate(spec["objects"])
    ]
    caster = next((each for each in entries if each["role"] == "caster"), None)
    ground = spec["ground"]
    return {
        "id": picture["id"],
        "category": picture["category"],
        "tags": {
            "base": spec["base"],
            "render": spec["id"],
            "object_family": caster["type"] if caster else "none",
            "material": caster["material"] if caster else "none",
            "ground": ground["family"],
            "camera": picture["camera"]["family"],
            "surroundings": spec["surroundings"]["family"],
            "patches": sorted({patch["kind"] for patch in spec["patches"]}),
            "outside_shadow": any(each["role"] == "outside" for each in entries),
            "marker_on_card": sheet["card_m"] > 0.001,
            "marker_curled": sheet["curl_m"] > 0,
        },
        "size": spec["size"],
        "K": camera["K"],
        "dist": [0.0] * 5,
        "hfov_deg": camera["hfov_deg"],
        "camera_distance_m": round(float(np.linalg.norm(camera["t"])), 4),
        "camera_pitch_deg": camera["pitch_deg"],
        "marker": {key: sheet[key] for key in MARKER if key in sheet},
        "directional": bool(shining),
        "lights": lights,
        "unseen_lights": unseen_lights,
        "ambient": {
            "kind": spec["surroundings"]["family"],
            "irradiance_ground": np.round(sky, 5).tolist(),
            "mean_direction": np.round(surroundings.mean_direction(ambient), 5).tolist(),
            "on_ball": np.round(surroundings.on_ball(ambient), 5).tolist(),
        },
        "shading_ratio": {
            "all_blocked": np.round(sky / full, 4).tolist(),
            "one_blocked": np.round((full - suns) / full, 4).tolist(),
        },
        "ground": {"texture": ground["family"], "albedo": ground["colour"], "z_m": ground["z_m"]},
        "caster": caster,
        "clutter": [each for each in entries if each["role"] != "caster"],
        "partial_kind": spec["partial_kind"],
        "photo": picture["camera"],
    }


def still_entry(spec: Params, picture: Params, raw: Any, found: dict[str, Masks], gains: list[float]) -> Params:
    """The entry of a still, without its files' names."""
    entry, camera = scene_entry(spec, picture, raw), spec["camera"]
    if "id" in entry["marker"]:
        entry["marker"]["corners_px"] = np.round(projected(camera, corners_m(spec["marker"]))[0], 3).tolist()
    entry["photo"] = entry["photo"] | {"gains": np.round(gains, 5).tolist()}
    counts = {f"{name}_px": int(values.sum()) for name, values in found.items()}
    return entry | {"R": camera["R"], "t": camera["t"], "visibility": counts}


def frame_entry(spec: Params, number: int, marker_found: bool) -> Params:
    """What `frames` of a take's entry says of one frame."""
    pose = spec["frames"][number]
    entry = {"frame": number, "time_s": round(number / spec["fps"], 5), "R": pose["R"], "t": pose["t"],
             "marker_detected": marker_found}  # fmt: skip
    if "id" not in spec["marker"]:
        return entry  # the cube, which is no single square
    corners = projected(spec["camera"] | pose, corners_m(spec["marker"]))[0]
    return entry | {"marker_corners_px": np.round(corners, 3).tolist()}
