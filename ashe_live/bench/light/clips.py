"""Clips under a fixed light: the spread of the estimates of many frames, about the truth or their mean."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ashe_live.bench.cases import ground_truth
from ashe_live.bench.metrics import angular_error_deg, rms_deg
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import KnownClip, read_known_clip
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import normalised
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.estimator import Estimator
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker

EVERY = 10  # frames
NEEDS = "`marker` and `clips`, and a clip's own JSON file a camera, a marker and a light"


@dataclass(frozen=True, slots=True)
class ClipResult:
    """The spread of one estimator's answers over a clip's frames."""

    preset: str
    clip: str
    about: str  # "truth" or "mean": the reference of the errors
    frames: int
    without_marker: int
    abstained: int
    rms_deg: float | None  # None: fewer than two answers
    max_deg: float | None


def read_clips(folder: Path) -> list[KnownClip]:
    """The clips that ground_truth.json lists under `clips`, and those with a JSON file of the same stem beside them.

    Raises UserError when a file cannot be read or a description is not valid.
    """
    with ground_truth(folder, "clips", NEEDS) as content:
        return [*_listed(folder, content), *_described(folder)]


def frames_of(clip: KnownClip, limit: int | None = None) -> list[TrackedFrame]:
    """Every EVERYth frame, at most `limit` of them, with the pose that the tracker finds (None: no marker)."""
    tracker = MarkerTracker(parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, BALANCED.tracking)
    tracked: list[TrackedFrame] = []
    with ClipSource(clip.path) as source:
        while (frame := source.read()) is not None and (limit is None or len(tracked) < limit):
            if frame.index % EVERY == 0:
                tracked.append(tracker.track(frame))
    return tracked


def estimate_clip(estimator: Estimator, preset: str, clip: KnownClip, frames: list[TrackedFrame]) -> ClipResult:
    """The spread of the estimates from `frames` of `clip` (`frames_of`)."""
    seen = [tracked for tracked in frames if tracked.marker is not None]
    answers = [light.to_light_marker for tracked in seen if (light := estimator.estimate(tracked).light) is not None]
    rms = worst = None
    if len(answers) > 1:
        centre = normalised(np.mean(answers, axis=0)) if clip.to_light_marker is None else clip.to_light_marker
        rms = rms_deg(answers, centre)
        worst = max(angular_error_deg(answer, centre) for answer in answers)
    return ClipResult(
        preset=preset,
        clip=clip.path.name,
        about="mean" if clip.to_light_marker is None else "truth",
        frames=len(frames),
        without_marker=len(frames) - len(seen),
        abstained=len(seen) - len(answers),
        rms_deg=rms,
        max_deg=worst,
    )


def _listed(folder: Path, content: dict[str, Any]) -> Iterator[KnownClip]:
    for file, clip in content.get("clips", {}).items():
        width, height = clip["size"]
        marker = content["marker"]
        light = clip.get("to_light_marker")
        yield KnownClip(
            folder / file,
            Camera.from_focal((width, height), clip["f_px"], "file"),
            f"pattern:{folder / marker['pattern_file']}",
            marker["side_units"],
            None if light is None else normalised(light),
        )


def _described(folder: Path) -> Iterator[KnownClip]:
    for path in sorted(folder.glob("*.mp4")):
        if (description := path.with_suffix(".json")).exists():
            yield read_known_clip(description)
