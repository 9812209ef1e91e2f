"""When pictures need not be drawn again, on fast machines and on slow ones."""

import pytest

from ashe_live.quality import FAST
from ashe_live.render.scene import Scene
from ashe_live.viewer import stillness as stillness_module
from ashe_live.viewer.stillness import HELD_AFTER_PICTURES, UNCHANGED_PICTURES, UNCHANGED_S, Stillness

SIZE = (640, 480)


def pictures_until_still(monkeypatch: pytest.MonkeyPatch, interval_s: float) -> int:
    now_s = 0.0
    monkeypatch.setattr(stillness_module.time, "monotonic", lambda: now_s)
    stillness = Stillness()
    for count in range(1, 2 * UNCHANGED_PICTURES):
        now_s += interval_s
        stillness.add(Scene(), SIZE, FAST.render, is_settled=True)
        if stillness.is_still:
            return count
    pytest.fail("never still")


@pytest.mark.parametrize("fps", [1, 5, 60, 1000])
def test_a_slow_machine_rests_as_soon_as_a_fast_one(monkeypatch: pytest.MonkeyPatch, fps: float) -> None:
    """But for the few pictures that it takes to see that nothing changes."""
    count = pictures_until_still(monkeypatch, 1 / fps)
    assert HELD_AFTER_PICTURES < count <= UNCHANGED_PICTURES + 1
    assert count / fps <= max(UNCHANGED_S + 2 / fps, (HELD_AFTER_PICTURES + 2) / fps)


def test_what_changes_or_is_being_prepared_is_not_still(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stillness_module.time, "monotonic", lambda: 0.0)
    stillness = Stillness()
    for number in range(2 * UNCHANGED_PICTURES):
        stillness.add(Scene(time_s=float(number)), SIZE, FAST.render, is_settled=True)
        assert not stillness.is_still
    for _ in range(2 * UNCHANGED_PICTURES):
        stillness.add(Scene(), SIZE, FAST.render, is_settled=False)
        assert not stillness.is_still


def test_no_more_pictures_a_second_are_told_than_the_display_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a slow one the next may follow at once, and the picture rest then."""
    now_s = 0.0
    monkeypatch.setattr(stillness_module.time, "monotonic", lambda: now_s)
    stillness = Stillness(60.0)
    for after_s in (1.0, 0.004, 0.5):
        now_s += after_s
        stillness.shown()
        told = stillness.fps(is_idle=False)
        assert told is None or told <= 60.0
    assert stillness.fps(is_idle=False) == pytest.approx(2 / 0.504)


def test_two_pictures_within_a_tick_of_a_coarse_clock_tell_no_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of Windows, where the first two are handed over at once."""
    now_s = 0.0
    monkeypatch.setattr(stillness_module.time, "monotonic", lambda: now_s)
    stillness = Stillness()
    for _ in range(2):
        stillness.shown()
        assert stillness.fps(is_idle=False) is None
    now_s += 0.0625
    stillness.shown()
    assert stillness.fps(is_idle=False) == 2 / 0.0625
