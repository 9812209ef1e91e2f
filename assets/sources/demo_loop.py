"""Draws docs/demo.webp, the README's moving picture: the shipped clip, its light estimated, one model after another.

    python demo_loop.py [--out ../../docs/demo.webp]

Needs ashe_live and OpenGL; half a minute of one core. It shows what the viewer shows; the captions are its own.
"""

import argparse
from pathlib import Path

import cv2
from PIL import Image

import ashe_live as al
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import placed_on_marker
from ashe_live.quality import QUALITIES
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.hud import Hud, HudText
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.render.screen import Screen
from ashe_live.viewer.estimates.easing import LightEasing

SIZE = (480, 360)
EVERY = 2  # frames of the clip
ESTIMATED_AT_S, ARROW_UNTIL_S = 1.5, 3.2
MODELS = ((0.0, "mug"), (3.2, "goblet"), (4.2, "lantern"), (5.2, "tree"), (6.2, "cube"))
CAPTIONS = (
    (0.0, "a virtual mug beside a real cup: its light is not known yet"),
    (ESTIMATED_AT_S, "Space: the light, estimated from this one frame"),
    (ARROW_UNTIL_S, "1 to 9: other models in the same light"),
)
LETTERS = 1.15
WEBP = {"quality": 80, "method": 6, "minimize_size": True, "loop": 0}


def latest(table, time_s):
    return [entry[1] for entry in table if entry[0] <= time_s][-1]


def pictures():
    """PIL images, and the clip's frame rate."""
    clip = shipped_clip()
    tracker = al.Tracker(clip.camera, clip.marker_spec, clip.marker_side_m)
    estimator, easing, hud = al.make_estimator("proxy"), LightEasing(), Hud()
    renderer = SceneRenderer(offscreen_context(), QUALITIES["accurate"].render, SIZE)
    placed = {name: placed_on_marker(load_model(name), clip.marker_side_m) for _, name in MODELS}
    illumination, is_estimated = al.Illumination(), False
    with ClipSource(clip.path) as source:
        while (frame := source.read()) is not None:
            tracked = tracker.track(frame.image_bgr, frame.time_s)
            if illumination.seen_in is None:
                illumination = al.Illumination(seen_in=tracked)
            if not is_estimated and frame.time_s >= ESTIMATED_AT_S:
                illumination, is_estimated = estimator.estimate(tracked).illumination.as_seen_in(tracked), True
            if frame.index % EVERY:
                continue
            scene = Scene(
                tracked,
                placed[latest(MODELS, frame.time_s)],
                easing.at(illumination, frame.time_s),
                shows_light=frame.time_s < ARROW_UNTIL_S,
                covers_marker=is_estimated,
                overlays=hud.overlays(HudText(hint=(latest(CAPTIONS, frame.time_s),)), Screen(SIZE, LETTERS)),
            )
            renderer.render(scene)
            yield Image.fromarray(cv2.cvtColor(renderer.read_bgr(), cv2.COLOR_BGR2RGB))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "docs" / "demo.webp")
    options = parser.parse_args()
    first, *others = pictures()
    with ClipSource(shipped_clip().path) as source:
        period_ms = round(1000 * EVERY / source.fps)
    first.save(options.out, save_all=True, append_images=others, duration=period_ms, **WEBP)
    print(f"{options.out}: {1 + len(others)} pictures, {options.out.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
