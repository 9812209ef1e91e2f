"""When the marker has stood still long enough."""

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.tracking.poses.steadiness import Steadiness

SQUARE = np.array([(0, 0), (100, 0), (100, 100), (0, 100)], dtype=np.float64)


FRAME_S = 1 / 30


def seen(shift_px: float = 0.0, size: float = 1.0, time_s: float = 0.0) -> TrackedFrame:
    return _tracked(MarkerPose(np.eye(4), SQUARE * size + shift_px, 1.0, 0.0, None), time_s)


def _tracked(marker: MarkerPose | None, time_s: float = 0.0) -> TrackedFrame:
    camera = Camera.from_hfov((8, 8), 60)
    return TrackedFrame(Frame(np.zeros((8, 8, 3), np.uint8), 0, time_s), camera, marker)


UNSEEN = _tracked(None)


def test_a_photo_is_steady_when_its_marker_is_found() -> None:
    assert not Steadiness.of(is_photo=True).add(UNSEEN)
    assert Steadiness.of(is_photo=True).add(seen())
    assert not Steadiness.of(is_photo=False).add(seen())


def test_steady_only_after_enough_frames_in_a_row() -> None:
    steadiness = Steadiness(frames=3)
    assert [steadiness.add(frame) for frame in (seen(), seen(), UNSEEN, seen(), seen(), seen(), seen())] == [
        False, False, False, False, False, True, True,
    ]  # fmt: skip


def test_motion_counts_in_proportion_to_the_marker() -> None:
    for size, is_steady in ((1.0, False), (10.0, True)):
        steadiness = Steadiness(frames=2)
        steadiness.add(seen(size=size))
        assert steadiness.add(seen(shift_px=10, size=size, time_s=FRAME_S)) is is_steady


@pytest.mark.parametrize("fps", [12.0, 15.0, 30.0, 60.0])
@pytest.mark.parametrize(("sides_a_second", "is_steady"), [(1.5, True), (2.2, False)])
def test_motion_counts_alike_at_all_frame_rates(fps: float, sides_a_second: float, is_steady: bool) -> None:
    steadiness = Steadiness(frames=3)
    step_px = 100 * sides_a_second / fps / np.sqrt(2)
    assert [steadiness.add(seen(k * step_px, time_s=k / fps)) for k in range(3)] == [False, False, is_steady]


@pytest.mark.parametrize(("sides_a_frame", "is_steady"), [(0.13, True), (0.2, False)])
def test_frames_far_apart_may_be_exposed_for_as_long(sides_a_frame: float, is_steady: bool) -> None:
    steadiness = Steadiness(frames=2)
    steadiness.add(seen())
    assert steadiness.add(seen(100 * sides_a_frame / np.sqrt(2), time_s=0.5)) is is_steady


def test_frames_that_come_in_a_burst_are_no_fast_motion() -> None:
    steadiness = Steadiness(frames=2)
    steadiness.add(seen())
    assert steadiness.add(seen(shift_px=1, time_s=0.001))


def test_a_jump_starts_the_count_anew() -> None:
    steadiness = Steadiness(frames=2)
    assert [steadiness.add(seen(shift)) for shift in (0, 0, 500, 500)] == [False, True, False, True]


def test_reset_forgets() -> None:
    steadiness = Steadiness(frames=2)
    steadiness.add(seen())
    steadiness.reset()
    assert not steadiness.add(seen())
    assert not steadiness.is_steady


def test_no_frames_are_wrong_use() -> None:
    with pytest.raises(ValueError, match="none"):
        Steadiness(frames=0)


def test_a_marker_that_was_followed_and_not_read_is_not_steady() -> None:
    steadiness = Steadiness(frames=2)
    bridged = _tracked(MarkerPose(np.eye(4), SQUARE, 1.0, 0.0, None, bridged=True))
    assert [steadiness.add(frame) for frame in (seen(), bridged, seen(), seen())] == [False, False, False, True]


def test_the_time_that_counts_is_that_between_two_frames() -> None:
    """Late in a clip as at its beginning."""
    steadiness = Steadiness(frames=2)
    steadiness.add(seen(time_s=100.0))
    assert not steadiness.add(seen(shift_px=10, time_s=100.0 + FRAME_S))
