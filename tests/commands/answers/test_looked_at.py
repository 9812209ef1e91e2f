"""Which frame of a photo or clip is answered for, and how far a clip is read for it."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.capture.sources import Source
from ashe_live.commands.answers import looked_at
from ashe_live.commands.answers.looked_at import LEARNING_S, WATCHED_S, LookedAt, Wanted, look_at
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.tracking.focal_tracker import FocalTracker
from ashe_live.tracking.poses.steadiness import Steadiness

SIZE, FPS = (64, 48), 5.0
CAMERA, LEARNED = Camera.from_hfov(SIZE, 60), Camera.from_hfov(SIZE, 50)
PICTURE = np.full((SIZE[1], SIZE[0], 3), 128, np.uint8)
SIDE_M = 0.08
STEADY_AFTER = 4  # frames that follow the first of those that hardly differ


class Clip(Source):
    """So many frames, the last ones black; it notes which are read."""

    is_live, is_photo = False, False
    name, note, size, fps = "clip", None, SIZE, FPS
    path, duration_s = Path("clip.mp4"), None

    def __init__(self, count: int, black: int = 0) -> None:
        self.count, self.lit, self.next, self.read_indices = count, count - black, 0, []

    def read(self) -> Frame | None:
        if self.next >= self.count:
            return None
        self.read_indices.append(self.next)
        self.next += 1
        picture = PICTURE if self.next <= self.lit else np.zeros_like(PICTURE)
        return Frame(picture, self.next - 1, (self.next - 1) / FPS)

    def rewind(self) -> None:
        self.next = 0

    def seek(self, time_s: float) -> None:
        self.next = round(time_s * FPS)

    def seek_frame(self, index: int) -> None:
        self.next = index

    def pass_over(self, _is_shown: object) -> bool:
        return False

    def close(self) -> None:
        pass


class Photo(Clip):
    is_photo = True

    def __init__(self) -> None:
        super().__init__(1)


class Tracker:
    """Finds the marker from frame `seen` on; it moves until `still`. Its camera is another one from `learned` on."""

    def __init__(self, seen: int = 0, still: int = 0, learned: int = 999) -> None:
        self.seen, self.still, self.learned = seen, still, learned
        self.camera, self.last = CAMERA, -1

    def track(self, frame: Frame) -> TrackedFrame:
        assert frame.index > self.last, "where a clip begins again, the pose that was last seen says nothing"
        self.last = frame.index
        self.camera = LEARNED if frame.index >= self.learned else self.camera
        if frame.index < self.seen:
            return TrackedFrame(frame, CAMERA, None)
        aside_m = 0.02 * min(frame.index, self.still)
        T = rigid(cv2.Rodrigues(np.array([2.3, 0.0, 0.0]))[0], (aside_m - 0.1, 0.0, 0.6))
        marker = MarkerPose(T, project(CAMERA, T, square_corners(SIDE_M)), SIDE_M, 0.1, None)
        return TrackedFrame(frame, self.camera, marker)

    def reset(self) -> None:
        self.last = -1


class FocalLearner(Tracker, FocalTracker):
    is_sure = False


def looked(source: Source, tracker: Tracker, wanted: Wanted) -> LookedAt:
    return look_at(source, tracker, wanted)  # type: ignore[arg-type]


def test_it_is_the_first_frame_with_a_steady_marker_and_for_one_view_no_more_is_read() -> None:
    clip = Clip(60)
    found = looked(clip, Tracker(seen=3, still=10), Wanted(views=1))
    assert found.frozen.frame.index == 10 + STEADY_AFTER
    assert found.others == ()
    assert clip.read_indices == list(range(10 + STEADY_AFTER + 1))
    steadiness = Steadiness()
    assert [steadiness.add(Tracker().track(Frame(PICTURE, n, n / FPS))) for n in range(5)].index(True) == STEADY_AFTER


def test_without_a_steady_marker_it_is_the_first_with_a_marker_or_else_the_last_frame() -> None:
    assert looked(Clip(20), Tracker(seen=7, still=99), Wanted(views=1)).frozen.frame.index == 7
    assert looked(Clip(20), Tracker(seen=99), Wanted(views=1)).frozen.frame.index == 19
    assert looked(Photo(), Tracker(), Wanted(views=12)).frozen.frame.index == 0


def test_without_a_marker_it_is_no_black_frame_unless_all_are() -> None:
    """As where a clip fades out: its last picture does not tell why there is no marker in the others."""
    assert looked(Clip(20, black=5), Tracker(seen=99), Wanted(views=1)).frozen.frame.index == 14
    assert looked(Clip(20, black=20), Tracker(seen=99), Wanted(views=1)).frozen.frame.index == 19


def test_for_other_views_a_clip_is_watched_for_a_while_or_to_the_frame_that_is_named() -> None:
    clip = Clip(500)
    looked(clip, Tracker(), Wanted(views=4))
    assert clip.read_indices[-1] == STEADY_AFTER + WATCHED_S * FPS
    clip = Clip(500)
    looked(clip, Tracker(), Wanted(views=4, last=100))
    assert clip.read_indices[-1] == 100
    clip = Clip(500)
    looked(clip, Tracker(seen=999), Wanted(views=4, last=30))
    assert clip.read_indices[-1] == 30


def test_nothing_before_the_first_frame_that_is_named_is_read() -> None:
    clip = Clip(60)
    found = looked(clip, Tracker(), Wanted(views=1, first=20))
    assert found.frozen.frame.index == 20 + STEADY_AFTER
    assert clip.read_indices[0] == 20


def test_the_frame_that_is_named_is_taken_steady_or_not() -> None:
    clip = Clip(60)
    assert looked(clip, Tracker(still=99), Wanted(views=1, estimate_at=8)).frozen.frame.index == 8
    assert clip.read_indices[-1] == 8


@pytest.mark.parametrize(
    ("source", "wanted", "said", "remedy"),
    [
        (Clip(20), Wanted(1, estimate_at=20), "there is no frame 20", "from 0 to 19"),
        (Photo(), Wanted(1, estimate_at=2), "there is no frame 2", "it is a photo: leave --estimate-at out"),
        (Clip(20), Wanted(1, first=20), "there is no frame 20", "begin --frames between 0 and 19"),
        (Photo(), Wanted(1, first=1), "there is no frame 1", "it is a photo: leave --frames out"),
        (Clip(0), Wanted(1), "no readable picture", "copy or record it again"),
    ],
)
def test_a_frame_that_is_not_there_is_said(source: Source, wanted: Wanted, said: str, remedy: str) -> None:
    with pytest.raises(UserError, match=said) as caught:
        looked(source, Tracker(), wanted)
    assert remedy in caught.value.remedy


def test_a_frame_before_the_focal_length_was_learned_is_looked_at_again() -> None:
    frozen = looked(Clip(60), Tracker(learned=20), Wanted(views=2)).frozen
    assert frozen.frame.index == STEADY_AFTER
    assert frozen.camera is LEARNED


def test_a_clip_is_begun_again_for_its_focal_length_and_where_its_first_frame_shows_another_scene(monkeypatch) -> None:
    clip = Clip(500)
    assert looked(clip, FocalLearner(), Wanted(views=1)).frozen.frame.index == STEADY_AFTER
    assert clip.read_indices.index(0, 1) == LEARNING_S * FPS + 2, "it was read as far as it may help"

    usual = Tracker().track(Frame(PICTURE, 30, 30 / FPS))
    monkeypatch.setattr(looked_at, "first_of_most", lambda _: usual)
    assert looked(Clip(60), Tracker(), Wanted(views=3)).frozen.frame.index == 30
