"""Draws docs/rendering.jpg: every shipped model under several lights, in each preset, over a frame of the clip.

    python rendering_sheet.py [--out ../../docs/rendering.jpg]

Needs ashe_live and OpenGL. The lights that are not the clip's are invented; the cup's own shadow shows the clip's.
"""

import argparse
import json
import math
from pathlib import Path

import cv2
import numpy as np

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, rigid
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import placed_on_marker
from ashe_live.quality import QUALITIES
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

FRAME = 84
LEFT, TOP, WIDTH, HEIGHT = 150, 60, 440, 330  # of the frame
CELL = (220, 165)


def light(azimuth_deg, elevation_deg, ratio, size_deg=None):
    return Light(
        direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg)),
        angular_size_rad=None if size_deg is None else math.radians(size_deg),
        shadow_rgb_ratio=np.array(ratio),
    )


SKY = (0.23, 0.29, 0.39)
LIGHTS = {
    "the clip's sun": (light(17, 43, SKY),),
    "low, behind": (light(100, 12, SKY),),
    "overhead": (light(0, 90, SKY),),
    "lamp of 8 deg": (light(-40, 50, (0.4, 0.4, 0.4), 8.0),),
    "two": (light(17, 43, (0.6, 0.62, 0.65)), light(120, 35, (0.65, 0.65, 0.65), 4.0)),
    "onto the cup": (light(-31.5, 22, SKY),),
    "none": (),
}


def tracked_frame(clip):
    truth = json.loads(clip.path.with_suffix(".json").read_text())
    entry, caster = truth["frames"][FRAME], truth["caster"]
    with ClipSource(clip.path) as source:
        frames = (source.read() for _ in range(FRAME + 1))
        frame = list(frames)[-1]
    marker = MarkerPose(
        rigid(entry["R"], entry["t"]), np.array(entry["marker_corners_px"]), clip.marker_side_m, 0, None
    )
    discs = [(*caster["base_xy_m"], height, radius, 0.0) for radius, height in caster["profile_m"]]
    return TrackedFrame(frame, clip.camera, marker), Proxy("cup", np.array(discs))


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--out", type=Path, default=Path(__file__).resolve().parents[2] / "docs" / "rendering.jpg")
    asked = ask.parse_args()
    clip, ctx = shipped_clip(), offscreen_context()
    tracked, cup = tracked_frame(clip)
    models = {name: placed_on_marker(load_model(name), clip.marker_side_m) for name in model_names()}
    rows = []
    for quality in QUALITIES.values():
        renderer = SceneRenderer(ctx, quality.render, tracked.frame.size)
        for name, model in models.items():
            cells = []
            for label, lights in LIGHTS.items():
                renderer.render(Scene(tracked, model, Illumination(lights, real_object=cup, seen_in=tracked)))
                part = renderer.read_bgr()[TOP : TOP + HEIGHT, LEFT : LEFT + WIDTH]
                cell = cv2.resize(part, CELL, interpolation=cv2.INTER_AREA)
                text = f"{quality.name}: {name}, {label}"
                cv2.putText(cell, text, (4, 12), cv2.FONT_HERSHEY_SIMPLEX, 0.32, (255, 255, 255), 1, cv2.LINE_AA)
                cells.append(cell)
            rows.append(np.hstack(cells))
        renderer.release()
    cv2.imwrite(str(asked.out), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 82])


if __name__ == "__main__":
    main()
