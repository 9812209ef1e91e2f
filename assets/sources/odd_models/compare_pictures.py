"""Are the models of make.py drawn as a path tracer draws them? The pictures of trace.py beside the renderer's.

python compare_pictures.py DIR [--sheet FILE.png]        in an environment with ashe-live
"""

import argparse
import json
from pathlib import Path

import cv2
import numpy as np

from ashe_live.bench.render.error import _light, colour_difference, read_picture
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.light import Illumination
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, raycast_to_plane, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.loading import SUFFIXES, load_model_file
from ashe_live.models.placement import placed_on_marker
from ashe_live.quality import BALANCED
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

MOST_DE = 8.0
FEWEST_PX = 30  # of a model within its outline: of less there is no mean


def stage(folder: Path) -> tuple[TrackedFrame, Illumination]:
    """The table without a model, in the true light, as a perfect estimate would give it."""
    view = json.loads((folder / "pictures.json").read_text(encoding="utf-8"))
    bare = read_picture(folder / "bare.png")
    camera = Camera(tuple(view["size"]), np.array(view["K"]), np.zeros(5), "file")
    T_cam_marker = rigid(view["R"], view["t"])
    side_m = view["marker_side_m"]
    marker = MarkerPose(T_cam_marker, project(camera, T_cam_marker, square_corners(side_m)), side_m, 0.0, None)
    pixels = np.stack(np.meshgrid(*map(np.arange, camera.size)), axis=-1).reshape(-1, 2)
    ground = raycast_to_plane(camera, T_cam_marker, pixels)[:, :2]
    beyond_sheet = np.abs(ground).max(axis=1) > side_m
    linear = LINEAR_FROM_SRGB_8BIT[bare[..., ::-1]].reshape(-1, 3)
    tracked = TrackedFrame(Frame(bare, 0, 0.0), camera, marker)
    ground_rgb = np.median(linear[beyond_sheet], axis=0)
    return tracked, Illumination((_light(view),), ground_rgb=ground_rgb, seen_in=tracked)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--sheet", type=Path, help="the pictures of both, the worst first")
    options = parser.parse_args()
    folder = options.folder
    tracked, lit = stage(folder)
    renderer = SceneRenderer(offscreen_context(), BALANCED.render, tracked.frame.size)
    compared = []
    for mask_path in sorted(folder.glob("*_mask.png")):
        name = mask_path.stem.removesuffix("_mask")
        (path,) = (each for each in folder.glob(f"{name}.*") if each.suffix in SUFFIXES)
        up = None if path.suffix.startswith(".gl") else str(np.load(folder / f"{name}.npz")["up"])
        model = load_model_file(path, up)
        renderer.render(Scene(tracked, placed_on_marker(model, tracked.marker.side_m), lit))
        ours, truth = renderer.read_bgr(), read_picture(folder / f"{name}.png")
        within = cv2.erode((read_picture(mask_path)[..., 0] > 127).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        if within.sum() >= FEWEST_PX:
            error = float(colour_difference(ours, truth)[within].mean())
            compared.append((error, path.name, "; ".join(model.notes), truth, ours))
    compared.sort(key=lambda each: -each[0])
    for error, name, notes, *_ in compared:
        print(f"{error:5.1f}  {name}  {notes}")
    errors = np.array([each[0] for each in compared])
    told = np.array([bool(each[2]) for each in compared])
    print(f"{len(errors)} models: mean dE {errors.mean():.1f}, median {np.median(errors):.1f}")
    drawn = errors <= MOST_DE
    print(
        f"{np.mean(drawn):.0%} have {MOST_DE:g} or less, {np.mean(drawn | told):.0%} that or a line on what is missing"
    )
    if options.sheet is not None:
        rows = [np.hstack([truth, ours]) for *_, truth, ours in compared]
        rows += [np.zeros_like(rows[0])] * (-len(rows) % 4)
        cv2.imwrite(str(options.sheet), np.vstack([np.hstack(rows[at : at + 4]) for at in range(0, len(rows), 4)]))


if __name__ == "__main__":
    main()
