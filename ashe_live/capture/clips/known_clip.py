"""Clips with a known camera and marker: the one that ships with the program, and others like it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ashe_live.core.arrays import Float, set_given_frozen
from ashe_live.core.camera import Camera
from ashe_live.files.reading import read_json
from ashe_live.files.resources import resource


@dataclass(frozen=True, slots=True)
class KnownClip:
    """A clip and the truth about it (assets/sources/README.md)."""

    path: Path
    camera: Camera
    marker_spec: str  # as --marker takes it
    marker_side_m: float
    to_light_marker: Float | None  # (3,) unit, towards the strongest light; None: unknown, but the same throughout

    def __post_init__(self) -> None:
        set_given_frozen(self, to_light_marker=(3,))


def read_known_clip(truth_path: Path) -> KnownClip:
    """The clip beside the JSON file `truth_path`, of the same name. Raises UserError where that cannot be read."""
    truth = read_json(truth_path)
    width, height = truth["size"]
    marker = truth["marker"]
    family = marker["dictionary"].removeprefix("DICT_").lower()
    return KnownClip(
        truth_path.with_suffix(".mp4"),
        Camera((width, height), np.array(truth["K"]), np.array(truth["dist"], dtype=np.float64), "file"),
        f"aruco:{family}:{marker['id']}",
        marker["side_m"],
        np.array(truth["lights"][0]["dir_to_light"]),
    )


def shipped_clip() -> KnownClip:
    """The clip that the demo plays."""
    return read_known_clip(resource("assets", "clips", "table.json"))
