"""Pictures as they were when somebody looked at them; on the software rasteriser, which draws alike everywhere.

After a wanted change: `ASHE_LIVE_GOLDEN=write pytest tests/render/test_golden.py`, look at what changed, commit it.
"""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import placed_on_marker
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.scene import Scene

FOLDER = Path(__file__).parent / "golden"
SIZE = (240, 180)
LEVELS, OUTLIERS = 1, 0.005  # a share of the pixels may differ by more: edges that fall between two pixels
CUP = Proxy("cup", np.array([(-0.1, 0.03, 0.0, 0.03, 0.0), (-0.1, 0.03, 0.1, 0.04, 0.0)]))


def _scenes(stage) -> dict[str, Scene]:
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    stripes = (150 + 25 * np.sin(columns / 7 + rows / 19)).astype(np.uint8)
    image = np.stack([stripes - 40, stripes - 15, stripes], axis=-1)
    camera = stage.camera(SIZE).from_hfov(SIZE, 40)
    tracked = stage.tracked(image, stage.pose(-70, 40, 0.5), camera)
    sun, lamp = stage.light(20, 35, (0.25, 0.32, 0.42)), stage.light(140, 45, (0.75, 0.75, 0.75))
    sunny, two = Illumination((sun,), seen_in=tracked), Illumination((sun, lamp), real_object=CUP, seen_in=tracked)
    return {
        "mug-sun": Scene(tracked, placed_on_marker(load_model("mug"), 0.08), sunny),
        "tree-two-lights-cup": Scene(tracked, placed_on_marker(load_model("tree"), 0.08), two),
        "lantern-none": Scene(tracked, placed_on_marker(load_model("lantern"), 0.08), Illumination(seen_in=tracked)),
    }


@pytest.mark.parametrize("quality", [FAST, BALANCED], ids=lambda quality: quality.name)
@pytest.mark.parametrize("name", ["mug-sun", "tree-two-lights-cup", "lantern-none"])
def test_picture_is_the_one_that_was_looked_at(make_renderer, stage, name: str, quality) -> None:
    renderer = make_renderer(quality.render.offline, SIZE)  # as on a GPU
    if "llvmpipe" not in renderer.gl_renderer:
        pytest.skip("pictures are compared on the software rasteriser only")
    renderer.render(_scenes(stage)[name])
    picture = renderer.read_bgr()
    path = FOLDER / f"{name}-{quality.name}.png"
    if os.environ.get("ASHE_LIVE_GOLDEN") == "write":
        cv2.imwrite(str(path), picture, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    expected = cv2.imread(str(path)).astype(int)
    differs = np.abs(picture.astype(int) - expected).max(axis=2) > LEVELS
    assert differs.mean() <= OUTLIERS
