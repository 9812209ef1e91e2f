"""By what exponent cameras' tones bend the ratio of two facets' light, on photos of the paper cube.

    env/bin/python -m scenes.tones SETS/cube

Each side's light over the level facet's is measured in the photo and in the same radiance without a camera's tones. The
exponents' root mean square beyond 1, each counted by the square of the ratio's logarithm, is TONES in
`light/known_body/sides/shading.py`.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ashe_live.bench.cases import GROUND_TRUTH
from ashe_live.bench.cube.pictures import Entry, traced_picture
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.types import Frame
from ashe_live.light.known_body.sides.facets import facets_of
from ashe_live.light.known_body.table import linear_picture
from ashe_live.light.pixels.view import View
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from scenes.develop import mixed

BLUR_PX = 0.6  # standard deviation of a plain camera's
BRIGHTEST, TOP = 0.9, 99.7  # linear value of this percentile of the plain picture: nothing is clipped
LEAST_PX = 20  # width of sides that blur leaves white
LEVEL = 0.99  # of a normal's z


def plain(spec: dict[str, Any], picture: dict[str, Any], entry: dict[str, Any], raw: Any) -> Any:
    """(h, w, 3) the picture by a camera without tones, B, G, R, with the photo's white balance."""
    light, _ = mixed(spec, picture, raw)
    light = cv2.GaussianBlur(light * np.array(entry["photo"]["gains"], np.float32), (0, 0), BLUR_PX)
    light = light * (BRIGHTEST / np.percentile(light, TOP))
    return np.ascontiguousarray(np.round(255 * srgb_from_linear(light.clip(0, 1)))[..., ::-1].astype(np.uint8))


def relative(view: View, body: Any) -> dict[tuple[float, ...], float]:
    """Logarithms of the sides' light over the level facet's, by normal; none where one of both is clipped or narrow."""
    facets = facets_of(view, body, linear_picture(view))
    is_level = facets.normals[:, 2] > LEVEL
    if not is_level.any() or facets.is_clipped[is_level].any():
        return {}
    light = np.log(facets.light_rgb.mean(axis=1))
    told = ~is_level & ~facets.is_clipped & (facets.width_px >= LEAST_PX)
    return {tuple(facets.normals[each]): float(light[each] - light[is_level][0]) for each in np.flatnonzero(told)}


def ratios(folder: Path) -> Iterator[tuple[str, float, float]]:
    """Camera, and the logarithm of a side's light over the level facet's in the photo and without tones."""
    specs = {each["id"]: each for each in json.loads((folder / "specifications.json").read_text())["scenes"]}
    for entry in json.loads((folder / GROUND_TRUTH).read_text())["scenes"]:
        photo, spec = traced_picture(Entry(folder, entry)), specs[entry["tags"]["render"]]
        tracker = MarkerTracker(cube_layout(), photo.camera, photo.edge_m, BALANCED.tracking)
        tracked = tracker.track(Frame(photo.image, 0, 0.0))
        if tracked.marker is None or tracked.marker.body is None:
            continue
        picture = next(each for each in spec["pictures"] if each["id"] == entry["id"])
        with np.load(folder / "radiance" / f"{spec['id']}.npz") as raw:
            frame = Frame(plain(spec, picture, entry, raw), 0, 0.0)
        width = photo.camera.size[0]
        shown, true = (
            relative(View.of(each, width), tracked.marker.body) for each in (tracked, replace(tracked, frame=frame))
        )
        yield from ((entry["photo"]["family"], shown[side], true[side]) for side in shown.keys() & true.keys())


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("sets", type=Path, nargs="+", help="rendered and developed sets of the paper cube")
    found = [each for folder in ask.parse_args().sets for each in ratios(folder)]
    for camera in (*sorted({each[0] for each in found}), None):
        shown, true = np.array([each[1:] for each in found if camera in (None, each[0])]).T
        bent = np.sqrt(((shown - true) ** 2).sum() / (true**2).sum())
        print(f"{camera or 'all'}: {len(true)} sides, exponents {bent:.2f} off")


if __name__ == "__main__":
    main()
