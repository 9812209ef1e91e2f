"""Switching models: the one before is shown until the next is ready, and no picture's share of the work is large."""

import numpy as np
import pytest

from ashe_live.core.light import Illumination
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import UNMOVED, Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.gl.offscreen import live_gl_objects
from ashe_live.render.occlusion import occlusion
from ashe_live.render.passes import prepared
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene


def test_the_model_before_is_shown_until_the_next_is_ready(ctx, stage, monkeypatch) -> None:
    monkeypatch.setattr(prepared, "MOST_S", 0.0)  # one step a picture
    tracked = stage.tracked(90, stage.pose(20, 40))
    small, large = stage.placed(box((0.02, 0.02, 0.02))), stage.placed(box((0.06, 0.06, 0.06)))
    renderer = SceneRenderer(ctx, FAST.render, (480, 360))
    at_once = SceneRenderer(ctx, FAST.render, (480, 360))

    # Each model has a place of its own, which no other is drawn at.
    placements = {small: Placement(1.3, 0.4, (0.01, 0.0)), large: UNMOVED, None: UNMOVED}

    def picture(of: SceneRenderer, model) -> np.ndarray:
        scene = Scene(tracked, model, Illumination((stage.light(10, 40),)), placement=placements[model])
        of.render(scene, waits=of is at_once)
        return of.read_bgr()

    small_alone, large_alone = picture(at_once, small), picture(at_once, large)
    np.testing.assert_array_equal(picture(renderer, small), small_alone)  # nothing else to show
    pictures = [picture(renderer, large) for _ in range(100)]
    before = [np.array_equal(shown, small_alone) for shown in pictures]
    after = [np.array_equal(shown, large_alone) for shown in pictures]
    assert all(a != b for a, b in zip(before, after, strict=True))
    assert 10 < before.count(True) < 90
    assert before == sorted(before, reverse=True)
    # Back and forth before it is ready, and away from everything.
    for model in (small, large, small, large, None, small):
        shown = picture(renderer, model)
    np.testing.assert_array_equal(shown, small_alone)
    renderer.release()
    at_once.release()
    assert ctx.error == "GL_NO_ERROR"


def test_what_is_dropped_while_it_is_prepared_leaves_nothing(ctx, stage, monkeypatch) -> None:
    monkeypatch.setattr(prepared, "MOST_S", 0.0)
    tracked = stage.tracked(90, stage.pose(20, 40))
    small, large = stage.placed(box((0.02, 0.02, 0.02))), stage.placed(box((0.06, 0.06, 0.06)))
    renderer = SceneRenderer(ctx, FAST.render, (480, 360))
    for _ in range(2):
        renderer.render(Scene(tracked, small), waits=False)
    before = live_gl_objects()
    for _ in range(10):
        renderer.render(Scene(tracked, large), waits=False)
    assert not renderer.is_settled
    assert live_gl_objects() > before
    renderer.render(Scene(tracked, small), waits=False)
    assert live_gl_objects() == before
    renderer.release()
    assert ctx.error == "GL_NO_ERROR"


def test_the_quality_may_change_while_a_model_of_several_parts_is_prepared(ctx, stage, monkeypatch) -> None:
    """As by key Q, or by itself with --quality auto: what its shaders look up is made anew."""
    monkeypatch.setattr(prepared, "MOST_S", 0.0)
    tracked, lit = stage.tracked(90, stage.pose(20, 40)), Illumination((stage.light(10, 40),))
    small, goblet = stage.placed(box((0.02, 0.02, 0.02))), placed_on_marker(load_model("goblet"), 0.08)
    assert len(goblet.model.parts) > 1
    renderer = SceneRenderer(ctx, FAST.render, (480, 360))
    renderer.render(Scene(tracked, small, lit), waits=False)
    pictures = 0
    while pictures == 0 or not renderer.is_settled:
        renderer.preset = (FAST, BALANCED)[pictures % 2].render
        renderer.render(Scene(tracked, goblet, lit), waits=False)
        pictures += 1
    renderer.preset = FAST.render
    renderer.render(Scene(tracked, goblet, lit), waits=False)
    shown = renderer.read_bgr()
    at_once = SceneRenderer(ctx, FAST.render, (480, 360))
    np.testing.assert_array_equal(shown, stage.picture(at_once, Scene(tracked, goblet, lit)))
    renderer.release()
    at_once.release()
    assert ctx.error == "GL_NO_ERROR"


def test_a_model_that_was_shown_before_is_not_looked_at_again(ctx, stage, monkeypatch) -> None:
    """What it hides is known by then, in other pictures as well, and the picture is the same."""
    monkeypatch.setattr(prepared, "MOST_S", 0.0)
    tracked = stage.tracked(90, stage.pose(20, 40))
    models = [stage.placed(box((side, side, side))) for side in (0.02, 0.06)]
    renderer = SceneRenderer(ctx, FAST.render, (480, 360))

    def pictures_until_shown(model) -> int:
        count = 0
        while count == 0 or not renderer.is_settled:
            renderer.render(Scene(tracked, model, Illumination((stage.light(10, 40),))), waits=False)
            count += 1
        return count

    first = [(pictures_until_shown(model), renderer.read_bgr()) for model in models]
    again = [(pictures_until_shown(model), renderer.read_bgr()) for model in models]
    assert first[1][0] > 20
    for (count, picture), (_, before) in zip(again, first, strict=True):
        assert count < 10
        np.testing.assert_array_equal(picture, before)
    monkeypatch.setattr(occlusion, "SelfOcclusion", None)  # looking at it would fail
    beside = renderer.beside((480, 360))
    beside.render(Scene(tracked, models[0], Illumination((stage.light(10, 40),))))
    np.testing.assert_array_equal(beside.read_bgr(), first[0][1])
    beside.release()
    renderer.release()
    assert ctx.error == "GL_NO_ERROR"


def test_a_slow_machine_gets_on_as_well(ctx, stage, monkeypatch) -> None:
    """The work between two pictures grows with the time that pictures take; only a long rest is no reason for more."""
    budgets: list[float] = []
    monkeypatch.setattr(prepared.PreparedModel, "advance", lambda _, budget_s: budgets.append(budget_s) or False)
    now_s = [0.0]
    monkeypatch.setattr(prepared.time, "perf_counter", lambda: now_s[0])
    tracked = stage.tracked(90, stage.pose(20, 40))
    first, second = (stage.placed(box((side, side, side))) for side in (0.02, 0.06))
    renderer = SceneRenderer(ctx, FAST.render, (480, 360))
    renderer.render(Scene(tracked, first), waits=False)
    for passed_s in (0.001, 0.06, 0.5, 60.0):
        now_s[0] += passed_s
        renderer.render(Scene(tracked, second), waits=False)
    assert budgets == [prepared.LEAST_S, pytest.approx(0.02), pytest.approx(0.5 / 3), prepared.MOST_S]
    assert prepared.MOST_S <= 0.2  # which a person who waits for an answer to a key hardly notices
    renderer.release()
