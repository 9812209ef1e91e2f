"""A tracker that is told nothing about its camera: it learns, says so, and does not let go of the marker for it."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from ashe_live.bench.track.measures import turn_deg
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.dictionary_marker import DictionaryMarker
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal.focal import FocalEstimate
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.tracking.focal_tracker import VIEWS_ASKED, FocalTracker
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, Folds, frame_of, looking, sun
from tests.tracking.conftest import frame, picture, pose

CLIP = shipped_clip()
TRUTH_PX = CLIP.camera.K[0, 0]
WRONG_HFOV_DEG = 75.0


def tracker_with(memory: FocalMemory | None) -> FocalTracker:
    def assumed(size: tuple[int, int]) -> Camera:
        return Camera.from_hfov(size, WRONG_HFOV_DEG, "assumed")

    return FocalTracker(parse_marker(CLIP.marker_spec), assumed, CLIP.marker_side_m, BALANCED.tracking, memory)


def watched(tracker: FocalTracker) -> Iterator[TrackedFrame]:
    with ClipSource(CLIP.path) as source:
        while (frame := source.read()) is not None:
            yield tracker.track(frame)


@pytest.fixture(scope="module")
def frames() -> list[TrackedFrame]:
    """Of a run to which nothing is remembered."""
    return list(watched(tracker_with(None)))


@pytest.fixture(scope="module", params=[0.6, 1.5])
def zoomed(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[list[TrackedFrame], FocalMemory]:
    """Of a run to which the focal length from before the lens was zoomed is remembered; and what is, after it."""
    memory = FocalMemory("table", tmp_path_factory.mktemp("memory") / "focal_lengths.json")
    memory.keep(FocalEstimate(CLIP.camera.size, request.param * TRUTH_PX, 0.005 * TRUTH_PX, 60))
    return list(watched(tracker_with(memory))), memory


def test_the_first_view_determines_much_and_the_last_one_ends_with_what_is_true(frames: list[TrackedFrame]) -> None:
    assumed = Camera.from_hfov(CLIP.camera.size, WRONG_HFOV_DEG, "assumed")
    first, last = frames[0].camera, frames[-1].camera
    for camera in (first, last):
        assert camera.source == "estimated"
        assert abs(camera.K[0, 0] - TRUTH_PX) < 2.5 * camera.focal_sigma_px
    assert first.focal_sigma_px < assumed.focal_sigma_px / 2
    assert last.K[0, 0] == pytest.approx(TRUTH_PX, rel=0.03)


def test_the_camera_changes_seldom_and_the_model_stays_on_the_marker(zoomed) -> None:
    frames, _ = zoomed
    changes = [at for at in range(1, len(frames)) if frames[at].camera is not frames[at - 1].camera]
    assert 1 <= len(changes) <= 4
    for at in changes:
        tracked = frames[at]
        assert tracked.marker is not None
        drawn = project(tracked.camera, tracked.marker.T_cam_marker, square_corners(CLIP.marker_side_m))
        assert np.abs(drawn - tracked.marker.corners_px).max() < 1.0


def test_a_lens_that_was_zoomed_since_is_learned_anew_and_the_next_run_begins_with_that(zoomed) -> None:
    frames, memory = zoomed
    learned, first = frames[-1].camera, next(watched(tracker_with(memory))).camera
    assert learned.K[0, 0] == pytest.approx(TRUTH_PX, rel=0.05)
    assert first.source == "estimated"
    assert (first.K[0, 0], first.focal_sigma_px) == (learned.K[0, 0], learned.focal_sigma_px)


def test_several_views_are_believed_before_one_as_soon_as_they_are_surer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    size, tracker = CLIP.camera.size, tracker_with(None)
    for known, new, is_taken in (
        (FocalEstimate(size, 500.0, 60.0, 1), FocalEstimate(size, 700.0, 70.0, 12), True),
        (FocalEstimate(size, 500.0, 60.0, 12), FocalEstimate(size, 700.0, 70.0, 20), False),
        (FocalEstimate(size, 500.0, 60.0, 1), FocalEstimate(size, 700.0, 90.0, 12), False),
    ):
        monkeypatch.setattr(tracker, "_known", known)
        assert tracker._is_better(new, known.camera()) is is_taken


def test_several_views_are_believed_before_what_is_assumed_but_not_before_a_surer_photo() -> None:
    tracker, new = tracker_with(None), FocalEstimate(CLIP.camera.size, 700.0, 70.0, 12)
    assert tracker._is_better(new, Camera.from_focal(CLIP.camera.size, 500.0, "assumed"))
    assert not tracker._is_better(new, Camera.from_focal(CLIP.camera.size, 690.0, "exif"))


def test_what_is_known_well_is_left_alone(tmp_path: Path) -> None:
    memory = FocalMemory("table", tmp_path / "focal_lengths.json")
    memory.keep(FocalEstimate(CLIP.camera.size, 700.0, 2.0, 60))
    tracker = tracker_with(memory)
    assert {tracked.camera.K[0, 0] for tracked in watched(tracker)} == {700.0}
    assert tracker.is_sure


def test_frames_of_another_size_begin_anew() -> None:
    tracker = tracker_with(None)
    for size in ((640, 480), (320, 240), (480, 640)):
        camera = tracker.track(Frame(np.zeros((size[1], size[0], 3), np.uint8), 0, 0.0)).camera
        assert (camera.size, camera.source) == (size, "assumed")


def test_each_size_of_frames_is_asked_for_its_focal_length() -> None:
    """However many frames of other sizes were asked before, which may have said nothing."""
    tracker = tracker_with(None)
    marker, frontal, tilted = tracker.marker, pose(0.3, 0.0), pose(0.3, 50.0, 20.0)
    assert isinstance(marker, DictionaryMarker)
    for index in range(VIEWS_ASKED):
        tracker.track(frame(picture(marker, Camera.from_hfov((640, 480), 60.0), frontal, CLIP.marker_side_m), index))
    camera = Camera.from_hfov((800, 600), 60.0)
    found = tracker.track(frame(picture(marker, camera, tilted, CLIP.marker_side_m), VIEWS_ASKED)).camera
    assert found.source == "estimated"
    assert abs(found.K[0, 0] - camera.K[0, 0]) < 2.5 * found.focal_sigma_px


@pytest.mark.parametrize("assumed_over_true", [0.8, 1.25])
def test_a_cube_tells_the_focal_length_whatever_was_assumed(assumed_over_true: float) -> None:
    """Its folds are learned as well, and could be such that any focal length explains the picture."""
    true_px = CAMERA.K[0, 0]
    for seed in range(4):
        rng = np.random.default_rng(seed)
        T = looking(0.3, rng.uniform(35, 60), rng.uniform(0, 360))
        seen = frame_of(CubeScene(CAMERA, T, [sun(200, 40)], folds=Folds.drawn(rng, EDGE_M, 0.4e-3, 0.6)))

        def assumed(size: tuple[int, int]) -> Camera:
            return Camera.from_focal(size, assumed_over_true * true_px, "assumed")

        tracked = FocalTracker(cube_layout(), assumed, EDGE_M, BALANCED.tracking).track(seen)
        assert tracked.camera.source == "estimated"
        assert abs(tracked.camera.K[0, 0] - true_px) < 2.5 * tracked.camera.focal_sigma_px
        # Nor is anything left in the pose of the folds that the wrong focal length seemed to show.
        known = MarkerTracker(cube_layout(), tracked.camera, EDGE_M, BALANCED.tracking).track(seen)
        assert tracked.marker is not None
        assert known.marker is not None
        assert turn_deg(tracked.marker.T_cam_marker, known.marker.T_cam_marker) < 0.05
