"""Path-traces the frames that rendering is compared with: the clip's table with and without a virtual model.

Writes to `../reference`, for each view and light `NAME.png` (8-bit sRGB, sharp and free of noise), `NAME_MODEL.png`
with the model standing on the marker, `NAME_MODEL_mask.png` (where it is seen), and `reference.json` (camera, lights,
the cup). Needs what `render_clip.py` needs. Frames that exist already are skipped.

    python render_reference.py [--out ../reference] [--samples 64]
"""

import argparse
import json
import math
from pathlib import Path

import bpy
import clip_scene as content
import numpy as np
from mathutils import Matrix, Vector
from render_clip import HFOV, PNG_WHITE, camera_pose, place_camera, set_up

HERE = Path(__file__).resolve().parent
SIZE = (480, 360)
EXPOSURE = 1.08  # as develop_clip.py's
FOOTPRINT_SIDES, HEIGHT_SIDES = 1.0, 1.2  # as ashe_live/models/placement.py
# Name: frame whose camera is taken, azimuth, elevation and diameter of the sun in degrees, models.
VIEWS = {
    "sun": (84, 17.0, 43.0, 0.53, ("cube", "mug", "tree")),
    "lamp": (40, 35.0, 50.0, 6.0, ("cube",)),
    "shaded": (84, 148.5, 24.0, 0.53, ("cube",)),  # the cup's shadow falls on the model
    "shading": (120, -31.5, 22.0, 0.53, ("cube",)),  # the model's shadow falls on the cup
}


def placed_model(name):
    """The objects of a shipped model, as the viewer places it on the marker."""
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(HERE.parent / "models" / f"{name}.glb"))
    made = [obj for obj in bpy.data.objects if obj not in before]
    meshes = [obj for obj in made if obj.type == "MESH"]
    bpy.context.view_layer.update()
    points = np.array([obj.matrix_world @ vertex.co for obj in meshes for vertex in obj.data.vertices])
    lower, upper = points.min(axis=0), points.max(axis=0)
    width, depth, height = upper - lower
    scale = content.MARKER_SIDE / max(width / FOOTPRINT_SIDES, depth / FOOTPRINT_SIDES, height / HEIGHT_SIDES)
    foot = Vector(((lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]))
    move = Matrix.Scale(scale, 4) @ Matrix.Translation(-foot)
    for obj in made:
        if obj.parent is None:
            obj.matrix_world = move @ obj.matrix_world
    return made


def render_linear(scene, path, samples, transparent=False):
    """(h, w, 4) radiance and coverage."""
    scene.cycles.samples, scene.render.film_transparent = samples, transparent
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = np.array(image.pixels[:]).reshape(*SIZE[::-1], 4)
    bpy.data.images.remove(image)
    path.unlink()
    return values * (PNG_WHITE, PNG_WHITE, PNG_WHITE, 1.0)


def write_png(path, rows_up):
    """(h, w) or (h, w, 3) in [0, 1], the bottom row first, as 8 bits."""
    import cv2

    levels = np.round(np.clip(rows_up[::-1], 0, 1) * 255).astype(np.uint8)
    cv2.imwrite(str(path), levels[..., ::-1] if levels.ndim == 3 else levels, [cv2.IMWRITE_PNG_COMPRESSION, 9])


def photo(linear):
    signal = np.clip(linear[..., :3] * EXPOSURE, 0, 1)
    return np.where(signal <= 0.0031308, 12.92 * signal, 1.055 * signal ** (1 / 2.4) - 0.055)


def render_view(name, out, samples):
    frame, azimuth, elevation, diameter, models = VIEWS[name]
    content.SUN_AZIMUTH, content.SUN_ELEVATION = math.radians(azimuth), math.radians(elevation)
    content.SUN_DIAMETER = math.radians(diameter)
    scene, camera = set_up(samples)
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    content.square("table", 5.0, content.TABLE_Z, content.wood())
    content.square("paper", content.PAPER_SIDE, 0.0, content.paper())
    content.cup()
    content.lights()
    place_camera(camera, frame)
    real = [obj for obj in bpy.data.objects if obj.type == "MESH"]
    part = out / f"part_{name}.png"
    if not (out / f"{name}.png").exists():
        write_png(out / f"{name}.png", photo(render_linear(scene, part, samples)))
    for model in models:
        if (out / f"{name}_{model}_mask.png").exists():
            continue
        virtual = placed_model(model)
        write_png(out / f"{name}_{model}.png", photo(render_linear(scene, part, samples)))
        for obj in real:
            obj.is_holdout = True
        write_png(out / f"{name}_{model}_mask.png", render_linear(scene, part, 8, transparent=True)[..., 3])
        for obj in real:
            obj.is_holdout = False
        for obj in virtual:
            bpy.data.objects.remove(obj)
    return view_record(name)


def view_record(name):
    frame, azimuth, elevation, diameter, models = VIEWS[name]
    clip = json.loads((HERE.parent / "clips" / "table.json").read_text())
    sun = np.array(clip["lights"][0]["irradiance_perpendicular"]) * math.sin(math.radians(elevation))
    sky = np.array(clip["ambient"]["irradiance_ground"])
    k = (SIZE[0] / 2) / math.tan(HFOV / 2)
    rotation, translation = camera_pose(frame)
    return {
        "name": name,
        "models": list(models),
        "size": SIZE,
        "K": [[k, 0, (SIZE[0] - 1) / 2], [0, k, (SIZE[1] - 1) / 2], [0, 0, 1]],
        "R": rotation.tolist(),
        "t": translation.tolist(),
        "marker_side_m": content.MARKER_SIDE,
        "azimuth_deg": azimuth,
        "elevation_deg": elevation,
        "angular_diameter_deg": diameter,
        "shadow_ratio": np.round(sky / (sky + sun), 4).tolist(),
        "caster": {
            "base_xy_m": content.CUP_XY,
            "profile_m": [(radius, height + content.TABLE_Z) for radius, height, _ in content.CUP],
        },
    }


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--out", type=Path, default=HERE.parent / "reference")
    ask.add_argument("--samples", type=int, default=64)
    asked = ask.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    views = [render_view(name, asked.out, asked.samples) for name in VIEWS]
    (asked.out / "reference.json").write_text(json.dumps({"views": views}, indent=1) + "\n")


if __name__ == "__main__":
    main()
