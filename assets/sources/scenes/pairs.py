"""Path-traces scenes with and without a shipped model on the marker, and without the sheet: truth for the renderer.

    env/bin/python -m scenes.pairs specify --out PAIRS
    bpyenv/bin/python -m scenes.pairs render --out PAIRS          # three pictures a scene; stop and start as you like
    env/bin/python -m scenes.pairs develop --out PAIRS            # then: ashe-live bench render --pairs PAIRS

Twelve scenes of the development set: grounds, suns of 0.5 to 7 degrees, plain cameras, phones and webcams; with
`specify --seed N` as many of the training set as chance has them, to check on what was not looked at while building.
The sheet lies flat on the ground, as a model stands on the marker's plane.
"""

import argparse
import json
import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

Params = dict[str, Any]
# Scene of the development set, and which of its pictures.
CHOSEN = (
    (6, 2), (43, 2), (19, 2), (53, 2), (52, 1), (23, 2), (57, 0), (10, 0), (50, 1), (18, 0), (58, 1), (66, 0),
)  # fmt: skip
TRAINING = 620  # scenes of that set, of which others are drawn
VERSIONS = ("bare", "model", "open")  # as it is, with the model, and without the sheet
MODEL = "cube"
MODEL_INDEX = 9  # of the object index pass
LEAST_LIFT_M = 0.0002  # of the sheet over the ground
PAPER = 0.8  # albedo of office paper; the set's own sheets have 0.6 to 0.85, which no picture of them can tell
SAMPLES = 32
DIRECTIONS = 200  # in which the real object's extreme points are looked for
DEEP_PX, BESIDE_PX, FEWEST_PX = 5, 40, 60  # ground in and beside the real shadow, away from all borders
FOOTPRINT_SIDES, HEIGHT_SIDES = 1.0, 1.2  # as ashe_live/models/placement.py


def specify(out: Path, seed: int | None) -> None:
    out.mkdir(parents=True, exist_ok=True)
    scenes = []
    for spec in chosen() if seed is None else drawn(seed):
        spec["ground"]["z_m"] = -LEAST_LIFT_M
        spec["marker"]["card_m"] = spec["marker"]["curl_m"] = 0.0
        spec["marker"]["paper"] = PAPER
        scenes.append(spec)
    (out / "specifications.json").write_text(json.dumps({"set": "pairs", "model": MODEL, "scenes": scenes}))


def chosen() -> Iterator[Params]:
    """Specifications with one picture each."""
    from scenes.specify import specification

    for index, number in CHOSEN:
        spec = specification("development", index)
        yield spec | {"pictures": [spec["pictures"][number]]}


def drawn(seed: int) -> Iterator[Params]:
    """The same of the training set, at random: as many, each in the light of one sun."""
    from scenes.specify import specification

    rng = np.random.default_rng(seed)
    found = 0
    for index in rng.permutation(TRAINING):
        spec = specification("training", int(index))
        suitable = [each for each in spec["pictures"] if len(each["lights"]) == 1]
        if suitable:
            yield spec | {"pictures": [suitable[int(rng.integers(len(suitable)))]]}
            found += 1
        if found == len(CHOSEN):
            return


def render(out: Path, count: int | None, samples: int) -> None:
    import bpy

    from scenes.geometry.index import SHEET
    from scenes.render import LAYERS, layer, set_up, triangles
    from scenes.tracing import assembly

    content = json.loads((out / "specifications.json").read_text())
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        set_up(samples, 1, folder)
        for spec in content["scenes"][:count]:
            for version in VERSIONS:
                path = out / f"{spec['id']}_{version}.npz"
                if path.exists():
                    continue
                start = time.perf_counter()
                assembly.clear()
                made = assembly.assemble(spec, out)
                if version == "model":
                    for obj in placed_model(content["model"], spec["marker"]["side_m"]):
                        obj.pass_index = MODEL_INDEX
                if version == "open":
                    for obj in [each for each in bpy.data.objects if each.pass_index == SHEET]:
                        bpy.data.objects.remove(obj)
                scene = bpy.context.scene
                scene.render.resolution_x, scene.render.resolution_y = spec["size"]
                scene.cycles.seed = spec["render_seed"]
                for stale in folder.glob("*.exr"):
                    stale.unlink()
                bpy.ops.render.render()
                shot = {name: layer(folder, name, spec["size"]).clip(0, 60000).astype(np.float16) for name in LAYERS}
                index = np.round(layer(folder, "index", spec["size"])[..., 0]).astype(np.uint8)
                for number, objects in enumerate(made):
                    shot[f"points{number}"], shot[f"faces{number}"] = triangles(objects)
                np.savez_compressed(path, **shot, index=index)
                print(f"{path.name} {time.perf_counter() - start:.1f} s", flush=True)


def placed_model(name: str, side_m: float) -> list[Any]:
    """The objects of a shipped model, as the viewer places it on a marker with that side."""
    import bpy
    from mathutils import Matrix, Vector

    before = set(bpy.data.objects)
    models = Path(__file__).resolve().parents[2] / "models"
    bpy.ops.import_scene.gltf(filepath=str(models / f"{name}.glb"))
    made = [obj for obj in bpy.data.objects if obj not in before]
    bpy.context.view_layer.update()
    points = np.array([obj.matrix_world @ v.co for obj in made if obj.type == "MESH" for v in obj.data.vertices])
    lower, upper = points.min(axis=0), points.max(axis=0)
    width, depth, height = upper - lower
    scale = side_m / max(width / FOOTPRINT_SIDES, depth / FOOTPRINT_SIDES, height / HEIGHT_SIDES)
    foot = Vector(((lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]))
    move = Matrix.Scale(scale, 4) @ Matrix.Translation(-foot)
    for obj in made:
        if obj.parent is None:
            obj.matrix_world = move @ obj.matrix_world
    return made


def develop(out: Path) -> None:
    """Writes ID_VERSION.jpg, ID_mask.png and pairs.json; exposure is that of the picture without the model.

    Besides, for `ashe-live bench render --budget`: photos as `renditions` has them, and ID_VERSION_light.tiff,
    the linear light as it was exposed.
    """
    import cv2

    from scenes.develop import mixed
    from scenes.geometry.poses import direction
    from scenes.geometry.surroundings import LUMINANCE, irradiance, radiance, slope
    from scenes.photo.camera import photographed
    from scenes.photo.masks import masks
    from scenes.photo.renditions import renditions

    content = json.loads((out / "specifications.json").read_text())
    entries = []
    for spec in content["scenes"]:
        paths = {version: out / f"{spec['id']}_{version}.npz" for version in VERSIONS}
        if not all(path.exists() for path in paths.values()):
            continue
        (picture,) = spec["pictures"]
        gains, linear, settings = None, {}, picture["camera"]
        quality = [cv2.IMWRITE_JPEG_QUALITY, settings["jpeg_quality"]]
        for number, (version, path) in enumerate(paths.items()):
            raw = dict(np.load(path))
            linear[version], on_ground = mixed(spec, picture, raw)
            own = settings | {"seed": settings["seed"] + number}
            image, gains = photographed(linear[version], on_ground, own, gains)
            if version == "bare":
                found = masks(spec, picture["lights"], raw)
                body, seen_ratio = caster_hull(spec, raw), ratio_seen(image, raw["index"], found)
            cv2.imwrite(str(out / f"{spec['id']}_{version}.jpg"), image, quality)
            if version == "model":
                cv2.imwrite(str(out / f"{spec['id']}_mask.png"), np.uint8(raw["index"] == MODEL_INDEX) * 255)
        assert gains is not None
        for name, image, jpeg in renditions(linear, on_ground, settings, gains):
            cv2.imwrite(str(out / f"{spec['id']}_{name}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, jpeg])
        for version in ("bare", "model"):
            exposed = np.float32(linear[version] * gains)[..., ::-1]
            cv2.imwrite(str(out / f"{spec['id']}_{version}_light.tiff"), exposed)
        (number,) = picture["lights"]
        light = spec["lights"][number]
        colour = np.asarray(light["colour"])
        sun = picture["gains"][0] * light["strength"] * colour / (colour @ LUMINANCE)
        around = radiance(spec["surroundings"])
        sky = np.asarray(irradiance(around))
        entries.append({
            "id": spec["id"], "ground": spec["ground"]["family"], "camera": settings["family"], "size": spec["size"],
            "K": spec["camera"]["K"], "R": spec["camera"]["R"], "t": spec["camera"]["t"],
            "marker_side_m": spec["marker"]["side_m"], "paper_side_m": spec["marker"]["paper_side_m"],
            "to_light": np.round(direction(light["azimuth_deg"], light["elevation_deg"]), 8).tolist(),
            "angular_diameter_deg": light["angular_diameter_deg"],
            "shadow_ratio": np.round(sky / (sky + sun) if seen_ratio is None else seen_ratio, 4).tolist(),
            "body_m": body, "white_rgb": (np.asarray(gains) * on_ground / math.pi).tolist(),
            "sky": (sky / on_ground).tolist(), "sky_slope": (slope(around) / on_ground).tolist(),
        })  # fmt: skip
        assert math.isclose(float(np.linalg.norm(entries[-1]["to_light"])), 1, abs_tol=1e-6)
    (out / "pairs.json").write_text(json.dumps({"model": content["model"], "pairs": entries}, indent=1) + "\n")


def caster_hull(spec: Params, raw: Params) -> list[list[float]]:
    """Points (n, 3) of the real object whose convex hull is about its own, metres, marker frame."""
    (number,) = (k for k, each in enumerate(spec["objects"]) if each["role"] == "caster")
    points = np.asarray(raw[f"points{number}"], np.float64)
    steps = np.arange(DIRECTIONS) + 0.5
    z = 1 - 2 * steps / DIRECTIONS
    turn = steps * math.pi * (3 - math.sqrt(5))
    around = np.column_stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z])
    return np.round(points[np.unique((around @ points.T).argmax(axis=1))], 5).tolist()


def ratio_seen(image: Any, index: Any, found: Params) -> Any:
    """(3,) of the real shadow in a photo, as an estimator would measure it there; None where too little of it is seen.

    Linear RGB of ground deep in the shadow over that of lit ground around it, medians.
    """
    import cv2

    from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
    from scenes.geometry.index import GROUND

    def depth(mask: Any) -> Any:
        return cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 3)

    ground, shadow = index == GROUND, found["shadow"]
    dark = ground & (depth(shadow & ground) > DEEP_PX)
    away = depth(~shadow)
    lit = ground & (away > DEEP_PX) & (away < BESIDE_PX) & (depth(ground) > DEEP_PX)
    if min(dark.sum(), lit.sum()) < FEWEST_PX:
        return None
    linear = LINEAR_FROM_SRGB_8BIT[image[..., ::-1]]
    return np.clip(np.median(linear[dark], axis=0) / np.median(linear[lit], axis=0), 0.02, 1.0)


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("stage", choices=("specify", "render", "develop"))
    ask.add_argument("--out", type=Path, required=True)
    ask.add_argument("--seed", type=int, help="specify other scenes than the twelve, drawn at random")
    ask.add_argument("--count", type=int, help="only the first so many scenes")
    ask.add_argument("--samples", type=int, default=SAMPLES)
    asked = ask.parse_args()
    if asked.stage == "specify":
        specify(asked.out, asked.seed)
    elif asked.stage == "render":
        render(asked.out, asked.count, asked.samples)
    else:
        develop(asked.out)


if __name__ == "__main__":
    main()
