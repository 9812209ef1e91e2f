"""Draws docs/guide.jpg: tables in light that works and in light that does not, with what the estimator says of each.

    python guide_pictures.py [--out ../../docs/guide.jpg]

Needs ashe_live and OpenGL; a minute of one core. The tables are painted, the things on them are the shipped models.
"""

import argparse
import math
import textwrap
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

import ashe_live as al
from ashe_live.commands.answers.light_page import picture_of
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import angle_between, direction_from_angles, project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.catalogue import load_model
from ashe_live.models.mesh import Model
from ashe_live.models.placement import PlacedModel, placed_on_marker
from ashe_live.quality import QUALITIES
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.families.markers import parse_marker

SIZE = (640, 480)
SIDE_M = 0.08
MARKER_PX = 400
SKY = np.array((0.30, 0.34, 0.42))
CELL = (480, 360)
CAPTION_PX = 66
LINE_CHARACTERS = 68
NOISE = 2.0
INK = (240, 240, 236)


@dataclass(frozen=True)
class Table:
    title: str
    azimuth_deg: float | None = 200.0  # None: light from everywhere
    elevation_deg: float = 42.0
    size_deg: float | None = 0.5
    model: str | None = "mug"
    at_m: tuple[float, float] = (0.13, 0.02)
    ground: str = "plain"
    eye_m: tuple[float, float, float] = (0.02, -0.48, 0.40)
    aim_m: tuple[float, float, float] = (0.06, 0.0, 0.0)


TABLES = (
    Table("good: one upright thing in the sun, all of its shadow on the table"),
    Table("good: a patterned table, as long as the shadow is seen on it", ground="planks"),
    Table("good: a lamp; its edge is soft, its middle is not", size_deg=6.0, model="lantern", azimuth_deg=160),
    Table("bad: an overcast sky or a white ceiling casts no shadow", azimuth_deg=None),
    Table("bad: nothing stands beside the marker", model=None),
    Table("bad: the shadow falls on the marker's sheet", azimuth_deg=10.0, at_m=(0.12, 0.0), elevation_deg=38),
    Table("bad: a low sun; the shadow leaves the picture", azimuth_deg=125.0, elevation_deg=12, at_m=(0.15, -0.03)),
    Table("bad: seen so low that the shadow is a line", eye_m=(0.05, -0.5, 0.08), aim_m=(0.07, 0.0, 0.02)),
)


def ground_texture(kind, xy):
    """(n, m, 3) linear RGB of the table at xy (n, m, 2) metres."""
    rng = np.random.default_rng(4)
    waves = rng.normal(size=(24, 2)) * 60
    phases = rng.uniform(0, 2 * np.pi, 24)
    mottle = np.cos(np.einsum("ijk,wk->ijw", xy, waves) + phases).mean(axis=2)
    base = np.array((0.42, 0.40, 0.37)) * (1 + 0.06 * mottle)[..., None]
    if kind == "planks":
        board = np.floor(xy[..., 1] / 0.07)
        tone = 0.85 + 0.15 * np.cos(board * 12.9) + 0.10 * np.cos(xy[..., 1] * 900 + 3 * mottle)
        seam = (np.abs(xy[..., 1] / 0.07 - np.round(xy[..., 1] / 0.07)) > 0.015) * 0.5 + 0.5
        base = np.array((0.46, 0.30, 0.17)) * (tone * seam * (1 + 0.1 * mottle))[..., None]
    return base


def photo(table, renderer):
    """(h, w, 3) uint8 BGR, and what the tracker would say of it."""
    camera = al.Camera.from_hfov(SIZE, 55)
    eye, aim = np.array(table.eye_m), np.array(table.aim_m)
    forward = (aim - eye) / np.linalg.norm(aim - eye)
    right = np.cross(forward, (0, 0, 1.0))
    right /= np.linalg.norm(right)
    R = np.array([right, np.cross(forward, right), forward])
    T = rigid(R, -R @ eye)

    fine = camera.resized((2 * SIZE[0], 2 * SIZE[1]))
    from_plane = fine.K @ T[:3, (0, 1, 3)]
    pixels = np.stack(np.meshgrid(*map(np.arange, fine.size)), axis=-1).astype(float)
    plane = np.concatenate([pixels, np.ones((*pixels.shape[:2], 1))], axis=2) @ np.linalg.inv(from_plane).T
    linear = ground_texture(table.ground, plane[..., :2] / plane[..., 2:])
    image = np.ascontiguousarray((255 * srgb_from_linear(linear.clip(0, 1)))[..., ::-1].astype(np.uint8))
    paper = cv2.copyMakeBorder(
        parse_marker("aruco:4x4_50:0").bitmap(MARKER_PX), *[MARKER_PX // 5] * 4, cv2.BORDER_CONSTANT, value=225
    )
    metres, centre = SIDE_M / MARKER_PX, (paper.shape[0] - 1) / 2
    from_paper = np.array([(metres, 0, -centre * metres), (0, -metres, centre * metres), (0, 0, 1)])
    cv2.warpPerspective(
        cv2.cvtColor(np.maximum(paper, 25), cv2.COLOR_GRAY2BGR),
        from_plane @ from_paper,
        fine.size,
        dst=image,
        flags=cv2.INTER_AREA,
        borderMode=cv2.BORDER_TRANSPARENT,
    )
    image = cv2.resize(image, SIZE, interpolation=cv2.INTER_AREA)

    half = SIDE_M / 2
    corners = project(camera, T, [(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    marker = MarkerPose(T, corners, SIDE_M, 0.02, None)
    tracked = TrackedFrame(Frame(image, 0, 0.0), camera, marker, 0.0)
    lights = ()
    if table.azimuth_deg is not None:
        towards = direction_from_angles(math.radians(table.azimuth_deg), math.radians(table.elevation_deg))
        size = None if table.size_deg is None else math.radians(table.size_deg)
        lights = (Light(towards, angular_size_rad=size, shadow_rgb_ratio=SKY),)
    if table.model is not None:
        placed = placed_on_marker(load_model(table.model), SIDE_M)
        offset = np.array((*table.at_m, 0.0))
        moved = Model(table.model, tuple(part.moved(1.0, offset) for part in placed.model.parts))
        illumination = Illumination(lights, seen_in=tracked)
        renderer.render(Scene(tracked, PlacedModel(moved, placed.bounds + offset), illumination))
        image = renderer.read_bgr()
    noise = np.random.default_rng(1).normal(0, NOISE, image.shape)
    return (image + noise).round().clip(0, 255).astype(np.uint8), camera, lights


def said(estimate, lights):
    if estimate.light is None:
        return f"“{estimate.reason}”"
    if not lights:
        return f"answered all the same, with a confidence of {estimate.light.confidence:.2f}"
    error = math.degrees(angle_between(estimate.light.to_light_marker, lights[0].to_light_marker))
    return (
        f"{error:.1f}° off, stated ± {math.degrees(estimate.light.sigma_rad):.1f}°, P {estimate.light.confidence:.2f}"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "docs" / "guide.jpg")
    options = parser.parse_args()
    renderer = SceneRenderer(offscreen_context(), QUALITIES["accurate"].render, SIZE)
    rows = (len(TABLES) + 1) // 2
    sheet = Image.new("RGB", (2 * CELL[0], rows * (CELL[1] + CAPTION_PX)), (22, 24, 28))
    draw = ImageDraw.Draw(sheet)
    for place, table in enumerate(TABLES):
        image, camera, lights = photo(table, renderer)
        tracked = al.Tracker(camera, side_m=SIDE_M).track(image)
        estimate = al.make_estimator("proxy").estimate(tracked)
        left, top = place % 2 * CELL[0], place // 2 * (CELL[1] + CAPTION_PX)
        picture = cv2.resize(picture_of(tracked, estimate), CELL, interpolation=cv2.INTER_AREA)
        sheet.paste(Image.fromarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)), (left, top))
        draw.text((left + 8, top + CELL[1] + 3), table.title, INK, ImageFont.load_default(15))
        answer = "\n".join(textwrap.wrap(said(estimate, lights), LINE_CHARACTERS))
        draw.text((left + 8, top + CELL[1] + 25), answer, INK, ImageFont.load_default(13))
        print(table.title, "|", said(estimate, lights))
    sheet.save(options.out, quality=85)
    print(f"{options.out}: {options.out.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
