"""A person's choice of quality, applied to what tracks, draws and estimates."""

from types import SimpleNamespace

import pytest

from ashe_live.core.caster import Caster
from ashe_live.quality import ACCURATE, BALANCED, FAST
from ashe_live.viewer import quality_choice
from ashe_live.viewer.auto_quality import TOO_SLOW, WINDOW_FRAMES
from ashe_live.viewer.quality_choice import AUTO, NAMES, QualityChoice

INTERVAL_S = 1 / 60
SLOW = TOO_SLOW + 0.05  # of the interval


@pytest.fixture
def stage(make, fakes, monkeypatch):
    """A choice, with what it is applied to; of the clock only what the renderer's `finish` takes passes."""

    def stage(name: str) -> SimpleNamespace:
        clock = SimpleNamespace(now_s=100.0, draw_s=0.0, finished=0)
        monkeypatch.setattr(quality_choice, "time", SimpleNamespace(perf_counter=lambda: clock.now_s))
        session, renderer = make(), fakes.Renderer()

        def finish() -> None:
            clock.finished += 1
            clock.now_s += clock.draw_s

        renderer.finish = finish
        pipeline = SimpleNamespace(tracking=None)
        pipeline.track_with = lambda preset: setattr(pipeline, "tracking", preset)
        choice = QualityChoice(name, INTERVAL_S, renderer, session)
        choice.begin(pipeline)
        return SimpleNamespace(choice=choice, session=session, renderer=renderer, pipeline=pipeline, clock=clock)

    return stage


def in_force(stage) -> set[str]:
    """The names of the presets that something works by."""
    of = {quality.render: quality.name for quality in (FAST, BALANCED, ACCURATE)}
    tracking = {quality.tracking: quality.name for quality in (FAST, BALANCED, ACCURATE)}
    return {of[stage.renderer.preset], tracking[stage.pipeline.tracking]}


def test_it_goes_round_and_what_is_known_of_light_and_caster_holds_for_each(stage) -> None:
    one, ball = stage("fast"), Caster.sphere(0.03)
    one.session.watch.preset = FAST.light.assuming("sun", ball)
    seen = []
    for _ in range(len(NAMES) + 1):
        seen.append(one.choice.shown)
        assert in_force(one) == {one.choice.now.name}
        assert one.session.watch.preset == one.choice.now.light.assuming("sun", ball)
        one.choice.step(one.pipeline)
    assert seen == ["fast", "balanced", "accurate", "auto (balanced)", "fast"]


@pytest.mark.parametrize("slow", ["draw", "track"])
def test_auto_steps_down_by_whatever_takes_longer_and_the_estimator_stays(stage, slow) -> None:
    """It has a process of its own."""
    one = stage(AUTO)
    light = one.session.watch.preset
    one.session.tracked = SimpleNamespace(detect_ms=1e3 * SLOW * INTERVAL_S if slow == "track" else 0.0)
    one.clock.draw_s = SLOW * INTERVAL_S if slow == "draw" else 0.0
    for count in range(WINDOW_FRAMES):
        assert in_force(one) == {"balanced"}, count
        one.choice.adapt(one.pipeline, one.clock.now_s)
    assert in_force(one) == {"fast"}
    assert one.choice.shown == "auto (fast)"
    assert one.session.watch.preset is light
    assert one.clock.finished == WINDOW_FRAMES, "what is only queued has taken no time yet"


def test_auto_stays_where_pictures_are_ready_in_time_also_before_the_first_frame(stage) -> None:
    one = stage(AUTO)
    one.session.tracked = None
    one.clock.draw_s = (2 * TOO_SLOW - SLOW) * INTERVAL_S
    for _ in range(2 * WINDOW_FRAMES):
        one.choice.adapt(one.pipeline, one.clock.now_s)
    assert in_force(one) == {"balanced"}


def test_a_chosen_quality_stays_however_slow_it_is_and_is_not_waited_for(stage) -> None:
    one = stage("accurate")
    one.clock.draw_s = 1.0
    for _ in range(2 * WINDOW_FRAMES):
        one.choice.adapt(one.pipeline, one.clock.now_s - 1.0)
    assert in_force(one) == {"accurate"}
    assert one.clock.finished == 0
