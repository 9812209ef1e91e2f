"""When the marker has stood still long enough."""

import numpy as np
import pytest

from ashe_live.core.types import MarkerPose
from ashe_live.tracking.poses.steadiness import Steadiness

SQUARE = np.array([(0, 0), (100, 0), (100, 100), (0, 100)], dtype=np.float64)


def seen(shift_px: float = 0.0, size: float = 1.0) -> MarkerPose:
    return MarkerPose(np.eye(4), SQUARE * size + shift_px, 1.0, 0.0, None)


def test_a_photo_is_steady_when_its_marker_is_found() -> None:
    assert not Steadiness.of(is_photo=True).add(None)
    assert Steadiness.of(is_photo=True).add(seen())
    assert not Steadiness.of(is_photo=False).add(seen())


def test_steady_only_after_enough_frames_in_a_row() -> None:
    steadiness = Steadiness(frames=3)
    assert [steadiness.add(marker) for marker in (seen(), seen(), None, seen(), seen(), seen(), seen())] == [
        False, False, False, False, False, True, True,
    ]  # fmt: skip


def test_motion_counts_in_proportion_to_the_marker() -> None:
    for size, is_steady in ((1.0, False), (10.0, True)):
        steadiness = Steadiness(frames=2)
        steadiness.add(seen(size=size))
        assert steadiness.add(seen(shift_px=10, size=size)) is is_steady


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
