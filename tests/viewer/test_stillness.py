"""When pictures need not be drawn again, on fast machines and on slow ones."""

from types import SimpleNamespace

import pytest

from ashe_live.quality import ACCURATE, FAST
from ashe_live.render.scene import Scene
from ashe_live.viewer import stillness as stillness_module
from ashe_live.viewer.stillness import (
    FPS_OVER_FRAMES,
    HELD_AFTER_PICTURES,
    UNCHANGED_PICTURES,
    UNCHANGED_S,
    Stillness,
)

SIZE = (640, 480)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    clock = SimpleNamespace(now_s=0.0)
    monkeypatch.setattr(stillness_module.time, "monotonic", lambda: clock.now_s)
    return clock


@pytest.mark.parametrize("fps", [1, 5, 20, 60, 1000])
def test_a_slow_machine_rests_as_soon_as_a_fast_one(clock: SimpleNamespace, fps: float) -> None:
    """But for the few pictures that it takes to see that nothing changes. However long pictures have changed before."""
    stillness = Stillness()
    for changes in (5, 1, 100):
        for _ in range(changes):
            clock.now_s += 1 / fps
            stillness.add(Scene(time_s=clock.now_s), SIZE, FAST.render, is_settled=True)
            assert not stillness.is_still
        last, count = Scene(time_s=clock.now_s + 1), 0  # of equal pictures; the first differs from what was before
        while not stillness.is_still:
            clock.now_s += 1 / fps
            stillness.add(last, SIZE, FAST.render, is_settled=True)
            count += 1
            assert count <= UNCHANGED_PICTURES + 1
        assert count - 1 >= max(HELD_AFTER_PICTURES + 1, min(UNCHANGED_PICTURES, UNCHANGED_S * fps - 0.01))
        assert (count - 1) / fps <= max(UNCHANGED_S + 1 / fps, (HELD_AFTER_PICTURES + 1) / fps)


@pytest.mark.usefixtures("clock")
def test_what_changes_or_is_being_prepared_is_not_still() -> None:
    stillness = Stillness()
    for number in range(2 * UNCHANGED_PICTURES):
        stillness.add(Scene(time_s=float(number)), SIZE, FAST.render, is_settled=True)
        assert not stillness.is_still
    for _ in range(2 * UNCHANGED_PICTURES):
        stillness.add(Scene(), SIZE, FAST.render, is_settled=False)
        assert not stillness.is_still


@pytest.mark.usefixtures("clock")
@pytest.mark.parametrize(("size", "preset"), [((800, 600), FAST.render), (SIZE, ACCURATE.render)])
def test_the_same_in_another_size_or_quality_is_another_picture(size, preset) -> None:
    stillness, scene = Stillness(), Scene()
    for _ in range(UNCHANGED_PICTURES + 1):
        stillness.add(scene, SIZE, FAST.render, is_settled=True)
    assert stillness.is_still
    stillness.add(scene, size, preset, is_settled=True)
    assert not stillness.is_still


def test_no_more_pictures_a_second_are_told_than_the_display_shows(clock: SimpleNamespace) -> None:
    """After a slow one the next may follow at once, and the picture rest then."""
    stillness = Stillness(60.0)
    for after_s in (1.0, 0.004, 0.5):
        clock.now_s += after_s
        stillness.shown()
        told = stillness.fps(is_idle=False)
        assert told is None or told <= 60.0
    assert stillness.fps(is_idle=False) == pytest.approx(2 / 0.504)


def test_two_pictures_within_a_tick_of_a_coarse_clock_tell_no_rate(clock: SimpleNamespace) -> None:
    """As of Windows, where the first two are handed over at once."""
    stillness = Stillness()
    assert stillness.fps(is_idle=False) is None
    for _ in range(2):
        stillness.shown()
        assert stillness.fps(is_idle=False) is None
    clock.now_s += 0.0625
    stillness.shown()
    assert stillness.fps(is_idle=False) == 2 / 0.0625


def shown_at(clock: SimpleNamespace, stillness: Stillness, pictures: int, fps: float) -> float | None:
    for _ in range(pictures):
        clock.now_s += 1 / fps
        stillness.shown()
        told = stillness.fps(is_idle=False)
    return told


def test_the_frame_rate_is_that_of_the_last_pictures_and_a_rest_is_none_of_them(clock: SimpleNamespace) -> None:
    stillness = Stillness()
    shown_at(clock, stillness, 100, 10.0)
    assert shown_at(clock, stillness, FPS_OVER_FRAMES, 60.0) == pytest.approx(60.0)
    assert stillness.fps(is_idle=True) == pytest.approx(60.0), "it is told while nothing is drawn, too"
    clock.now_s += 60.0
    assert shown_at(clock, stillness, 2, 20.0) == pytest.approx(20.0)


def test_the_frame_rate_told_is_held_while_the_pictures_are_equal(clock: SimpleNamespace) -> None:
    """Its digits would be all that changes in them."""
    stillness, equal = Stillness(), Scene()
    told = shown_at(clock, stillness, 5, 50.0)
    for _ in range(HELD_AFTER_PICTURES + 1):  # the first differs from nothing
        stillness.add(equal, SIZE, FAST.render, is_settled=True)
    assert shown_at(clock, stillness, 5, 10.0) == told
    stillness.add(Scene(time_s=1.0), SIZE, FAST.render, is_settled=True)
    assert shown_at(clock, stillness, 5, 10.0) != told
