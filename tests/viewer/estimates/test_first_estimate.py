"""When the light is estimated without a request: once, and not before the marker is steady or the frame is there."""

from collections.abc import Iterable

import numpy as np

from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate

POSE = MarkerPose(np.diag([1.0, -1, -1, 1]), np.array([(0.0, 0), (9, 0), (9, 9), (0, 9)]), 0.08, 0.1, None)


def frame(index: int, marker: MarkerPose | None = POSE) -> TrackedFrame:
    pixels = np.zeros((12, 16, 3), np.uint8)
    return TrackedFrame(Frame(pixels, index, index / 30), Camera.from_hfov((16, 12), 60), marker)


def due(first: FirstEstimate, indices: Iterable[int], is_done_when_due: bool = True) -> list[int]:
    found = []
    for index in indices:
        first.add(frame(index))
        if first.is_due_in(frame(index)):
            found.append(index)
            if is_done_when_due:
                first.done()
    return found


def test_it_is_made_of_the_first_frame_in_which_the_marker_is_steady_and_once() -> None:
    first = FirstEstimate(on_first_steady=True)
    assert first.awaits_steady
    (steady,) = due(first, range(100))
    assert steady > 0
    assert not first.awaits_steady
    assert Steadiness.of(is_photo=True).add(frame(0))
    assert due(FirstEstimate(Steadiness.of(is_photo=True), on_first_steady=True), range(3)) == [0]


def test_in_a_loop_that_is_never_steady_it_is_made_where_the_next_round_begins() -> None:
    never_steady = Steadiness(100)
    assert due(FirstEstimate(never_steady, on_first_steady=True), (0, 2, 5, 0, 2, 5, 0)) == [0]
    assert due(FirstEstimate(never_steady, at_frame=9), (0, 2, 5, 0, 2, 5, 0)) == []


def test_in_a_loop_it_is_made_of_no_frame_without_a_marker() -> None:
    first = FirstEstimate(Steadiness(100), on_first_steady=True)
    first.add(frame(5))
    begins_anew = frame(0, marker=None)
    first.add(begins_anew)
    assert not first.is_due_in(begins_anew)


def test_it_is_made_of_a_frame_with_a_number_or_of_the_next_one_that_was_tracked() -> None:
    first = FirstEstimate(on_first_steady=True, at_frame=7)
    assert not first.awaits_steady
    assert due(first, range(20)) == [7]
    assert due(FirstEstimate(at_frame=7), range(0, 20, 3)) == [9]


def test_unasked_there_is_none() -> None:
    first = FirstEstimate()
    assert not first.awaits_steady
    assert due(first, range(100)) == []
