"""Which pictures a recording takes, and at which times."""

import numpy as np
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.errors import UserError
from ashe_live.viewer.output.recording import Recording, Slots

DISPLAY_HZ = 60.0


def times(slots: Slots, shown_s: list[float]) -> list[float | None]:
    return [slots.time_s(now_s, frame) for frame, now_s in enumerate(shown_s)]


@pytest.mark.parametrize("fps", [12.0, 24.0, 25.0, 30000 / 1001, 50.0, 60.0])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.7])
def test_a_clips_pictures_keep_its_own_even_times_whenever_the_display_shows_them(fps, phase):
    due_s = 100 + np.arange(500) / fps
    shown_s = np.ceil(due_s * DISPLAY_HZ + phase) / DISPLAY_HZ
    assert times(Slots(fps), shown_s.tolist()) == (np.arange(500) / fps).tolist()


def test_a_gap_in_the_source_is_a_gap_in_the_recording():
    found = times(Slots(10.0), [5.0, 5.1, 5.2, 7.2, 7.3])
    assert found == pytest.approx([0.0, 0.1, 0.2, 2.2, 2.3])


def test_while_paused_the_last_picture_fills_the_slots():
    slots = Slots(25.0)
    found = [slots.time_s(tick / DISPLAY_HZ, None) for tick in range(1, 601)]
    taken = [time_s for time_s in found if time_s is not None]
    assert taken == pytest.approx(np.arange(len(taken)) / 25)
    assert len(taken) == pytest.approx(250, abs=1)


def test_while_paused_a_slow_display_misses_no_picture():
    slots = Slots(25.0)
    found = [slots.time_s(tick / 10, 0 if tick == 0 else None) for tick in range(20)]
    assert None not in found
    assert slots.missed == 0


def test_of_a_source_faster_than_its_nominal_rate_pictures_are_left_out_and_time_is_kept():
    found = times(Slots(30.0), [n / 90 for n in range(900)])
    taken = [time_s for time_s in found if time_s is not None]
    assert taken == sorted(set(taken))
    assert taken[-1] == pytest.approx(10.0, abs=2 / 30)


def test_a_rate_that_is_a_little_off_never_runs_away():
    shown_s = np.arange(3000) / 29.0
    found = times(Slots(30.0), shown_s.tolist())
    assert None not in found
    assert np.abs(np.array(found, float) - shown_s).max() <= 1 / 30 + 1e-9


def test_the_recorded_clip_has_the_rate_and_every_picture_once(tmp_path):
    recording = Recording(tmp_path / "a.mp4", (64, 48), 24.0)
    for n in range(48):
        shown_s = np.ceil(n / 24 * DISPLAY_HZ) / DISPLAY_HZ
        recording.take(lambda n=n: np.full((48, 64, 3), 4 * n, np.uint8), n, 7.0 + shown_s)
    assert recording.finish() == recording.finish() == f"saved {tmp_path / 'a.mp4'} (48 frames)"
    with ClipSource(tmp_path / "a.mp4") as clip:
        assert clip.fps == pytest.approx(24)
        frames = list(clip)
    assert [frame.time_s for frame in frames] == pytest.approx(np.arange(48) / 24, abs=1e-4)
    assert [frame.image_bgr[0, 0, 0] // 4 for frame in frames] == pytest.approx(list(range(48)), abs=1)


def test_one_picture_is_a_frame(tmp_path):
    recording = Recording(tmp_path / "a.mp4", (64, 48), 24.0)
    recording.take(lambda: np.zeros((48, 64, 3), np.uint8), 0, 1.0)
    assert recording.finish() == f"saved {tmp_path / 'a.mp4'} (1 frame)"


def test_after_a_failure_no_picture_is_asked_for(tmp_path, monkeypatch):
    recording = Recording(tmp_path / "a.mp4", (64, 48), 24.0)

    def fail(*_arguments) -> None:
        raise UserError("the disk is full", "make room")

    monkeypatch.setattr(recording._recorder, "write", fail)
    recording.take(lambda: np.zeros((48, 64, 3), np.uint8), 0, 1.0)
    assert recording.failure == "the disk is full: make room"
    recording.take(lambda: pytest.fail("drawn for nothing"), 1, 2.0)
    assert recording.finish() == recording.failure


def test_pictures_that_were_not_shown_in_time_are_counted(tmp_path):
    recording = Recording(tmp_path / "a.mp4", (64, 48), 10.0)
    for frame, now_s in ((0, 0.0), (1, 0.1), (5, 0.5), (6, 0.6)):
        recording.take(lambda: np.zeros((48, 64, 3), np.uint8), frame, now_s)
    assert recording.has_gaps
    assert recording.finish() == f"saved {tmp_path / 'a.mp4'} (4 frames, 3 more were not shown in time)"


@pytest.mark.parametrize("next_frame", [4, 0], ids=["after a pause", "from the start again"])
def test_slots_that_passed_while_the_source_stood_still_are_not_missed(next_frame):
    """An unchanged picture is looked at ten times a second: three frames of this clip."""
    slots = Slots(30.0)
    for frame in range(4):
        slots.time_s(frame / 30, frame)
    for tick in range(1, 20):
        slots.time_s(0.1 + tick / 10, None)
    before_s = 0.1 + 19 / 10
    assert slots.time_s(before_s + 0.1, next_frame) == pytest.approx(before_s + 0.1)
    assert slots.missed == 0
