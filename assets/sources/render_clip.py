"""Path-traces the demo clip: a paper cup and a printed marker on a sunlit wooden table.

Writes 16-bit linear PNGs (radiance / PNG_WHITE) and `truth.json`; `develop_clip.py` makes the video of them.
Needs `bpy` and `opencv-contrib-python-headless`. Frames that exist already are skipped.

    python render_clip.py --out /tmp/clip [--frames 0:168] [--samples 12] [--no-caster] [--irradiance]

World = marker frame: metres, origin at the marker's centre, x right and y up as printed, z out of the table.
"""

import argparse
import json
import math
from pathlib import Path

import bpy
import clip_scene as content
import numpy as np
from mathutils import Matrix

SEED = 20261
SIZE, FPS, FRAMES, HFOV = (640, 480), 24, 168, math.radians(55.0)
PNG_WHITE = 4.0  # radiance stored as full scale


def wobble(rng, amount, time):
    """Hand tremor: a seeded sum of sines of 0.3 to 2.6 Hz, amplitude falling with frequency."""
    rate, phase = np.geomspace(0.3, 2.6, 6), rng.uniform(0, 2 * math.pi, 6)
    return amount * float(np.sum(np.sin(2 * math.pi * rate * time + phase) / (1 + 2 * rate)))


def camera_pose(frame):
    """R, t with X_cam = R @ X_marker + t (OpenCV camera)."""
    rng, time, u = np.random.default_rng(SEED), frame / FPS, frame / (FRAMES - 1)
    eased = 0.35 * u + 0.65 * u * u * (3 - 2 * u)
    azimuth = math.radians(-117 + 55 * eased)
    pitch = math.radians(42.5 + 4.5 * math.sin(2 * math.pi * (0.9 * u + 0.05)))
    distance = 0.580 - 0.035 * math.sin(math.pi * u) + 0.012 * math.sin(2 * math.pi * (1.3 * u + 0.3))
    target = np.array([-0.104, 0.026, 0.018]) + [wobble(rng, 0.004, time) for _ in range(3)]
    away = np.array([math.cos(pitch) * math.cos(azimuth), math.cos(pitch) * math.sin(azimuth), math.sin(pitch)])
    eye = target + distance * away + [wobble(rng, 0.005, time) for _ in range(3)]
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    roll = math.radians(wobble(rng, 0.9, time))
    down = np.cross(forward, right)
    right, down = math.cos(roll) * right + math.sin(roll) * down, math.cos(roll) * down - math.sin(roll) * right
    rotation = np.stack([right, down, forward])
    return rotation, -rotation @ eye


def place_camera(camera, frame):
    rotation, t = camera_pose(frame)
    axes = rotation.T @ np.diag([1.0, -1.0, -1.0])  # Blender's camera looks along -z with y up
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes, -rotation.T @ t
    camera.matrix_world = Matrix(pose.tolist())


def truth(points):
    """The numbers that `develop_clip.py` needs beside the frames."""
    d = content.sun_direction()
    shadow = points - d * (points[:, 2:3] / d[2])
    k = (SIZE[0] / 2) / math.tan(HFOV / 2)
    return {
        "size": SIZE,
        "fps": FPS,
        "seed": SEED,
        "hfov_deg": math.degrees(HFOV),
        "png_white": PNG_WHITE,
        "K": [[k, 0, (SIZE[0] - 1) / 2], [0, k, (SIZE[1] - 1) / 2], [0, 0, 1]],
        "renderer": "Cycles",
        "renderer_version": bpy.app.version_string,
        "marker": {
            "dictionary": content.MARKER_DICTIONARY,
            "id": content.MARKER_ID,
            "side_m": content.MARKER_SIDE,
            "paper_side_m": content.PAPER_SIDE,
        },
        "light": {
            "dir_to_light": d.tolist(),
            "azimuth_deg": math.degrees(content.SUN_AZIMUTH),
            "elevation_deg": math.degrees(content.SUN_ELEVATION),
            "angular_diameter_deg": math.degrees(content.SUN_DIAMETER),
            "color": content.SUN_COLOUR,
        },
        "caster": {
            "base_xy_m": content.CUP_XY,
            "height_m": float(points[:, 2].max()),
            "bbox_min_m": points.min(0).tolist(),
            "bbox_max_m": points.max(0).tolist(),
            "top_m": points[points[:, 2].argmax()].tolist(),
            "shadow_tip_m": shadow[(shadow @ d).argmin()].tolist(),
            "profile_m": [(r, z + content.TABLE_Z) for r, z, _ in content.CUP],
        },
        "frames": [{"R": r.tolist(), "t": t.tolist()} for r, t in map(camera_pose, range(FRAMES))],
    }


def set_up(samples):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_light_tree = False
    scene.cycles.use_denoising, scene.cycles.denoiser = True, "OPENIMAGEDENOISE"
    scene.cycles.denoising_prefilter, scene.cycles.denoising_quality = "FAST", "BALANCED"
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces, scene.cycles.glossy_bounces = 4, 2, 2
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.render.use_persistent_data = True
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "PNG", "16"
    scene.render.image_settings.color_mode = "RGB"
    scene.view_settings.view_transform, scene.view_settings.exposure = "Raw", -math.log2(PNG_WHITE)
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle, lens.clip_start = "HORIZONTAL", HFOV, 0.01
    camera = bpy.data.objects.new("camera", lens)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene, camera


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--out", type=Path, required=True)
    ask.add_argument("--frames", default=f"0:{FRAMES}", help="A:B, or A:B:STEP")
    ask.add_argument("--samples", type=int, default=12)
    ask.add_argument("--no-caster", action="store_true", help="leave the cup out (to measure the shading ratio)")
    ask.add_argument(
        "--irradiance", action="store_true", help="white ground: sky_*.png without, all_*.png with the sun"
    )
    asked = ask.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    scene, camera = set_up(asked.samples)
    content.square("table", 5.0, content.TABLE_Z, content.wood())
    content.square("paper", content.PAPER_SIDE, 0.0, content.paper())
    caster, points = content.cup()
    content.lights()
    (asked.out / "truth.json").write_text(json.dumps(truth(points)))
    caster.hide_render = asked.no_caster or asked.irradiance
    for child in caster.children:
        child.hide_render = caster.hide_render
    variants = [""]
    if asked.irradiance:
        white, n = content.material("white")
        n("ShaderNodeOutputMaterial", n("ShaderNodeBsdfDiffuse", (1.0, 1.0, 1.0, 1.0)))
        for name in ("table", "paper"):
            bpy.data.objects[name].data.materials[0] = white
        variants = ["sky_", "all_"]
    for frame in range(FRAMES)[slice(*map(int, asked.frames.split(":")))]:
        for variant in variants:
            path = asked.out / f"{variant}{frame:04d}.png"
            if path.exists():
                continue
            bpy.data.objects["sun"].hide_render = variant == "sky_"
            scene.cycles.seed = SEED + frame
            place_camera(camera, frame)
            scene.render.filepath = str(asked.out / f"part_{path.name}")
            bpy.ops.render.render(write_still=True)
            Path(scene.render.filepath).rename(path)


if __name__ == "__main__":
    main()
