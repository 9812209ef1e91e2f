"""The soak: that it runs to its end and tells a leak or a drift from noise; never how fast it was."""

import itertools
import json
import math
import mmap
import os
import threading
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from ashe_live.bench import resources_held
from ashe_live.bench.resources_held import growth, left_running
from ashe_live.bench.soak import bench as soak
from ashe_live.bench.soak import run as soak_run
from ashe_live.bench.soak import time_code
from ashe_live.bench.soak.bench import SoakBench
from ashe_live.bench.soak.offscreen_window import ShownPicture
from ashe_live.bench.soak.run import SoakTracker, drift_json
from ashe_live.bench.soak.time_code import BITS, TimeCodeCamera, paint_number, read_number
from ashe_live.capture.clips.known_clip import KnownClip
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.quality import FAST
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.hands.requests import Command
from tests.bench.fake_clock import FakeClock

FRAMES = 12
SAMPLED_AT = list(range(500, 100_001, 500))


class BlindEstimator:
    """Answers at once that it sees no light."""

    def __init__(self, _preset: ProxyPreset) -> None: ...

    def estimate(self, tracked, others=()):  # noqa: ARG002
        return LightEstimate("blind", tracked.frame.index, Illumination(), "blind", timing_ms={"total": 1.0})


@pytest.fixture(scope="module")
def clip(film) -> KnownClip:
    return KnownClip(film.path, Camera.from_hfov(film.size, 55), "aruco:4x4_50:0", 0.08, film.to_light_marker)


def test_it_runs_to_its_end_and_leaves_nothing_running(clip, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(soak, "CAMERA_HZ", (100.0,))
    monkeypatch.setattr(soak_run, "SWITCH_EVERY", 4)
    monkeypatch.setattr(soak_run, "ESTIMATE_EVERY", 8)
    out = tmp_path / "results.json"
    record = SoakBench(clip, FAST, BlindEstimator, FRAMES).run(tmp_path)
    assert json.loads(out.read_text()) == record
    assert (record["soak"]["frames"], record["soak"]["model_switches"]) == (FRAMES, FRAMES // 4)
    assert record["soak"]["left_running"] == []
    assert 0 < record["soak"]["key_views_mib"] < 40
    assert len(record["soak"]["held"]["frames"]) == FRAMES
    (age,) = record["age"]
    assert 0 < age["pictures"] <= FRAMES
    assert (age["unread"], age["backwards"]) == (0, 0), "what is on the screen is what the camera saw, in its order"
    assert "left running at the end: nothing" in capsys.readouterr().out


def test_interrupted_it_reports_the_frames_so_far(clip, monkeypatch):
    monkeypatch.setattr(soak, "CAMERA_HZ", ())
    whole = soak_run.SoakRun.add

    def add_ten(run, picture) -> None:
        whole(run, picture)
        if run._count == 10:
            raise KeyboardInterrupt

    monkeypatch.setattr(soak_run.SoakRun, "add", add_ten)
    record = SoakBench(clip, FAST, BlindEstimator, FRAMES).run()
    assert (record["frames"], record["soak"]["frames"]) == (FRAMES, 10)
    assert record["soak"]["left_running"] == []


def test_each_tracked_frame_counts_once_with_its_own_times_and_the_keys_come_in_their_turn(monkeypatch):
    """Of 60 frames, each on the screen twice, those of the last tenth took twice as long to draw and to track."""
    monkeypatch.setattr(soak_run, "SWITCH_EVERY", 3)
    monkeypatch.setattr(soak_run, "ESTIMATE_EVERY", 20)
    monkeypatch.setattr(soak_run, "model_names", lambda: ("cube", "mug"))
    clock, held = FakeClock(), itertools.count(1)
    clock.install(monkeypatch, soak_run.__name__)
    monkeypatch.setattr(resources_held, "held_now", lambda: {"rss_mib": float(next(held))})
    window, watch = SimpleNamespace(requests=[]), SimpleNamespace(key_views=SimpleNamespace(nbytes=0))
    session = SimpleNamespace(tracked=None, estimate=None, watch=watch)
    tracker = SimpleNamespace(at_rest=threading.Lock(), last_ms=(0.0, 0.0))
    run = soak_run.SoakRun(window, session, tracker, 60)
    run.add(ShownPicture(0.0, 9.0, 9.0))  # before there is a frame
    for index in range(60):
        times = 2 if index >= 54 else 1
        session.tracked, tracker.last_ms = object(), (4.0 * times, 3.0 * times)
        watch.key_views.nbytes = 2**20 * (8 if index == 30 else 1)
        if index in (20, 41):
            session.estimate = object()
        clock.work(50)
        for drawn_s in (0.010 * times, 9.0):
            run.add(ShownPicture(100.0, 100.0 + drawn_s, 0.5 * drawn_s))
    found = run.to_json()
    assert found["seconds"] == pytest.approx(60 * 0.05)
    assert (found["frames"], found["model_switches"], found["estimates"], found["key_views_mib"]) == (60, 20, 2, 8)
    keys = [request.command for request in window.requests]
    assert (keys.count(Command.NEXT_MODEL), keys.count(Command.ESTIMATE)) == (20, 3)
    ms = found["drift"]["median_ms"]
    expected = {"drawn": 10.0, "drawn, processor": 5.0, "tracked": 4.0, "tracked, processor": 3.0}
    assert {name: part["first_tenth"] for name, part in ms.items()} == pytest.approx(expected)
    doubled = {name: 2 * once for name, once in expected.items()}
    assert {name: part["last_tenth"] for name, part in ms.items()} == pytest.approx(doubled)
    assert found["drift"]["is_steady"] is False
    assert found["held"]["frames"] == list(range(1, 61))
    # A MiB with each frame is a leak, looked for once every model was loaded twice.
    memory = found["held"]["rss_mib"]
    assert (memory["first"], memory["last"], memory["per_1000_frames"], memory["is_flat"]) == (12, 60, 1000, False)


def test_the_tracker_times_itself_and_cannot_be_at_work_while_memory_is_looked_at(clip, monkeypatch):
    clock, given, tracked = FakeClock(), object(), object()
    clock.install(monkeypatch, soak_run.__name__)
    tracker = SoakTracker(parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, FAST.tracking)
    assert tracker.last_ms == (0, 0)

    def track(_, frame):
        assert frame is given
        assert tracker.at_rest.locked()
        clock.work(30)  # half of it on the processor
        return tracked

    monkeypatch.setattr(MarkerTracker, "track", track)
    assert tracker.track(given) is tracked
    assert tracker.last_ms == pytest.approx((30, 15))
    assert not tracker.at_rest.locked()


@pytest.mark.parametrize("number", [0, 1, 0b1010101010101010, 2**BITS - 1, 2**BITS + 5])
def test_a_number_is_read_as_it_was_painted(number):
    image = np.random.default_rng(number).integers(0, 256, (240, 320, 3), np.uint8)
    paint_number(image, number)
    assert read_number(image) == number % 2**BITS


def test_where_no_number_is_none_is_read():
    assert read_number(np.zeros((240, 320, 3), np.uint8)) is None
    assert read_number(np.full((240, 320, 3), 255, np.uint8)) is None
    assert read_number(np.zeros((48, 64, 3), np.uint8)) is None


def test_the_camera_counts_on_when_the_clip_begins_again(clip):
    camera = TimeCodeCamera(clip, 1e6)
    numbers = []
    for _ in range(30):
        assert camera.grab()
        numbers.append(read_number(camera.retrieve()[1]))
    assert numbers == list(range(30))
    assert all(a <= b for a, b in itertools.pairwise(camera.taken_s(number) for number in numbers))
    camera.release()
    assert not camera.grab()


def test_the_camera_has_a_picture_when_one_is_due_and_remembers_when_it_was_taken(clip, monkeypatch):
    clock = FakeClock()
    clock.install(monkeypatch, time_code.__name__)
    monkeypatch.setattr(threading.Event, "wait", lambda _, seconds: clock.sleep(max(0.0, seconds)))
    camera, begun_s = TimeCodeCamera(clip, 10.0), clock.wall_s()
    assert camera.isOpened()
    assert (camera.size, camera.get(cv2.CAP_PROP_FPS), camera.get(cv2.CAP_PROP_EXPOSURE)) == (
        clip.camera.size,
        10.0,
        0.0,
    )
    for busy_ms in (30, 250, 0, 0):  # the second is read late, and what is missed meanwhile is not caught up on
        assert camera.grab()
        assert camera.retrieve()[0]
        clock.work(busy_ms)
    taken = [camera.taken_s(number) - begun_s for number in range(4)]
    assert taken == pytest.approx([0.1, 0.2, 0.45, 0.55])
    camera.release()
    assert not camera.isOpened()


def test_what_a_process_holds_is_what_it_takes(tmp_path, monkeypatch):
    end = threading.Event()
    before = resources_held.held_now()
    # Mapped, as an array may come out of memory that the heap already holds.
    with (tmp_path / "a").open("w"), mmap.mmap(-1, 64 * 2**20) as kept:
        thread = threading.Thread(target=end.wait)
        thread.start()
        np.frombuffer(kept, np.uint8)[:] = 1
        monkeypatch.setattr(
            resources_held.multiprocessing, "active_children", lambda: [SimpleNamespace(pid=os.getpid())]
        )
        after = resources_held.held_now()
        end.set()
        thread.join()
    more = {name: after[name] - before[name] for name in before}
    assert (more["open_files"], more["threads"], more["gl_objects"]) == (1, 1, 0)
    assert more["rss_mib"] == pytest.approx(64, abs=8)
    assert (before["children_rss_mib"], after["children_rss_mib"]) == (0, pytest.approx(after["rss_mib"], abs=8))
    for gone in (SimpleNamespace(pid=None), SimpleNamespace(pid=2**22 + 1)):
        monkeypatch.setattr(resources_held.multiprocessing, "active_children", lambda gone=gone: [gone])
        assert math.isnan(resources_held.held_now()["children_rss_mib"])


def test_what_a_system_does_not_tell_is_null(monkeypatch):
    samples = iter([{"rss_mib": float(n), "threads": math.nan} for n in (5, 7, 7, 7)])
    monkeypatch.setattr(resources_held, "held_now", lambda: next(samples))
    held = resources_held.Held()
    for frame in (10, 20, 30, 40):
        held.sample(frame)
    found = held.to_json(20)
    assert found["frames"] == [10, 20, 30, 40]
    assert found["rss_mib"] == {"samples": [5, 7, 7, 7], "first": 7, "last": 7, "per_1000_frames": 0, "is_flat": True}
    unknown = dict.fromkeys(("first", "last", "per_1000_frames", "is_flat"))
    assert found["threads"] == {"samples": [None] * 4, **unknown}


def test_noise_and_a_single_jump_are_no_leak_but_a_few_hundred_bytes_a_frame_are():
    noise = np.random.default_rng(3).normal(0, 2, len(SAMPLED_AT))
    level = 350 + noise
    level[:19] -= 200  # warming up
    level[150:] += 3
    assert growth(SAMPLED_AT, level.tolist(), 10_000)["is_flat"]
    leak = level + np.array(SAMPLED_AT) * 300 / 2**20
    leak[-1] += 1e4  # by which no slope is led astray
    found = growth(SAMPLED_AT, leak.tolist(), 10_000)
    assert not found["is_flat"]
    assert found["per_1000_frames"] == pytest.approx(1000 * 300 / 2**20, rel=0.2)


def test_too_few_samples_give_no_verdict():
    assert growth([1, 2], [5.0, 5.0], 10)["is_flat"] is None
    assert growth([1, 2, 3, 4], [float("nan")] * 4, 0)["is_flat"] is None


@pytest.mark.parametrize(
    ("last", "is_steady"),
    [
        ((1, 1, 1, 1), True),
        ((3, 1, 2, 1), True),
        ((1, 1.5, 1, 1), True),
        ((1.5, 1.3, 1, 1), False),
        ((1, 1, 2, 2), False),
    ],
)
def test_slow_by_its_own_doing_is_slow_by_the_clock_and_on_the_processor(last, is_steady):
    times_ms = np.full((1000, 4), 5.0) * np.linspace(np.ones(4), last, 1000)
    times_ms[[150, 950]] = (1.0, 1.0, 1.0, 1.0), (1e4, 1e4, 1e4, 1e4)  # a few pictures are no drift
    found = drift_json(times_ms, round_frames=100)
    assert found["is_steady"] is is_steady
    assert drift_json(times_ms, round_frames=101) is None


def test_a_thread_that_is_left_is_named(monkeypatch):
    monkeypatch.setattr(resources_held, "TIME_TO_END_S", 0.0)
    before, end = set(threading.enumerate()), threading.Event()
    thread = threading.Thread(target=end.wait, name="forgotten")
    thread.start()
    assert left_running(before) == ["forgotten"]
    end.set()
    thread.join()
    assert left_running(before) == []
