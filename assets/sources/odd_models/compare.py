"""Are the models of make.py read as Blender has them? Silhouettes along three axes, of 128 pixels.

python compare.py DIR        in an environment with ashe-live
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

from ashe_live.errors import UserError
from ashe_live.models.loading import SUFFIXES, load_model_file
from ashe_live.models.mesh import Model

SIDE, SHARE = 128, 0.9  # of the picture that the model fills
LEAST_IOU = 0.97
BITS = 4  # of fractions of a pixel


def silhouettes(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(3, SIDE, SIDE) bool along z, y and x, the box around all corners in the middle."""
    corners = places[triangles].reshape(-1, 3)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    at = ((places - (lower + upper) / 2) / (upper - lower).max() * SHARE + 0.5) * SIDE
    pictures = np.zeros((3, SIDE, SIDE), np.uint8)
    for picture, axes in zip(pictures, ((0, 1), (0, 2), (1, 2)), strict=True):
        for triangle in np.round(at[:, axes] * 2**BITS).astype(np.int32)[triangles]:
            cv2.fillConvexPoly(picture, triangle, 1, shift=BITS)
    return pictures.astype(bool)


def of_model(model: Model) -> np.ndarray:
    firsts = np.cumsum([0, *(len(part.vertices) for part in model.parts)])[:-1]
    triangles = [part.triangles.astype(int) + first for part, first in zip(model.parts, firsts, strict=True)]
    return silhouettes(np.concatenate([part.vertices for part in model.parts]), np.concatenate(triangles))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    worst, guessed = [], []
    for truth in sorted(parser.parse_args().folder.glob("*.npz")):
        (path,) = (each for each in truth.parent.glob(f"{truth.stem}.*") if each.suffix in SUFFIXES)
        known = np.load(truth)
        is_gltf = path.suffix.startswith(".gl")
        try:
            model = load_model_file(path, None if is_gltf else str(known["up"]))
        except UserError as error:
            print(path.name, "refused:", error)
            worst.append(0.0)
            continue
        if not is_gltf:
            guessed.append(load_model_file(path).up == known["up"])
        true, read = silhouettes(known["places"], known["triangles"]), of_model(model)
        worst.append(float(((true & read).sum(axis=(1, 2)) / (true | read).sum(axis=(1, 2))).min()))
        if worst[-1] < LEAST_IOU:
            print(f"{path.name} {worst[-1]:.3f}", *model.notes)
    print(f"{len(worst)} models, {np.mean(np.array(worst) >= LEAST_IOU):.1%} with an IoU of {LEAST_IOU} from all sides")
    print(f"of {len(guessed)} without a stated up, turned at random, {np.mean(guessed):.0%} were guessed right")


if __name__ == "__main__":
    main()
