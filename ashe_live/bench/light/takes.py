"""Takes: short clips of an unmoved scene by a hand-held camera, with a known light. How much do more views gain?"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ashe_live.bench.cases import Case, ground_truth, rendered_case, rendered_pose, rendering_camera
from ashe_live.bench.light.results import CaseResult, case_result, timed_estimate
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.estimators.estimator import Estimator
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker

# With the tracker's poses, the focal length that it is given is so many times the true one, as by a phone's data sheet.
FOCAL_FACTOR = 1.01
VIEWS = (1, 2, 4, 8, 12)  # numbers of views that are tried, each set holding those before it
SPANS_DEG = (3.0, 6.0, 12.0, 25.0, 40.0)
FALL = 0.02  # least decrease of a confidence that counts as a fall


@dataclass(frozen=True, slots=True)
class Take:
    """A clip with the true pose of the marker in each of its frames, and the true light."""

    case: Case  # its picture is the clip, its marker the first one in view
    span_deg: float  # by how much the direction to the camera turns, seen from what it looks at
    poses: Mapping[int, MarkerPose]  # by frame; those without a marker are missing
    is_tracked: bool = False  # its frames have the tracker's own poses, with a focal length that is not quite right

    def frames(self) -> list[TrackedFrame]:
        """The frames with a marker, in order; raises UserError when the clip cannot be read."""
        with ClipSource(self.case.image_path) as source:
            read = [frame for frame in source if frame.index in self.poses]
        if self.is_tracked:
            return self._tracked(read)
        return [TrackedFrame(frame, self.case.camera, self.poses[frame.index]) for frame in read]

    def _tracked(self, frames: Sequence[Frame]) -> list[TrackedFrame]:
        """Those in which the tracker finds the marker, each by itself: a take has too few frames for its filter."""
        if self.case.marker_spec is None:
            raise UserError(f"{self.case.folder} does not say which marker {self.case.id} shows", "leave out --tracked")
        known = self.case.camera
        K = np.diag([FOCAL_FACTOR, FOCAL_FACTOR, 1.0]) @ known.K
        K[:2, 2] = known.K[:2, 2]
        camera = Camera(known.size, K, known.dist, "flag")
        marker = parse_marker(self.case.marker_spec)
        tracker = MarkerTracker(marker, camera, self.case.marker.side_m, BALANCED)
        found = []
        for frame in frames:
            tracker.reset()
            found.append(tracker.track(frame))
        return [each for each in found if each.marker is not None]

    def frames_by_spread(self) -> list[TrackedFrame]:
        """The frames in the order of `spread_order`, so that the first N are spread over the take."""
        frames = self.frames()
        return [frames[i] for i in spread_order(len(frames))]


@dataclass(frozen=True, slots=True)
class TakeResult:
    """The result of one preset on the first frame of a take, with others of its frames."""

    span_deg: float
    views: int  # number of views given to the estimator, the first frame included
    used: int  # number of views that the answer rests on
    result: CaseResult


def read_takes(folder: Path) -> list[Take]:
    """The takes that a folder's ground_truth.json lists, with a known light and a marker in view.

    Raises UserError when there is no such file, or it is no such list.
    """
    with ground_truth(folder, "takes", "`takes` with `frames`") as content:
        takes = [found for take in content.get("takes", ()) if (found := _take(folder, take)) is not None]
    return [take for take in takes if take.case.to_lights_marker is not None]


def take_results(take: Take, estimators: Mapping[str, Estimator]) -> Iterator[TakeResult]:
    """The results of each preset with growing numbers of views, which are spread evenly over the take."""
    frames = take.frames_by_spread()
    if not frames:
        return
    first, *others = frames
    counts = [count for count in VIEWS if count <= 1 + len(others)]
    for views in counts:
        for preset, estimator in estimators.items():
            estimate, cpu_ms = timed_estimate(estimator, first, others[: views - 1])
            result = case_result(preset, take.case, estimate, cpu_ms)
            yield TakeResult(take.span_deg, views, len(estimate.views), result)


def spread_order(count: int) -> list[int]:
    """The indices below `count`: the first, the last, then always the middle of the widest gap, the first of equals."""
    order = [0, count - 1][:count]
    while len(order) < count:
        taken = sorted(order)
        gaps = np.diff(taken)
        widest = int(gaps.argmax())
        order.append(taken[widest] + int(gaps[widest]) // 2)
    return order


def confidence_falls(results: Sequence[TakeResult]) -> tuple[int, int]:
    """Of the right answers with fewer views, how many are less sure (by FALL) or gone with the next number of views.

    Returns that number and the number of such steps. results: of one preset.
    """
    falls = steps = 0
    for case in dict.fromkeys((each.result.folder, each.result.case) for each in results):
        of_take = [each for each in results if (each.result.folder, each.result.case) == case]
        for fewer, more in pairwise(sorted(of_take, key=lambda each: each.views)):
            if fewer.result.is_good:
                steps += 1
                falls += (more.result.confidence or 0.0) < (fewer.result.confidence or 0.0) - FALL
    return falls, steps


def _take(folder: Path, take: dict[str, Any]) -> Take | None:
    """The take, or None where no frame shows the marker."""
    camera = rendering_camera(take)
    side_m = take["marker"]["side_m"]
    poses = {}
    for frame in take["frames"]:
        T_cam_marker, corners_px = rigid(frame["R"], frame["t"]), np.array(frame["marker_corners_px"], np.float64)
        if frame.get("marker_detected", True):
            poses[int(frame["frame"])] = rendered_pose(camera, T_cam_marker, corners_px, side_m)
    if not poses:
        return None
    case = rendered_case(folder, take, "video", camera, next(iter(poses.values())))
    return Take(case, float(take["span_deg"]), poses)


def grouped_by_span(results: Sequence[TakeResult]) -> dict[str, list[TakeResult]]:
    """The results by the take's span, each in the nearest of SPANS_DEG on a logarithmic scale; then all together."""
    groups: dict[str, list[TakeResult]] = {}
    for span in SPANS_DEG:
        members = [each for each in results if nearest_span_deg(each.span_deg) == span]
        if members:
            groups[f"{span:.0f}°"] = members
    return {**groups, "all": list(results)}


def nearest_span_deg(span_deg: float) -> float:
    """The entry of SPANS_DEG that a take's span is counted as."""
    return min(SPANS_DEG, key=lambda span: abs(np.log(span / max(span_deg, 1e-3))))
