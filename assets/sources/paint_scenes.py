"""Paints the scenes with a known light in ../scenes: objects beside a marker, ray by ray, in NumPy alone.

Convex bodies under a sun or lamp with a disc (penumbrae), a second sun or none, and an open sky that objects hide
(contact shadows), on grounds with patterns; then exposure, blur, noise and JPEG. Not path traced: no light is thrown
from one surface onto another, and lamps are not seen themselves. Fields and frames are those that
`ashe_live/bench/cases.py` reads. Two minutes on one core; the second, lamps at the extremes of their places, six:

    python assets/sources/paint_scenes.py
    python assets/sources/paint_scenes.py --extremes DIR
"""

import argparse
import json
from pathlib import Path

import cv2
import numpy as np
from painted.ground import DICTIONARY, MARKER_ID, SIDE_M
from painted.lights import lamp
from painted.picture import SIZE, K, Rays, masks_of, pictured, pose
from painted.scene_list import SCENES, Scene, extremes

OUT = Path(__file__).resolve().parents[1] / "scenes"
SEED = 5150


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--extremes", type=Path, metavar="DIR", help="only lamps at the extremes of their places, there")
    asked = ask.parse_args()
    out, scenes = (OUT, SCENES) if asked.extremes is None else (asked.extremes, tuple(extremes()))
    out.mkdir(exist_ok=True)
    entries = []
    for number, scene in enumerate(scenes):
        entries.append(painted(scene, np.random.default_rng(SEED + number), out))
        print(scene.id, flush=True)
    (out / "ground_truth.json").write_text(json.dumps({"seed": SEED, "scenes": entries}, indent=1) + "\n")


def painted(scene: Scene, rng: np.random.Generator, out: Path) -> dict:
    """Writes the scene's picture and masks to a folder; its entry in ground_truth.json."""
    rays = Rays.of(scene)
    masks = masks_of(scene, rays)
    cv2.imwrite(str(out / f"{scene.id}.jpg"), pictured(scene, rays, rng), [cv2.IMWRITE_JPEG_QUALITY, 90])
    for name, values in masks.items():
        cv2.imwrite(str(out / f"{scene.id}_{name}.png"), values.astype(np.uint8) * 255, [cv2.IMWRITE_PNG_BILEVEL, 1])
    return described(scene) | {"masks": {name: f"{scene.id}_{name}.png" for name in masks}}


def described(scene: Scene) -> dict:
    """The scene's entry in ground_truth.json, without its masks."""
    R, t = pose(*scene.eye)
    half = SIDE_M / 2
    corners = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)]) @ R.T + t
    corners = corners @ K.T
    return {
        "id": scene.id,
        "category": scene.category,
        "image": f"{scene.id}.jpg",
        "size": list(SIZE),
        "K": K.tolist(),
        "dist": [0.0] * 5,
        "R": R.tolist(),
        "t": t.tolist(),
        "marker": {
            "dictionary": DICTIONARY,
            "id": MARKER_ID,
            "side_m": SIDE_M,
            "corners_px": (corners[:, :2] / corners[:, 2:]).tolist(),
        },
        "directional": bool(scene.suns),
        "lights": [
            {
                "dir_to_light": sun[:3].tolist(),
                "relative_strength": strength,
                "angular_diameter_deg": scene.sun_deg,
                **lamp(sun, scene.sun_deg),
            }
            for sun, (_, _, strength) in zip(scene.lights, scene.suns, strict=True)
        ],
        "caster": {"type": scene.caster, "base_xy_m": scene.bodies[0].middle[:2].tolist()},
    }


if __name__ == "__main__":
    main()
