"""A folder of scenes as small as it can be: one picture of nothing, seen straight from above."""

import json
from pathlib import Path
from typing import Any


def scene(**changes: Any) -> dict[str, Any]:
    return {
        "id": "one",
        "image": "one.png",
        "size": [64, 48],
        "K": [[60, 0, 31.5], [0, 60, 23.5], [0, 0, 1]],
        "dist": [0, 0, 0, 0, 0],
        "R": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        "t": [0, 0, 1],
        "marker": {"side_m": 0.2, "corners_px": [[25.5, 17.5], [37.5, 17.5], [37.5, 29.5], [25.5, 29.5]]},
        "lights": [{"dir_to_light": [0, 0.6, 0.8]}],
    } | changes


def written(folder: Path, content: object) -> Path:
    """The folder, with this as its ground truth."""
    (folder / "ground_truth.json").write_text(json.dumps(content))
    return folder
