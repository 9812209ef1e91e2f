"""Develops rendered radiance into photos with masks, or into clips, and writes ground truth (runs with ashe_live).

    env/bin/python -m scenes.develop sets/training sets/development sets/sealed --watch

Pictures that exist are left; `ground_truth.json` is written anew after every few scenes, each time whole.
With --watch it waits for scenes still being rendered, and ends when all are there.
"""

import argparse
import json
import os
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from develop_clip import write_video

from ashe_live.api import Tracker
from ashe_live.core.camera import Camera
from scenes.geometry import surroundings
from scenes.photo.camera import photographed
from scenes.photo.masks import masks
from scenes.photo.truth import frame_entry, scene_entry, still_entry

Params = dict[str, Any]
SCENES_A_WRITE = 20
POLL_S = 20.0


def mixed(spec: Params, picture: Params, raw: Any) -> tuple[Any, Any]:
    """Linear radiance (..., 3) with the picture's lights alone, and the colour (3,) of the light on the ground."""
    sky = surroundings.irradiance(surroundings.radiance(spec["surroundings"]))
    light, on_ground = raw["ambient"].astype(np.float32), np.array(sky)
    for number, gain in zip(picture["lights"] or picture["unseen_lights"], picture["gains"], strict=True):
        light = light + gain * raw[f"light{number}"].astype(np.float32)
        colour = np.asarray(spec["lights"][number]["colour"])
        on_ground = on_ground + gain * spec["lights"][number]["strength"] * colour / (colour @ surroundings.LUMINANCE)
    return light, on_ground


def still(spec: Params, picture: Params, raw: Any, out: Path) -> Params:
    """Writes one picture and its masks; its entry in ground_truth.json."""
    found = masks(spec, picture["lights"], raw)
    image, gains = photographed(*mixed(spec, picture, raw), picture["camera"])
    name = picture["id"]
    cv2.imwrite(str(out / f"{name}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, picture["camera"]["jpeg_quality"]])
    for kind, values in found.items():
        cv2.imwrite(str(out / f"{name}_{kind}.png"), values.astype(np.uint8) * 255, [cv2.IMWRITE_PNG_BILEVEL, 1])
    files = {"image": f"{name}.jpg", "masks": {kind: f"{name}_{kind}.png" for kind in found}}
    entry = still_entry(spec, picture, raw, found, gains) | files
    entry["marker"]["detection"] = detection(entry, cv2.imread(str(out / f"{name}.jpg")))
    return entry


def detection(entry: Params, image: Any) -> Params | None:
    """How far the pose is from the truth that ashe_live's tracker finds in the picture; None if it finds no marker.

    A picture whose marker is not found never reaches an estimator: it is not to count for or against one.
    """
    marker = entry["marker"]
    camera = Camera(tuple(entry["size"]), np.array(entry["K"]), np.zeros(5), "file")
    name = marker_name(marker)
    found = Tracker(camera, name, marker["side_m"]).track(image).marker
    if found is None:
        return None
    turn = found.T_cam_marker[:3, :3] @ np.array(entry["R"]).T
    corners = {}
    if "corners_px" in marker:
        off = np.linalg.norm(found.corners_px - np.array(marker["corners_px"]), axis=1)
        corners = {"corner_rms_px": round(float(np.sqrt(np.mean(off**2))), 3)}
    return corners | {
        "pnp_rotation_error_deg": round(float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))), 3),
        "pnp_translation_error_m": round(float(np.linalg.norm(found.T_cam_marker[:3, 3] - entry["t"])), 5),
    }


def marker_name(marker: Params) -> str:
    """As ashe_live takes it."""
    dictionary = marker["dictionary"].removeprefix("DICT_").lower()
    if "id" not in marker:
        return str(dictionary)  # the cube
    kind = "apriltag" if dictionary.startswith("apriltag") else "aruco"
    return f"{kind}:{dictionary.removeprefix('apriltag_')}:{marker['id']}"


def take(spec: Params, picture: Params, raw: Any, out: Path) -> Params:
    """Writes one clip, exposed as its middle frame; its entry in ground_truth.json."""
    light, on_ground = mixed(spec, picture, raw)
    settings = picture["camera"]
    _, gains = photographed(light[len(light) // 2], on_ground, settings)
    images = [
        photographed(each, on_ground, settings | {"seed": settings["seed"] + number}, gains)[0]
        for number, each in enumerate(light)
    ]
    found = markers_found(spec, images)
    write_video(out / f"{picture['id']}.mp4", [image[..., ::-1] for image in images], spec["fps"])
    return scene_entry(spec, picture, raw) | {
        "video": f"{picture['id']}.mp4", "fps": spec["fps"], "span_deg": spec["span_deg"],
        "frames": [frame_entry(spec, number, seen) for number, seen in enumerate(found)],
    }  # fmt: skip


def markers_found(spec: Params, images: list[Any]) -> list[bool]:
    """In which of a take's frames the marker is found: a tag by OpenCV's detector, the cube by ashe_live's tracker."""
    marker = spec["marker"]
    if "id" not in marker:
        camera = Camera(tuple(spec["size"]), np.array(spec["camera"]["K"]), np.zeros(5), "file")
        tracker = Tracker(camera, marker_name(marker), marker["side_m"])
        return [tracker.track(image).marker is not None for image in images]
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, marker["dictionary"]))
    detector = cv2.aruco.ArucoDetector(dictionary)
    every_ids = (detector.detectMarkers(image)[1] for image in images)
    return [ids is not None and marker["id"] in np.ravel(ids) for ids in every_ids]


def write_truth(path: Path, content: Params, known: dict[str, Params]) -> None:
    """Whole or not at all."""
    entries = [known[p["id"]] for spec in content["scenes"] for p in spec["pictures"] if p["id"] in known]
    stills = [e for e in entries if "image" in e]
    lists = {"scenes": [e for e in stills if e["marker"]["detection"]], "takes": [e for e in entries if "video" in e]}
    written = [f'"{key}": [\n' + ",\n".join(map(json.dumps, those)) + "\n]" for key, those in lists.items() if those]
    lost = [e for e in stills if not e["marker"]["detection"]]
    if lost:
        written.append('"marker_not_found": [\n' + ",\n".join(map(json.dumps, lost)) + "\n]")
    head = f'"format": 1, "set": "{content["set"]}", "seed": {content["seed"]}, "style": "G"'
    part = path.with_name(f".{path.name}.{os.getpid()}")
    part.write_text("{" + ", ".join([head, *written]) + "}\n")
    part.replace(path)


def develop(folder: Path) -> int:
    """Develops what is rendered of a set and not yet developed; the number of scenes that are still to be rendered."""
    content = json.loads((folder / "specifications.json").read_text())
    path = folder / "ground_truth.json"
    before = json.loads(path.read_text()) if path.exists() else {}
    known = {e["id"]: e for key in ("scenes", "takes", "marker_not_found") for e in before.get(key, [])}
    late = fresh = 0
    for spec in content["scenes"]:
        if all(picture["id"] in known for picture in spec["pictures"]):
            continue
        try:
            with np.load(folder / "radiance" / f"{spec['id']}.npz") as file:
                raw = dict(file)
        except FileNotFoundError:
            late += 1
            continue
        for picture in (each for each in spec["pictures"] if each["id"] not in known):
            made = take if "frames" in spec else still
            known[picture["id"]] = made(spec, picture, raw, folder)
        fresh += 1
        if fresh % SCENES_A_WRITE == 0:
            write_truth(path, content, known)
    if fresh:
        write_truth(path, content, known)
    return late


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("sets", type=Path, nargs="+", help="folders with specifications.json and radiance")
    ask.add_argument("--watch", action="store_true", help="wait for scenes that are still being rendered")
    asked = ask.parse_args()
    cv2.setNumThreads(1)
    while sum([develop(folder) for folder in asked.sets]) and asked.watch:
        time.sleep(POLL_S)


if __name__ == "__main__":
    main()
