"""Draws docs/materials.jpg: a ball of every kind of material on a frame of the shipped clip, under its true light.

    python material_sheet.py [--quality accurate] [--out ../../docs/materials.jpg]        needs ashe-live itself

Rows: steel, brass and red plastic from polished to matt; then normal maps on plastic and on metal, an emissive map,
glass (blended), a cut-out, and a map of metal and roughness.
"""

import argparse
import json
import math
from pathlib import Path

import cv2
import numpy as np

from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh, Model
from ashe_live.models.placement import PlacedModel
from ashe_live.quality import QUALITIES
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

FRAME, ENLARGED = 60, 3
RADIUS_SIDES, SPACING_SIDES = 0.14, 0.36
ROUGHNESSES = (0.0, 0.15, 0.3, 0.45, 0.7, 1.0)
TURNS, RINGS = 48, 24


def dents(size=256, waves=4):
    y, x = np.mgrid[:size, :size] * (2 * math.pi * waves / size)
    slope = 0.6 * np.stack([-np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)], -1)
    normal = np.dstack([slope, np.ones((size, size))])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return opaque(np.round(normal * 127 + 128))


def checks(one, other, size=64):
    y, x = np.mgrid[:size, :size] // (size // 4)
    return np.where(((x + y) % 2 == 0)[..., None], np.uint8(one), np.uint8(other))


def opaque(rgb):
    return np.dstack([rgb, np.full(rgb.shape[:2], 255)]).astype(np.uint8)


def rows():
    def series(colour, metallic):
        return [Material((*colour, 1.0), metallic=metallic, roughness=roughness) for roughness in ROUGHNESSES]

    dark, lit, clear = (30, 30, 30, 255), (255, 255, 255, 255), (0, 0, 0, 0)
    return [
        series((0.9, 0.9, 0.9), 1.0),
        series((0.8, 0.5, 0.1), 1.0),
        series((0.5, 0.03, 0.03), 0.0),
        [
            Material((0.2, 0.3, 0.7, 1.0), roughness=0.4, normal_map=dents()),
            Material((0.9, 0.6, 0.3, 1.0), metallic=1.0, roughness=0.25, normal_map=dents(), normal_scale=0.6),
            Material((0.1, 0.1, 0.1, 1.0), emissive=(0.0, 1.2, 0.9), emissive_map=checks(lit, dark)),
            Material((0.4, 0.7, 0.9, 0.35), roughness=0.05, alpha=Alpha.BLEND),
            Material(base_map=checks((60, 160, 60, 255), clear), roughness=0.6, alpha=Alpha.CUT_OUT),
            Material(metallic=1.0, metallic_roughness_map=checks((0, 20, 255, 255), (0, 180, 0, 255))),
        ],
    ]


def ball(centre, radius, material):
    v, u = np.meshgrid(np.linspace(0, 1, RINGS + 1), np.linspace(0, 1, TURNS + 1), indexing="ij")
    polar, around = math.pi * v, 2 * math.pi * u
    normals = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], -1)
    normals = normals.reshape(-1, 3).astype(np.float32)
    ring, turn = np.mgrid[:RINGS, :TURNS].reshape(2, -1)
    a = ring * (TURNS + 1) + turn
    b = a + TURNS + 1
    triangles = np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)])
    uvs = np.stack([4 * u, 1 - 2 * v], -1).reshape(-1, 2).astype(np.float32)
    return Mesh(normals * np.float32(radius) + np.float32(centre), normals, triangles, uvs=uvs, material=material)


def balls(side_m):
    radius, step = RADIUS_SIDES * side_m, SPACING_SIDES * side_m
    parts = [
        ball(((column - 2.5) * step, (1.5 - row) * step, radius), radius, material)
        for row, materials in enumerate(rows())
        for column, material in enumerate(materials)
    ]
    model = Model("materials", tuple(parts))
    return PlacedModel(model, model.bounds)


def enlarged_frame():
    """The clip's frame as a camera of more pixels would have taken it, with its true pose."""
    clip = shipped_clip()
    truth = json.loads(clip.path.with_suffix(".json").read_text())
    capture = cv2.VideoCapture(str(clip.path))
    capture.set(cv2.CAP_PROP_POS_FRAMES, FRAME)
    image = cv2.resize(capture.read()[1], None, fx=ENLARGED, fy=ENLARGED, interpolation=cv2.INTER_CUBIC)
    K = clip.camera.K.copy()
    K[:2] *= ENLARGED
    K[:2, 2] += (ENLARGED - 1) / 2
    camera = Camera((image.shape[1], image.shape[0]), K, clip.camera.dist, "file")
    pose = truth["frames"][FRAME]
    marker = MarkerPose(
        rigid(np.array(pose["R"]), np.array(pose["t"])), np.zeros((4, 2)), clip.marker_side_m, 0.0, None
    )
    ratio = np.array(truth["shading_ratio"]["measured"][0])
    size_rad = math.radians(truth["lights"][0]["angular_diameter_deg"])
    light = Light(clip.to_light_marker, angular_size_rad=size_rad, shadow_rgb_ratio=ratio)
    return TrackedFrame(Frame(image, FRAME, 0.0), camera, marker), light


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--quality", choices=QUALITIES, default="accurate")
    ask.add_argument("--out", type=Path, default=Path(__file__).resolve().parents[2] / "docs" / "materials.jpg")
    options = ask.parse_args()
    tracked, light = enlarged_frame()
    placed = balls(tracked.marker.side_m)
    renderer = SceneRenderer(offscreen_context(), QUALITIES[options.quality].render, tracked.frame.size)
    renderer.render(Scene(tracked, placed, Illumination((light,), seen_in=tracked)))
    (x0, y0), (x1, y1) = 1.35 * placed.bounds[:, :2]
    corners = project(tracked.camera, tracked.marker.T_cam_marker, [(x, y, 0) for x in (x0, x1) for y in (y0, y1)])
    (left, top), (right, bottom) = corners.min(axis=0).astype(int), corners.max(axis=0).astype(int)
    cv2.imwrite(str(options.out), renderer.read_bgr()[top:bottom, left:right], [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    main()
