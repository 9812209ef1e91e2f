"""Scenes with the heads-up display over them."""

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.drawing.colours import OBJECT_BGR, SHADOW_BGR
from ashe_live.models.placement import Placement
from ashe_live.render.screen import Screen
from ashe_live.viewer import display as display_module
from ashe_live.viewer.display import READINGS_SHOWN_FOR_S, Display, Readings, bare_scene, cut_out
from ashe_live.viewer.drawn.estimate_inset import BORDER_PX
from ashe_live.viewer.drawn.time_bar import Moment, TimeBar
from ashe_live.viewer.estimates.easing import EASED_OVER_S
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.view_options import ShownParts
from tests.viewer.scripted_session import ScriptedSession

SCREEN = Screen((640, 480))


@pytest.fixture
def session(fakes) -> ScriptedSession:
    session = ScriptedSession(fakes, FirstEstimate())
    session.take(fakes.tracked(), 0.0)
    session.estimated(fakes.estimate())
    return session


def inside(overlay, size) -> bool:
    width, height = overlay.shown_size
    return 0 <= overlay.left_px <= size[0] - width and 0 <= overlay.top_px <= size[1] - height


def test_recordings_carry_no_text(session):
    session.view.help.turn()
    session.view.shows_steps = True
    assert bare_scene(session).overlays == ()


def test_the_window_alone_is_a_mirror(session):
    """What is saved is as the camera sees it."""
    for is_mirrored in (False, True):
        session.view.is_mirrored = is_mirrored
        assert Display().scene(session, SCREEN, Readings("fast"), 0.0).is_mirrored is is_mirrored
        assert not bare_scene(session).is_mirrored


def test_the_arrow_is_in_what_is_saved_where_it_is_shown_and_never_among_models_cut_out(session):
    for shows_light in (False, True):
        session.view.shows_light = shows_light
        assert bare_scene(session).shows_light is shows_light
        assert not cut_out(bare_scene(session)).shows_light


def test_the_lights_become_those_of_the_estimate(session):
    assert bare_scene(session).illumination.lights is not session.estimate.lights
    session.poll(EASED_OVER_S)
    assert bare_scene(session).illumination.lights is session.estimate.lights


def test_shadows_in_the_video_are_those_of_the_estimated_light_while_another_is_on_its_way_or_set_by_hand(session):
    assert bare_scene(session).lit_in_video.lights is session.estimate.lights
    session.poll(EASED_OVER_S)
    assert bare_scene(session).lit_in_video is None
    by_hand = Illumination((Light((1.0, 0.0, 1.0)),))
    session.hand.light = by_hand
    session.poll(EASED_OVER_S)
    assert bare_scene(session).illumination is by_hand
    assert bare_scene(session).lit_in_video.lights is session.estimate.lights


def test_the_line_between_the_halves_lies_below_the_text(session):
    session.view.parts = ShownParts.SPLIT
    line, *text = Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays
    assert line.image_rgba.shape[:2] == (1, 1)
    assert text
    width, height = line.shown_size
    assert (line.top_px, height) == (0, SCREEN.size[1])
    assert line.left_px + width / 2 == pytest.approx(SCREEN.size[0] / 2, abs=1)
    assert width < 4


def test_everything_stands_above_the_time_bar_which_goes_with_the_text(session):
    session.view.shows_steps = True
    session.view.parts = ShownParts.SPLIT
    session.say("a notice of the usual length, as a saved snapshot has", 0.0)
    display, readings = Display(), Readings("fast", 60.0, "end of the clip", Moment(1.0, 10.0))
    shown = display.scene(session, SCREEN, readings, 0.0).overlays
    bar = TimeBar().overlays(readings.moment, SCREEN)
    above, below = shown[: -len(bar)], shown[-len(bar) :]
    assert [(part.left_px, part.top_px) for part in below] == [(part.left_px, part.top_px) for part in bar]
    assert len(above) >= 4
    assert all(part.top_px + part.shown_size[1] <= bar[0].top_px for part in above)
    line, mask, *_ = above
    assert line.shown_size[1] == bar[0].top_px
    assert mask.left_px > SCREEN.size[0] / 2
    session.view.shows_hud = False
    assert len(display.scene(session, SCREEN, readings, 1.0).overlays) == len(above) - 2  # neither status nor hint


def test_all_text_can_be_hidden_but_the_help_that_is_asked_for(session):
    session.say("saved", 0.0)
    session.view.shows_hud = False
    assert Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays == ()
    session.view.help.turn()
    assert len(Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays) == 1


@pytest.mark.parametrize(
    ("size", "scale"), [((300, 225), 1.0), ((320, 240), 1.0), ((480, 640), 1.0), ((640, 480), 2.0), ((1280, 960), 1.0)]
)
def test_everything_stays_inside_the_window(session, size, scale):
    session.view.shows_steps = True
    session.say("a notice of the usual length, as a saved snapshot has", 0.0)
    readings = Readings("auto (balanced)", 60.0, "end of the clip")
    overlays = Display().scene(session, Screen(size, scale), readings, 0.0).overlays
    assert len(overlays) == 4
    session.view.help.turn()
    overlays += Display().scene(session, Screen(size, scale), readings, 0.0).overlays
    assert len(overlays) == 5
    assert all(inside(overlay, size) for overlay in overlays)


@pytest.mark.parametrize("size", [(640, 480), (1280, 720)])
def test_no_text_lies_on_what_the_estimator_saw(session, size):
    session.view.shows_steps = True
    session.say("a notice that goes on for longer than there is room for it beside the estimate " * 3, 0.0)
    inset, rose, *text = Display().scene(session, Screen(size), Readings("fast", 60.0), 0.0).overlays
    assert len(text) == 2
    for plate in text:
        assert plate.left_px + plate.shown_size[0] <= min(inset.left_px, rose.left_px)


def test_what_has_not_changed_is_the_same_object(session):
    session.view.shows_steps = True
    display = Display()
    first = display.scene(session, SCREEN, Readings("fast", 60.0), 100.0).overlays
    again = display.scene(session, SCREEN, Readings("fast", 75.0), 100.1).overlays
    assert all(a is b for a, b in zip(first, again, strict=True))
    later = display.scene(session, SCREEN, Readings("fast", 75.0), 105.0).overlays
    assert [now is before for now, before in zip(later, first, strict=True)] == [True, True, False]


def test_the_masks_are_mirrored_as_the_window_is(session):
    session.view.shows_steps = True
    display, edge, shown = Display(), BORDER_PX, []
    for is_mirrored in (False, True):
        session.view.is_mirrored = is_mirrored
        inset, *_ = display.scene(session, SCREEN, Readings("fast"), 0.0).overlays
        shown.append(inset.image_rgba[edge:-edge, edge:-edge])
    as_seen, mirrored = shown
    np.testing.assert_array_equal(mirrored, as_seen[:, ::-1])


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_the_masks_make_way_for_a_model_where_the_window_shows_it(session, fakes, is_mirrored):
    """Seen from above, its x to the right and its y up: below at the right, or, in a mirror, at the left."""
    session.view.shows_steps, session.view.is_mirrored = True, is_mirrored
    for x_m, is_in_the_way in ((0.17, not is_mirrored), (-0.17, is_mirrored)):
        session.hand.placement = Placement(shift_m=(x_m, -0.12))
        inset, *_ = Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays
        assert (inset.top_px < SCREEN.size[1] / 4) is is_in_the_way
    for tracked in (fakes.tracked(1, has_marker=False), None):
        session.tracked = tracked
        inset, *_ = Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays
        assert inset.top_px > SCREEN.size[1] / 4


def test_the_masks_are_shown_where_no_model_has_a_place(session, monkeypatch):
    """As where each stands on a marker that has not been in view."""
    session.view.shows_steps = True
    ((_, model, _),) = session.arrangement.models(session.tracked)
    monkeypatch.setattr(type(session.arrangement), "models", lambda *_: ((None, model, None),))
    inset, *_ = Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays
    assert inset.top_px > SCREEN.size[1] / 4


def test_a_marker_that_is_lost_is_reported_at_once_and_its_numbers_are_held(session, fakes, monkeypatch):
    display, told = Display(), []
    monkeypatch.setattr(display_module, "status_lines", lambda _session, *read: told.append(read[:3]) or ["line"])
    first, second, lost, found = (fakes.tracked(index, has_marker=index != 3) for index in (1, 2, 3, 4))
    for tracked, fps, now_s in ((first, 60.0, 0.1), (second, 50.0, 0.2), (lost, 40.0, 0.3), (found, 30.0, 0.4)):
        session.take(tracked, now_s)
        display.scene(session, SCREEN, Readings("fast", fps), now_s)
    display.scene(session, SCREEN, Readings("fast", 20.0), 0.4 + READINGS_SHOWN_FOR_S)
    assert [(fps, seen) for fps, _, seen in told] == [
        (60.0, first),
        (60.0, first),
        (40.0, lost),
        (30.0, found),
        (20.0, found),
    ]


def test_the_masks_are_shown_over_the_frozen_frame(session):
    session.view.shows_steps = True
    (inset, *_) = Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays
    width, height = inset.shown_size
    assert inset.left_px > SCREEN.size[0] / 2
    assert inset.top_px > SCREEN.size[1] / 2
    assert width / height == pytest.approx(64 / 48, rel=0.02)

    def colour_at(x: float, y: float) -> np.ndarray:
        return inset.image_rgba[round(y * height), round(x * width), :3][::-1].astype(float)

    frozen = np.full(3, 90.0)
    towards_object, towards_shadow = colour_at(12 / 32, 8 / 24) - frozen, colour_at(0.8, 0.8) - frozen
    for towards, target in ((towards_object, OBJECT_BGR), (towards_shadow, SHADOW_BGR)):
        wanted = np.asarray(target) - frozen
        assert towards @ wanted / np.linalg.norm(towards) / np.linalg.norm(wanted) > 0.99


def test_without_an_estimate_there_are_no_masks(fakes):
    session = ScriptedSession(fakes, FirstEstimate())
    session.view.shows_steps = True
    assert len(Display().scene(session, SCREEN, Readings("fast"), 0.0).overlays) == 1


def test_the_name_is_that_of_the_model_in_the_picture(session, monkeypatch):
    display, names = Display(), []

    def noted(_session, *_args):
        names.append(_args[-1])
        return ["line"]

    monkeypatch.setattr(display_module, "status_lines", noted)
    before, chosen = object(), object()
    for drawn, model in ((before, before), (before, chosen), (chosen, chosen)):
        session.table.shelf.shown = model
        session.table.drawn = (drawn,)
        display.scene(session, SCREEN, Readings("fast"), 0.0)
        if drawn is model:
            session.table.shelf.step(1)
    assert names[0] == names[1] == "cube"
    assert names[2] == "lantern"
