"""Path-traces the frames that rendering is compared with: the clip's table with and without a virtual model.

Writes to `../reference`, for each view and light `NAME.png` (8-bit sRGB, sharp and free of noise), `NAME_MODEL.png`
with the model standing on the marker, `NAME_MODEL_mask.png` (where it is seen), and `reference.json` (camera, lights,
the cup). Needs what `render_clip.py` needs. Frames that exist already are skipped.

    python render_reference.py [--out ../reference] [--samples 64]
    python render_reference.py --sheet --out /tmp/lamps       # what lamp_sheet.py stands beside the renderer's
"""

import argparse
import json
import math
from dataclasses import dataclass
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
LAMP_IRRADIANCE = 2.4  # of a surface at the marker's centre that faces the lamp; the clip's sun has 3.6


@dataclass(frozen=True)
class View:
    """A camera, a sun or lamp, and what stands on the marker."""

    frame: int  # whose camera is taken
    azimuth_deg: float
    elevation_deg: float
    models: tuple[str, ...]
    diameter_deg: float = 0.53  # of a sun
    distance_m: float | None = None  # of a lamp from the marker's centre
    radius_m: float | None = None  # of a lamp


def lamp(frame, azimuth, elevation, models, distance=0.4, radius=0.01):
    return View(frame, azimuth, elevation, models, distance_m=distance, radius_m=radius)


VIEWS = {
    "sun": View(84, 17.0, 43.0, ("cube", "mug", "tree")),
    "lamp": View(40, 35.0, 50.0, ("cube",), 6.0),
    "shaded": View(84, 148.5, 24.0, ("cube",)),  # the cup's shadow falls on the model
    "shading": View(120, -31.5, 22.0, ("cube",)),  # the model's shadow falls on the cup
    "near": lamp(84, 17.0, 43.0, ("cube", "mug", "tree")),
    "near_soft": lamp(40, 35.0, 50.0, ("cube",), radius=0.03),
    "near_shaded": lamp(84, 148.5, 30.0, ("cube",)),
    "near_shading": lamp(120, -31.5, 28.0, ("cube",)),
}
SHEET = {
    "sheet_sun": View(84, 60.0, 40.0, ("mug",)),
    "sheet_100": lamp(84, 60.0, 40.0, ("mug",), 1.0, 0.02),
    "sheet_50": lamp(84, 60.0, 40.0, ("mug",), 0.5, 0.02),
    "sheet_25": lamp(84, 60.0, 40.0, ("mug",), 0.25, 0.02),
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


def lamp_instead_of_sun(view):
    """A ball that shines as strongly on the marker's centre, however far away it is."""
    bulb = bpy.data.lights.new("lamp", "POINT")
    bulb.energy = LAMP_IRRADIANCE * 4 * math.pi * view.distance_m**2
    bulb.color, bulb.shadow_soft_size, bulb.use_soft_falloff = content.SUN_COLOUR, view.radius_m, False
    obj = bpy.data.objects.new("lamp", bulb)
    obj.location = (content.sun_direction() * view.distance_m).tolist()
    obj.visible_camera = False
    bpy.context.scene.collection.objects.link(obj)
    bpy.data.objects["sun"].hide_render = True


def render_view(name, view, out, samples):
    content.SUN_AZIMUTH, content.SUN_ELEVATION = math.radians(view.azimuth_deg), math.radians(view.elevation_deg)
    content.SUN_DIAMETER = math.radians(view.diameter_deg)
    scene, camera = set_up(samples)
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    content.square("table", 5.0, content.TABLE_Z, content.wood())
    content.square("paper", content.PAPER_SIDE, 0.0, content.paper())
    content.cup()
    content.lights()
    if view.distance_m is not None:
        lamp_instead_of_sun(view)
    place_camera(camera, view.frame)
    real = [obj for obj in bpy.data.objects if obj.type == "MESH"]
    part = out / f"part_{name}.png"
    if not (out / f"{name}.png").exists():
        write_png(out / f"{name}.png", photo(render_linear(scene, part, samples)))
    for model in view.models:
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
    return view_record(name, view)


def view_record(name, view):
    clip = json.loads((HERE.parent / "clips" / "table.json").read_text())
    sun = np.array(clip["lights"][0]["irradiance_perpendicular"])
    if view.distance_m is not None:
        sun = LAMP_IRRADIANCE * np.array(content.SUN_COLOUR)
    sun *= math.sin(math.radians(view.elevation_deg))
    sky = np.array(clip["ambient"]["irradiance_ground"])
    k = (SIZE[0] / 2) / math.tan(HFOV / 2)
    rotation, translation = camera_pose(view.frame)
    return {
        "name": name,
        "models": list(view.models),
        "size": SIZE,
        "K": [[k, 0, (SIZE[0] - 1) / 2], [0, k, (SIZE[1] - 1) / 2], [0, 0, 1]],
        "R": rotation.tolist(),
        "t": translation.tolist(),
        "marker_side_m": content.MARKER_SIDE,
        "azimuth_deg": view.azimuth_deg,
        "elevation_deg": view.elevation_deg,
        "angular_diameter_deg": view.diameter_deg if view.distance_m is None else None,
        "distance_m": view.distance_m,
        "radius_m": view.radius_m,
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
    ask.add_argument("--sheet", action="store_true", help="a model under a sun, and under a lamp nearer and nearer")
    asked = ask.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    wanted = SHEET if asked.sheet else VIEWS
    views = [render_view(name, view, asked.out, asked.samples) for name, view in wanted.items()]
    (asked.out / "reference.json").write_text(json.dumps({"views": views}, indent=1) + "\n")


if __name__ == "__main__":
    main()
