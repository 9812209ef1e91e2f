"""Takes: read, tried with growing numbers of views, and grouped by their span."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ashe_live.bench.light.results import CaseResult
from ashe_live.bench.light.takes import (
    FOCAL_FACTOR,
    TakeResult,
    confidence_falls,
    grouped_by_span,
    nearest_span_deg,
    read_takes,
    spread_order,
    take_results,
)
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.errors import UserError
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from tests.light.painted_scenes import BOX, paint
from tests.light.synthetic_masks import camera_towards
from tests.tracking.conftest import picture

SIZE, FRAMES = (160, 120), 5


class Counting:
    """Answers straight up, and remembers how many views it was given."""

    name = "counting"

    def __init__(self) -> None:
        self.given: list[list[int]] = []

    def estimate(self, tracked, others=()):
        indices = (tracked.frame.index, *(other.frame.index for other in others))
        self.given.append(list(indices))
        light = Light(np.array([0.0, 0.0, 1.0]), None, 0.1, 0.9)
        return LightEstimate(self.name, indices[0], Illumination((light,)), timing_ms={"total": 1.0}, views=indices)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    poses = [camera_towards((0.06, 0.0), 0.5, 45.0, heading) for heading in np.linspace(80, 100, FRAMES)]
    painted = [paint(BOX, size=SIZE, T_cam_marker=pose).tracked for pose in poses]
    with Recorder(tmp_path / "take.mp4", SIZE, 6) as recorder:
        for index, tracked in enumerate(painted):
            recorder.write(tracked.frame.image_bgr, index / 6)
    take = {
        "id": "take",
        "category": "clean",
        "video": "take.mp4",
        "size": SIZE,
        "span_deg": 14.0,
        "K": painted[0].camera.K.tolist(),
        "marker": {"side_m": 0.08},
        "lights": [{"dir_to_light": [0.0, 0.6, 0.8], "lamp": {"position_m": [0.0, 0.3, 0.4], "radius_m": 0.02}}],
        "caster": {"type": "box", "base_xy_m": [0.12, 0.0]},
        "frames": [
            {
                "frame": index,
                "R": pose[:3, :3].tolist(),
                "t": pose[:3, 3].tolist(),
                "marker_corners_px": tracked.marker.corners_px.tolist(),
                "marker_detected": index != 3,
            }
            for index, (pose, tracked) in enumerate(zip(poses, painted, strict=True))
        ],
    }
    (tmp_path / "ground_truth.json").write_text(json.dumps({"takes": [take]}))
    return tmp_path


def test_a_take_has_its_frames_with_their_poses(folder: Path) -> None:
    (take,) = read_takes(folder)
    frames = take.frames()
    assert [tracked.frame.index for tracked in frames] == [0, 1, 2, 4]
    assert frames[0].marker is not None
    assert frames[0].marker.reprojection_rms_px == pytest.approx(0, abs=0.01)


def test_a_takes_lamp_and_its_objects_place_are_those_of_its_answers(folder: Path) -> None:
    (take,) = read_takes(folder)
    results = [each.result.lamp for each in take_results(take, {"balanced": Counting()})]
    for figures in results:
        assert figures is not None
        assert figures.true_distance_m == pytest.approx(0.5)
        assert not figures.is_stated
        assert figures.beside_deg is not None


def test_a_take_is_tracked_by_a_focal_length_that_is_not_quite_right(folder: Path) -> None:
    truth = json.loads((folder / "ground_truth.json").read_text())
    (take,), (first, *_) = read_takes(folder), truth["takes"]
    with pytest.raises(UserError, match="which marker take shows"):
        replace(take, is_tracked=True).frames()
    first["marker"] |= {"dictionary": "DICT_4X4_50", "id": 3}
    (folder / "ground_truth.json").write_text(json.dumps(truth))
    print_of = parse_marker("aruco:4x4_50:3")
    with Recorder(folder / "take.mp4", SIZE, 6, overwrite=True) as recorder:
        for index in range(FRAMES):
            pose = take.poses.get(index)
            blank = np.full((*SIZE[::-1], 3), 200, np.uint8)
            shown = blank if pose is None else picture(print_of, take.case.camera, pose.T_cam_marker, pose.side_m)
            recorder.write(shown, index / 6)
    (take,) = read_takes(folder)
    found = replace(take, is_tracked=True).frames()
    assert [tracked.frame.index for tracked in found] == [0, 1, 2, 4]
    for tracked in found:
        true = take.poses[tracked.frame.index].T_cam_marker
        assert tracked.marker is not None
        assert tracked.marker.covariance is not None
        assert tracked.camera.K[0, 0] == pytest.approx(FOCAL_FACTOR * take.case.camera.K[0, 0])
        assert tracked.camera.K[0, 2] == take.case.camera.K[0, 2]
        ratio = np.linalg.norm(tracked.marker.T_cam_marker[:3, 3]) / np.linalg.norm(true[:3, 3])
        assert ratio == pytest.approx(FOCAL_FACTOR, abs=0.02)
        alone = MarkerTracker(print_of, tracked.camera, tracked.marker.side_m, BALANCED).track(tracked.frame)
        assert alone.marker is not None
        np.testing.assert_array_equal(tracked.marker.T_cam_marker, alone.marker.T_cam_marker, "each by itself")


def test_a_take_whose_marker_is_never_seen_is_left_out(folder: Path) -> None:
    truth = json.loads((folder / "ground_truth.json").read_text())
    for frame in truth["takes"][0]["frames"]:
        frame["marker_detected"] = False
    (folder / "ground_truth.json").write_text(json.dumps(truth))
    assert read_takes(folder) == []


def test_each_number_of_views_holds_those_before_it(folder: Path) -> None:
    (take,) = read_takes(folder)
    estimator = Counting()
    results = list(take_results(take, {"balanced": estimator}))
    assert estimator.given == [[0], [0, 4], [0, 4, 1, 2]]
    assert [each.views for each in results] == [1, 2, 4]
    assert results[0].result.error_deg == pytest.approx(np.degrees(np.arccos(0.8)))
    few = replace(take, poses={index: take.poses[index] for index in (0, 1, 2)})
    assert [each.used for each in take_results(few, {"balanced": estimator})] == [1, 2], "no more than there are"


def test_a_list_that_is_none_is_said_to_be_none(tmp_path: Path) -> None:
    (tmp_path / "ground_truth.json").write_text('{"takes": [{"id": 3}]}')
    with pytest.raises(UserError, match="no list of takes"):
        read_takes(tmp_path)


@pytest.mark.parametrize("count", range(1, 13))
def test_the_order_is_one_of_all_frames_that_begins_with_the_ends(count: int) -> None:
    order = spread_order(count)
    assert sorted(order) == list(range(count))
    assert order[:2] == [0, count - 1][:count]


def test_spans_are_compared_by_ratio() -> None:
    assert [nearest_span_deg(span) for span in (0.0, 2.0, 4.0, 5.0, 17.0, 18.0, 90.0)] == [3, 3, 3, 6, 12, 25, 40]


def test_confidence_that_falls_for_a_right_answer_is_counted() -> None:
    def result(views: int, confidence: float | None, error_deg: float | None) -> TakeResult:
        answer = CaseResult(
            "fast", "set", "take", "clean", None, 1, ({},) if confidence else (), None, error_deg, None, None,
            confidence, None, None, None, {"total": 1.0}, 1.0, None,
        )  # fmt: skip
        return TakeResult(6.0, views, views, answer)

    rising = [result(1, 0.7, 2.0), result(2, 0.9, 1.0), result(4, 0.89, 1.0)]
    assert confidence_falls(rising) == (0, 2)
    assert confidence_falls([result(1, 0.7, 2.0), result(2, 0.6, 1.0), result(4, None, None)]) == (2, 2)
    assert confidence_falls([result(1, 0.7, 20.0), result(2, 0.6, 1.0)]) == (0, 0)
    assert list(grouped_by_span(rising)) == ["6°", "all"]
