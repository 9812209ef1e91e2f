"""What encoders take from weak colours beyond a camera's own blur of colours, on photos whose cameras are known.

    env/bin/python -m scenes.weak_colours SETS/training --every 4

Of what colours are found to be blurred beyond brightness (`render/camera/chroma_blur.py`, where the renderer looks for
it) denoising and half the resolution are known. The median of the rest, as variances, is WEAK_COLOURS_PX2.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from ashe_live.bench.cases import GROUND_TRUTH, read_cases
from ashe_live.render.camera.chroma_blur import chroma_blur_px
from ashe_live.render.camera.video_look import HALF_RESOLUTION_PX, around_print

SHARES = (10, 25, 50, 75, 90)  # percentiles that are printed


def variances_left(folder: Path, every: int) -> np.ndarray:
    """(n,) px²; the photos are JPEGs, which have colours at half the resolution."""
    truth = json.loads((folder / GROUND_TRUTH).read_text())
    denoised_px = {entry["id"]: entry["photo"]["chroma_denoise_px"] for entry in truth["scenes"]}
    left = []
    for case in read_cases(folder)[::every]:
        found = chroma_blur_px(around_print(case.tracked()))
        if found is not None:
            left.append(found**2 - denoised_px[case.id] ** 2 - HALF_RESOLUTION_PX**2)
    return np.array(left)


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("set", type=Path, help="a developed set of scenes")
    ask.add_argument("--every", type=int, default=1, help="of its photos every so many-th")
    asked = ask.parse_args()
    left = variances_left(asked.set, asked.every)
    print(f"{len(left)} photos with colour enough, px² beyond denoising and half the resolution:")
    print(
        ", ".join(f"{share} %: {value:.1f}" for share, value in zip(SHARES, np.percentile(left, SHARES), strict=True))
    )


if __name__ == "__main__":
    main()
