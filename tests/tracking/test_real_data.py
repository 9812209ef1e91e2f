"""Photos, clips and renders with known corners or poses, where the checkout has them beside it."""

import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.types import TrackedFrame
from ashe_live.quality import BALANCED, FAST
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal_tracker import FocalTracker
from ashe_live.tracking.tracker import MarkerTracker
from tests.shared_data import SHARED
from tests.tracking.conftest import frame

REAL, PAPER, SCENES = SHARED / "real", SHARED / "paper_scenes", SHARED / "scenes"
KANJI, HIRO = f"pattern:{REAL / 'kanji.patt'}", f"pattern:{REAL / 'hiro.patt'}"

pytestmark = pytest.mark.skipif(not (SHARED / "real").exists(), reason="no pictures in shared/ beside the checkout")


def read(folder: Path) -> Any:
    return json.loads((folder / "ground_truth.json").read_text(encoding="utf-8"))


def track_picture(path: Path, spec: str, camera: Camera, side_m: float = 1.0) -> TrackedFrame:
    image = cv2.imread(str(path))
    assert image is not None
    return MarkerTracker(parse_marker(spec), camera, side_m, BALANCED.tracking).track(frame(image))


def test_the_photos_corners() -> None:
    photos = read(REAL)["photos"]
    misses = []
    for name, given in photos.items():
        camera = Camera.from_focal(tuple(given["size"]), given["f_px"])
        marker = track_picture(REAL / name, KANJI, camera).marker
        assert marker is not None, name
        misses.append(np.linalg.norm(marker.corners_px - given["corners_px"], axis=1))
        assert track_picture(REAL / name, HIRO, camera).marker is None, name
    assert np.median(misses) < 0.6


# Both were filmed from a hand, looking down at the ground: its normal points up in the picture.
@pytest.mark.parametrize(("name", "focal_px"), [("vid_12.mp4", 1663), ("vid_5.mp4", 735)])
def test_the_clips_are_followed_without_a_flip(name: str, focal_px: float) -> None:
    clip = cv2.VideoCapture(str(REAL / name))
    size = (round(clip.get(cv2.CAP_PROP_FRAME_WIDTH)), round(clip.get(cv2.CAP_PROP_FRAME_HEIGHT)))
    tracker = MarkerTracker(parse_marker(KANJI), Camera.from_focal(size, focal_px), 1.0, FAST.tracking)
    normals, frames, _ = _followed(tracker, clip)
    assert frames > 70
    assert len(normals) >= 0.97 * frames
    cosines = np.einsum("ij,ij->i", normals[1:], normals[:-1]).clip(-1, 1)
    assert np.degrees(np.arccos(cosines)).max() < 5
    assert max(normal[1] for normal in normals) < 0


@pytest.mark.parametrize(
    ("name", "focal_px", "hfov_deg"),
    [("vid_12.mp4", 1663, 50), ("vid_12.mp4", 1663, 60), ("vid_12.mp4", 1663, 75), ("vid_5.mp4", 735, 60)],
)
def test_nor_where_the_focal_length_is_learned_from_paper_that_curls(
    name: str, focal_px: float, hfov_deg: float
) -> None:
    """The curl passes for the perspective of a pose mirrored in depth, with a focal length of 0.6 of the true one."""
    tracker = FocalTracker(
        parse_marker(KANJI), lambda size: Camera.from_hfov(size, hfov_deg, "assumed"), 1.0, FAST.tracking
    )
    clip = cv2.VideoCapture(str(REAL / name))
    normals, frames, learned = _followed(tracker, clip)
    assert len(normals) >= 0.97 * frames
    assert max(normal[1] for normal in normals) < 0
    assert learned.source == "estimated"
    assert learned.K[0, 0] == pytest.approx(focal_px, rel=0.2)  # known to 10 %


def _followed(tracker: MarkerTracker, clip: cv2.VideoCapture) -> tuple[list[Float], int, Camera]:
    """The table's normals (3,), camera frame, where a clip shows the marker; its number of frames; its last camera."""
    normals, frames = [], 0
    while (read_frame := clip.read())[0]:
        tracked = tracker.track(frame(np.asarray(read_frame[1], dtype=np.uint8), frames))
        if tracked.marker is not None:
            normals.append(tracked.marker.T_cam_marker[:3, 2])
        frames += 1
    return normals, frames, tracked.camera


def test_the_papers_scenes() -> None:
    for scene in read(PAPER)["scenes"]:
        camera = Camera(tuple(scene["size"]), np.array(scene["K"]), np.array(scene["dist"]), "file")
        path = PAPER / scene["image"]
        marker = track_picture(path, KANJI, camera, scene["marker"]["side_m"]).marker
        assert marker is not None, scene["id"]
        assert _turn_deg(marker.T_cam_marker[:3, :3], np.array(scene["R"])) < 0.2, scene["id"]
        assert track_picture(path, HIRO, camera).marker is None, scene["id"]


def test_the_rendered_scenes() -> None:
    turns = []
    for scene in read(SCENES)["scenes"]:
        given = scene["marker"]
        name = given["dictionary"].removeprefix("DICT_").lower()
        spec = f"apriltag:{name.removeprefix('apriltag_')}" if name.startswith("apriltag_") else f"aruco:{name}"
        camera = Camera(tuple(scene["size"]), np.array(scene["K"]), np.array(scene["dist"]), "file")
        marker = track_picture(SCENES / scene["image"], f"{spec}:{given['id']}", camera, given["side_m"]).marker
        assert marker is not None, scene["id"]
        turns.append(_turn_deg(marker.T_cam_marker[:3, :3], np.array(scene["R"])))
    assert np.median(turns) < 0.25
    assert max(turns) < 1.0


def _turn_deg(a: np.ndarray, b: np.ndarray) -> float:
    return math.degrees(2 * math.asin(min(1.0, float(np.linalg.norm(a - b)) / math.sqrt(8))))
