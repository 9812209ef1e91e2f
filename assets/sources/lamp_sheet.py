"""Draws docs/lamps.jpg: a mug under a sun, and under a lamp nearer and nearer; above ours, below the path tracer's.

    python render_reference.py --sheet --out /tmp/lamps --samples 16    # in Blender's environment
    python lamp_sheet.py /tmp/lamps [--out ../../docs/lamps.jpg]

Needs ashe_live and OpenGL. The lamp is as strong at the marker's centre wherever it is; each scene is that of a perfect
estimate.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

from ashe_live.bench.render.error import read_references
from ashe_live.quality import BALANCED
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer

LEFT, TOP, WIDTH, HEIGHT = 100, 60, 320, 250  # of the picture


def labelled(picture, text):
    cell = picture[TOP : TOP + HEIGHT, LEFT : LEFT + WIDTH].copy()
    cv2.putText(cell, text, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (255, 255, 255), 1, cv2.LINE_AA)
    return cell


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("references", type=Path)
    ask.add_argument("--out", type=Path, default=Path(__file__).resolve().parents[2] / "docs" / "lamps.jpg")
    asked = ask.parse_args()
    ctx = offscreen_context()
    columns = []
    for reference in read_references(asked.references):
        scene = reference.scene
        renderer = SceneRenderer(ctx, BALANCED.render, scene.tracked.frame.size)
        renderer.render(scene)
        ours = renderer.read_bgr()
        renderer.release()
        inverse = scene.illumination.light.inverse_distance
        label = f"lamp at {100 / inverse:.0f} cm" if inverse else "sun"
        columns.append(np.vstack([labelled(ours, label), labelled(reference.expected, f"{label}, path tracer")]))
    cv2.imwrite(str(asked.out), np.hstack(columns), [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    main()
