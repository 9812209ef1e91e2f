"""A pair of photos on which nothing stands, as assets/sources/scenes/pairs.py writes them."""

import json
from pathlib import Path

import cv2
import numpy as np

from ashe_live.bench.render.pairs import Pair, read_pairs
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import direction_from_angles


def written_pair(folder: Path, T_cam_marker: Float) -> Pair:
    """A plain grey ground, on which nothing stands and no sheet lies."""
    size = (160, 120)
    K = Camera.from_hfov(size, 50.0).K
    picture = np.full((120, 160, 3), 140, np.uint8)
    for version in ("bare", "model", "open"):
        cv2.imwrite(str(folder / f"one_{version}.jpg"), picture)
    cv2.imwrite(str(folder / "one_mask.png"), np.zeros((120, 160), np.uint8))
    entry = {
        "id": "one", "ground": "plain", "camera": "plain", "size": size, "K": K.tolist(),
        "R": T_cam_marker[:3, :3].tolist(),
        "t": T_cam_marker[:3, 3].tolist(), "marker_side_m": 0.08, "paper_side_m": 0.1, "angular_diameter_deg": 0.5,
        "to_light": direction_from_angles(0.3, 0.8).tolist(), "shadow_ratio": [0.3, 0.3, 0.3],
        "body_m": [[5.0, 5.0, 0.0], [5.1, 5.0, 0.1], [5.0, 5.1, 0.1]],
        "white_rgb": [0.9, 0.9, 0.9], "sky": [0.2, 0.25, 0.3],
    }  # fmt: skip
    (folder / "pairs.json").write_text(json.dumps({"model": "cube", "pairs": [entry]}))
    (pair,) = read_pairs(folder)
    return pair
