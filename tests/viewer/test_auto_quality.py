"""`--quality auto` on machines of several speeds."""

import pytest

from ashe_live.quality import ACCURATE, BALANCED, FAST, Quality
from ashe_live.viewer.auto_quality import CALM_WINDOWS, WINDOW_FRAMES, AutoQuality

INTERVAL_MS = 1000 / 60


def run(auto: AutoQuality, cost_ms: dict[Quality, float], windows: int) -> list[Quality]:
    """The qualities it changed to, on a machine on which a frame costs `cost_ms`."""
    changes = []
    for _ in range(windows * WINDOW_FRAMES):
        if auto.add(cost_ms[auto.quality]):
            changes.append(auto.quality)
    return changes


def test_it_steps_down_within_one_window():
    auto = AutoQuality(INTERVAL_MS, ACCURATE)
    assert run(auto, {ACCURATE: 20, BALANCED: 8, FAST: 4}, 1) == [BALANCED]


@pytest.mark.parametrize(("cost_ms", "frames"), [(1000.0, 9), (200.0, 20), (40.0, WINDOW_FRAMES)])
def test_on_a_very_slow_machine_it_does_not_wait_for_a_whole_window(cost_ms: float, frames: int):
    auto = AutoQuality(INTERVAL_MS, BALANCED)
    assert [auto.add(cost_ms) for _ in range(frames)] == [False] * (frames - 1) + [True]
    assert auto.quality is FAST


def test_a_few_frames_of_seconds_as_while_something_is_loaded_are_no_reason_to_step_down():
    auto = AutoQuality(INTERVAL_MS, BALANCED)
    for work_ms in [3000.0] * 4 + [8.0] * (WINDOW_FRAMES - 4):
        assert not auto.add(work_ms)
    assert auto.quality is BALANCED


def test_it_stops_at_the_lowest():
    assert run(AutoQuality(INTERVAL_MS, BALANCED), {BALANCED: 40, FAST: 30}, 50) == [FAST]


def test_it_goes_up_where_there_is_room_but_slowly():
    auto = AutoQuality(INTERVAL_MS, FAST)
    cost_ms = {FAST: 1, BALANCED: 2, ACCURATE: 4}
    assert run(auto, cost_ms, CALM_WINDOWS - 1) == []
    assert run(auto, cost_ms, 1) == [BALANCED]
    assert run(auto, cost_ms, CALM_WINDOWS) == [ACCURATE]
    assert run(auto, cost_ms, 20) == []


@pytest.mark.parametrize("busy_ms", [0.6 * INTERVAL_MS, 2 * INTERVAL_MS], ids=["full", "too slow"])
def test_there_is_room_if_all_of_the_last_windows_had_some(busy_ms: float):
    """At the lowest, where none is too slow to stay."""
    auto = AutoQuality(INTERVAL_MS, FAST)
    idle, busy = {FAST: 1.0, BALANCED: 1.0}, {FAST: busy_ms}
    for _ in range(5):
        assert run(auto, idle, CALM_WINDOWS - 1) == []
        assert run(auto, busy, 1) == []
    assert run(auto, idle, CALM_WINDOWS) == [BALANCED]
    assert run(auto, idle, CALM_WINDOWS - 1) == [], "the windows before the step do not count again"


@pytest.mark.parametrize("start", [FAST, BALANCED, ACCURATE])
def test_it_does_not_swing(start):
    changes = run(AutoQuality(INTERVAL_MS, start), {FAST: 2, BALANCED: 5, ACCURATE: 30}, 200)
    assert changes.count(ACCURATE) <= 1
    assert [start, *changes][-1] is BALANCED


def test_single_slow_frames_are_forgiven():
    auto = AutoQuality(INTERVAL_MS, ACCURATE)
    for frame in range(20 * WINDOW_FRAMES):
        auto.add(500.0 if frame % 5 == 0 else 8.0)
    assert auto.quality is ACCURATE
