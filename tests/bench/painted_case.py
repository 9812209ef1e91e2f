"""A painted scene as a case of the benches, with its true masks."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.core.arrays import Float
from tests.light.painted_scenes import Painted


def painted_case(folder: Path, scene: Painted, to_lights_marker: Float, **more: Any) -> Case:
    """`scene` in files of `folder`, with the true directions (n, 3) of its lights; `more`: other fields of Case."""
    pictures = {"picture": scene.tracked.frame.image_bgr, "object": 255 * scene.body, "shadow": 255 * scene.shadow}
    for name, picture in pictures.items():
        cv2.imwrite(str(folder / f"{name}.png"), picture.astype(np.uint8))
    return Case(
        id="painted",
        folder="scenes",
        category="scene",
        caster=None,
        image_path=folder / "picture.png",
        camera=scene.tracked.camera,
        marker=scene.tracked.pose,
        to_lights_marker=to_lights_marker,
        mask_paths={name: folder / f"{name}.png" for name in ("object", "shadow")},
        **more,
    )
