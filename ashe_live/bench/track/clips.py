"""Real clips without ground truth: how often the marker is found, whether its pose flips, and how much it jitters."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ashe_live.bench.cases import ground_truth
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, project
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker


@dataclass(frozen=True, slots=True)
class ClipFigures:
    """The tracker's figures on one clip."""

    name: str
    frames: int
    found_share: float
    bridged: int  # frames
    largest_turn_deg: float  # of the surface's normal, from one frame to the next
    jitter_in_motion_px: float  # see jitter_in_motion_px
    unfiltered_jitter_in_motion_px: float
    median_ms: float


def follow_clips(folder: Path, preset: TrackingPreset) -> list[ClipFigures]:
    """The figures of the clips listed in the folder's ground_truth.json. Raises UserError when that cannot be read."""
    with ground_truth(folder, "clips", "`marker` and `clips`") as content:
        marker, clips = content["marker"], content["clips"]
        return [
            _followed(folder / name, folder / marker["pattern_file"], marker["side_units"], clip["f_px"], preset)
            for name, clip in clips.items()
        ]


def jitter_in_motion_px(poses: Sequence[Float | None], camera: Camera, side_m: float) -> float:
    """Median second difference of the corners projected by the `poses` (4, 4) of a clip's frames, over sqrt(6).

    A hand's motion is nearly linear over three frames, whereas white noise has a second difference of sqrt(6) sigma.
    Frames without a pose, None, have no neighbours.
    """
    unseen = np.full((4, 2), np.nan)
    corners = np.array([unseen if T is None else project(camera, T, square_corners(side_m)) for T in poses])
    bends = np.linalg.norm(corners[2:] - 2 * corners[1:-1] + corners[:-2], axis=2) if len(corners) > 2 else np.empty(0)
    measured = bends[np.isfinite(bends)]
    return float(np.median(measured)) / math.sqrt(6) if len(measured) else 0.0


def largest_turn_deg(markers: Sequence[MarkerPose | None]) -> float:
    """The largest turn of the surface's normal from one frame of a clip to the next; None where it is not found."""
    pairs = ((a, b) for a, b in pairwise(markers) if a is not None and b is not None)
    turns = [angle_between(a.T_cam_marker[:3, 2], b.T_cam_marker[:3, 2]) for a, b in pairs]
    return math.degrees(max(turns, default=0.0))


def _followed(path: Path, pattern: Path, side_m: float, focal_px: float, preset: TrackingPreset) -> ClipFigures:
    markers: list[MarkerPose | None] = []
    times_ms = []
    with ClipSource(path) as source:
        camera = Camera.from_focal(source.size, focal_px)
        tracker = MarkerTracker(parse_marker(f"pattern:{pattern}"), camera, side_m, preset)
        while (frame := source.read()) is not None:
            tracked = tracker.track(frame)
            markers.append(tracked.marker)
            times_ms.append(tracked.detect_ms)
    found = [marker for marker in markers if marker is not None]
    return ClipFigures(
        name=path.name,
        frames=len(markers),
        found_share=len(found) / max(1, len(markers)),
        bridged=sum(marker.bridged for marker in found),
        largest_turn_deg=largest_turn_deg(markers),
        jitter_in_motion_px=jitter_in_motion_px(
            [None if marker is None else marker.T_cam_marker for marker in markers], camera, side_m
        ),
        unfiltered_jitter_in_motion_px=jitter_in_motion_px(
            [None if marker is None else marker.measured_T_cam_marker for marker in markers], camera, side_m
        ),
        median_ms=float(np.median(times_ms)) if times_ms else 0.0,
    )
