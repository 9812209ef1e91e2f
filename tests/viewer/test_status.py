"""The text of the heads-up display: the state of light, marker and camera, and what helps."""

import dataclasses
import re

import numpy as np
import PIL.Image
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles
from ashe_live.models.mesh import Model
from ashe_live.models.placement import Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.families.seen_instead import ALL_BLACK, SeenInstead
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.status import (
    LAMP_AMONG_MANY,
    LAMP_BELOW,
    LAMP_INSIDE,
    NONE_IN_FILE,
    NOT_IN_FILE,
    OUT_OF_PICTURE,
    camera_line,
    guidance,
    light_line,
    marker_line,
    source_lines,
    status_lines,
)
from tests.viewer.scripted_session import on_cube


def test_a_vague_answer_from_one_view_says_what_makes_it_sharper_to_who_can_move_the_camera(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate())
    assert "move" not in light_line(session)  # a clip moves by itself
    session.watch.camera_may_move = True
    assert light_line(session) == "light: azimuth 0°, elevation 45° ± 2.9°, move the camera a little"
    session.watch.sharpening.span_rad = np.radians(20)  # views so far apart have not made it any sharper
    assert "move" not in light_line(session)
    session.watch.sharpening.span_rad = 0.0
    for sigma_rad in (0.01, None):  # None: the paper's method does not tell
        session.estimated(fakes.estimate(sigma_rad=sigma_rad), 1.0)
        assert "move" not in light_line(session)


def test_an_answer_by_several_views_says_how_many_and_how_far_apart_they_are(shown, fakes):
    session = shown()
    session.watch.camera_may_move = True
    session.estimated(fakes.estimate(others=(3, 8), span_rad=np.radians(21)))
    assert light_line(session).endswith("2.9°, 3 views over 21°")


def test_until_a_marker_was_seen_it_says_how_to_get_one(make, fakes):
    session = make()
    session.take(fakes.tracked(has_marker=False), 0.0)
    assert len(status_lines(session, None, "fast")) == 2, "what follows from a marker is nothing to read yet"
    assert any("name it with --marker" in line for line in guidance(session)), "a file shows what it shows"
    session.arrangement.followed = "image:logo.png"
    assert guidance(session)[0].startswith("the marker image:logo.png is not found")
    session.arrangement.followed = "cube"
    assert guidance(session)[0].startswith("the paper cube is not found")
    session.has_named_marker = False
    assert guidance(session)[0].startswith("no marker is found here"), "nobody has heard of the one by default"
    assert not any("cube" in line for line in guidance(session))
    session.watch.camera_may_move = True
    assert any("marker --show" in line for line in guidance(session))
    session.seen_instead = SeenInstead(mirrored=("aruco:4x4_50:0",))
    assert guidance(session)[0].startswith("aruco:4x4_50:0 is in view, but in mirror image: ")
    session.seen_instead = SeenInstead(fault=ALL_BLACK)
    assert guidance(session) == (f"no marker is seen: {ALL_BLACK}",)
    session.seen_instead = SeenInstead()
    session.take(fakes.tracked(), 0.0)
    session.take(fakes.tracked(has_marker=False), 0.0)
    assert guidance(session) == ()


def test_after_no_light_it_says_what_to_change(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate(with_light=False))
    line, by_hand = guidance(session)
    assert line.startswith("what helps")
    assert "by hand" in by_hand
    session.set_by_hand(0.0)
    assert guidance(session) == (), "then there is one"
    session.press(Command.RESET)
    assert guidance(session) == (line, by_hand)
    session.watch.camera_may_move = True
    assert [hint for hint in guidance(session) if "Shift+Space" in hint], "a thing can be taken away"
    session.request_estimate(0.0)
    assert guidance(session) == ()


def test_other_markers_in_view_are_named_with_the_key_that_follows_one(shown):
    session = shown()
    session.seen_instead = SeenInstead(("aruco:4x4_50:7", "aruco:4x4_50:9"))
    (line,) = guidance(session)
    assert "aruco:4x4_50:9" in line
    assert line.endswith("M follows aruco:4x4_50:7")


def test_the_light_line_names_every_state(shown, fakes):
    session = shown(truth=direction_from_angles(0.0, np.radians(45)))
    lines = [light_line(session)]
    session.request_estimate(0.0)
    lines.append(light_line(session))
    session.answered(fakes.estimate(), 0.0)
    lines.append(light_line(session))
    session.request_estimate(0.0)
    lines.append(light_line(session))
    session.answered(fakes.estimate(with_light=False), 0.0)
    lines.append(light_line(session))
    assert "Space" in lines[0]
    assert lines[1] == "light: estimating…"
    assert lines[2] == "light: azimuth 0°, elevation 45° ± 2.9° (0.0° from the truth)"
    assert lines[3] == lines[2] + ", estimating…"
    assert lines[4] == "no clear light: no shadow found beside the object"


def test_the_light_line_says_who_has_set_the_light_and_of_how_many_it_is_the_first(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate())
    assert not any(word in light_line(session) for word in ("by hand", "first of"))
    session.watch.camera_may_move = True
    assert "move the camera" in light_line(session)
    session.set_by_hand(1.0)
    assert light_line(session).startswith("light by hand: ")
    assert "camera" not in light_line(session), "which shows no more of a light by hand"
    session.hand.light = Illumination(tuple(Light((0.1 * number, 0.0, 1.0)) for number in range(3)))
    assert light_line(session).endswith("first of 3")


def test_a_light_that_is_watched_needs_no_key(make):
    assert "Space" in light_line(make())
    assert "Space" not in light_line(make(automatic=True))


def test_an_estimate_that_takes_long_says_for_how_long(shown, fakes):
    session = shown()
    session.request_estimate(10.0)
    session.worker.waited_s = 0.9
    assert light_line(session) == "light: estimating…"
    session.worker.waited_s = 2.6
    assert light_line(session) == "light: estimating, 2 s"
    session.answered(fakes.estimate(), 12.6)
    # One that nobody waits for is silent.
    session.watch.ask_in_background(fakes.tracked(1), 20.0)
    answer = light_line(session)
    assert "estimating" not in answer
    session.request_estimate(30.0)
    assert light_line(session) == f"{answer}, estimating, 2 s"


def test_while_it_waits_for_a_steady_marker_it_does_not_ask_for_a_key(make):
    assert "Space" not in light_line(make(on_first_steady=True))


def test_the_marker_line_distinguishes_found_from_lost(fakes):
    lines = {marker_line(None), marker_line(fakes.tracked()), marker_line(fakes.tracked(has_marker=False))}
    assert len(lines) == 3
    assert {"marker: in view", "marker: not in view"} < lines


def test_of_a_marker_only_what_is_wrong_is_said(fakes):
    seen = fakes.tracked()
    bent = dataclasses.replace(seen, marker=dataclasses.replace(seen.marker, reprojection_rms_px=2.4))
    line = marker_line(bent)
    assert line == "marker: in view, but bent: lay it flat, or measure the lens by `ashe-live calibrate`"
    by_file = dataclasses.replace(bent.camera, source="file")
    assert marker_line(dataclasses.replace(bent, camera=by_file)) == "marker: in view, but bent: lay it flat"


def test_a_cube_is_not_to_be_laid_flat(fakes):
    seen = fakes.tracked()
    cube = on_cube(dataclasses.replace(seen, marker=dataclasses.replace(seen.marker, reprojection_rms_px=2.4)))
    assert marker_line(cube) == "marker: in view"


def test_numbers_are_those_of_the_frame_that_was_measured_and_the_name_that_of_the_model_that_is_drawn(shown, fakes):
    session = shown()
    assert status_lines(session, None, "fast")[:2] == ["model: cube   fast", "marker: in view"]
    first, marker, *_ = status_lines(session, None, "fast", fakes.tracked(has_marker=False), "tree")
    assert (first, marker) == ("model: tree   fast", "marker: not in view")


def test_a_camera_that_nobody_gave_is_announced_with_its_uncertainty(fakes):
    given = fakes.tracked()
    size = given.frame.size
    assert camera_line(None) is None
    assert camera_line(given) is None
    assumed = dataclasses.replace(given, camera=Camera.from_hfov(size, 60, "assumed"))
    assert "assumed" in camera_line(assumed)
    focal_px = Camera.from_hfov(size, 61.3).K[0, 0]
    estimated = dataclasses.replace(given, camera=Camera.from_focal(size, focal_px, "estimated", 0.01 * focal_px))
    shorter = Camera.from_focal(size, 0.99 * focal_px)
    assert camera_line(estimated) == f"camera: 61.3° ± {shorter.hfov_deg - 61.3:.1f}° wide, estimated from the marker"
    vague = dataclasses.replace(given, camera=Camera.from_focal(size, focal_px, "estimated", 0.08 * focal_px))
    assert "few views" in camera_line(vague)


def test_the_camera_that_nobody_gave_has_a_line_of_its_own(make, fakes):
    session, given = make(), fakes.tracked()
    session.take(given, 0.0)
    without = status_lines(session, None, "fast")
    session.take(dataclasses.replace(given, camera=Camera.from_hfov(given.frame.size, 60, "assumed")), 0.1)
    first, marker, camera, light = status_lines(session, None, "fast")
    assert [first, marker, light] == without
    assert camera == camera_line(session.tracked)


def test_no_status_line_is_empty(make):
    session = make()
    assert all(status_lines(session, None, "fast"))
    assert status_lines(session, 59.6, "fast")[0] == "60 fps   model: cube   fast   H: keys"
    assert source_lines(session, None, 0.0) == []
    session.say("saved", 0.0)
    assert source_lines(session, "end of the clip", 0.0) == ["end of the clip", "saved"]


def test_hints_stand_above_what_is_said_of_the_source(shown, fakes, monkeypatch):
    session = shown()
    monkeypatch.setattr(type(session.table), "progress", "tree.glb is being loaded")
    session.estimated(fakes.estimate(with_light=False))
    session.say("saved", 0.0)
    hints = guidance(session)
    assert hints
    assert source_lines(session, "end", 0.0) == [*hints, "end", "tree.glb is being loaded", "saved"]


def test_a_model_whose_marker_has_not_been_in_view_has_no_place_to_be_reported(make, fakes, monkeypatch):
    """Neither beside a lamp, nor out of the picture."""
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.hand.placement = Placement(shift_m=(90.0, 0.0))
    session.hand.light = Illumination((Light((0.0, 0.0, 0.02), inverse_distance=50.0),))
    model = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)
    monkeypatch.setattr(type(session.arrangement), "models", lambda *_: ((None, model, None),))
    assert guidance(session) == ()


def test_what_is_left_out_is_said_for_as_long_as_it_is_so(shown):
    """Not only for the few seconds of a notice: snapshots and recordings are made so too."""
    session = shown()
    for is_whole in (False, False, False, False, True, False):
        session.press(Command.BEFORE_AFTER, now_s=1.0)
        soon, late = (source_lines(session, None, now_s) for now_s in (1.0, 100.0))
        assert soon == [f"{session.view.parts.value}: B goes on"]
        assert late == ([] if is_whole else soon)
    session.press(Command.RESET, now_s=100.0)
    assert session.view.parts.value not in " ".join(source_lines(session, None, 100.0))


def test_a_model_that_was_moved_out_of_the_picture_is_reported(make, fakes):
    session = make()
    model = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)
    session.table.shelf.shown = model
    session.take(fakes.tracked(), 0.0)
    for shift_m, said in (((0.0, 0.0), ()), ((0.01, 0.0), ()), ((90.0, 0.0), (OUT_OF_PICTURE,))):
        session.hand.placement = Placement(shift_m=shift_m)
        assert guidance(session) == said
    session.press(Command.RESET)
    assert guidance(session) == ()


def test_a_model_out_of_the_picture_with_its_marker_is_reported_only_if_it_was_moved(make, fakes):
    session, seen = make(), fakes.tracked()
    aside = seen.marker.T_cam_marker.copy()
    aside[0, 3] = 5.0
    session.table.shelf.shown = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)
    session.take(dataclasses.replace(seen, marker=dataclasses.replace(seen.marker, T_cam_marker=aside)), 0.0)
    assert guidance(session) == ()
    session.hand.placement = Placement(shift_m=(0.01, 0.0))
    assert guidance(session) == (OUT_OF_PICTURE,)
    session.take(fakes.tracked(1, has_marker=False), 0.1)
    assert guidance(session) == ()


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ((0.0, 0.0, 0.02), LAMP_INSIDE),
        ((0.3, 0.0, -0.2), LAMP_BELOW),
        ((0.3, 0.2, 0.4), None),
        ((0.1, 0.0, 0.05), None),
    ],
)
def test_a_lamp_where_no_light_can_come_from_is_reported(make, fakes, place, said):
    session = make()
    model = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)
    session.table.shelf.shown = model
    session.take(fakes.tracked(), 0.0)
    lamp = Light(place, inverse_distance=1 / np.linalg.norm(place))
    session.hand.light = Illumination((lamp,))
    assert guidance(session) == (() if said is None else (said,))
    assert f"lamp, {100 * np.linalg.norm(place):.0f} cm, azimuth" in light_line(session)


def test_a_lamp_among_models_casts_their_shadows_and_is_not_reported(make, fakes):
    session = make()
    session.table.shelf.shown = placed_on_marker(Model("box", (box((0.25, 0.25, 1)),)), 0.08)
    session.take(fakes.tracked(), 0.0)
    session.press(Command.ADD_MODEL)
    session.poll(0.0)
    (_, _, here), (_, _, there) = session.arrangement.models(session.tracked)
    between = (np.array(here.shift_m) + there.shift_m) / 2
    for place, said in (((*between, 0.04), ()), ((*between, 0.6), ()), ((*there.shift_m, 0.02), (LAMP_INSIDE,))):
        session.hand.light = Illumination((Light(place, inverse_distance=1 / np.linalg.norm(place)),))
        assert guidance(session) == said


def test_models_around_a_lamp_that_no_views_of_it_show_are_reported(make, fakes, monkeypatch):
    """Nine, for which depth maps do not suffice beside four lights and a real object; without that they do."""
    session = make()
    model = placed_on_marker(Model("box", (box((0.3, 0.3, 1)),)), 0.06)
    ring = 0.08 * np.array([(np.cos(turn), np.sin(turn)) for turn in 0.7 * np.arange(9)])
    session.table.shelf.shown = model
    session.take(fakes.tracked(), 0.0)
    around = tuple((None, model, Placement(shift_m=tuple(place))) for place in ring)
    monkeypatch.setattr(type(session.arrangement), "models", lambda *_: around)
    lamp, cup = Light((0.0, 0.0, 1.0), inverse_distance=1 / 0.03), Proxy("cup", np.array([(0.3, 0.3, 0.05, 0.02, 0)]))
    suns = tuple(Light((0.1 * number, 0.0, 1.0)) for number in range(3))
    for lit, said in (
        (Illumination((lamp,), real_object=cup), ()),
        (Illumination((lamp, *suns)), ()),
        (Illumination((lamp, *suns), real_object=cup), (LAMP_AMONG_MANY,)),
    ):
        session.hand.light = lit
        assert guidance(session) == said


def test_an_answer_over_the_empty_table_says_so(shown, fakes):
    session = shown()
    session.request_estimate(0.0)
    session.worker.answer, session.worker.is_over_empty_table = fakes.estimate(), True
    session.poll(0.0)
    assert "over the empty table" in light_line(session)


def test_a_light_that_is_followed_is_still_over_the_empty_table(make, fakes):
    session = make(automatic=True)
    worker = session.worker
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(0.0)
    worker.answer, worker.is_over_empty_table = fakes.estimate(), True
    session.poll(0.0)
    session.watch._is_awaited, worker.known, worker.follows = False, [session.estimate], True
    worker.busy, worker.others, worker.answer = True, (fakes.tracked(),), fakes.estimate(towards=(1.0, 0.2, 1.0))
    session.poll(1.0)
    assert session.estimate.light.to_light_marker[1] > 0
    assert "over the empty table" in light_line(session)


@pytest.mark.parametrize("lines", [NOT_IN_FILE, NONE_IN_FILE])
def test_a_picture_of_ones_own_is_read_as_the_tip_names_it(lines, tmp_path):
    (tip,) = (line for line in lines if "picture of your own" in line)
    PIL.Image.fromarray(parse_marker("aruco:4x4_50:7").bitmap(160)).save(tmp_path / "own.png")
    *_, spec = re.findall(r"--marker (\S+)`", tip)
    assert parse_marker(spec.replace("FILE.png", str(tmp_path / "own.png"))).bitmap(160).shape == (160, 160)


@pytest.mark.parametrize(("fps", "shown_as"), [(29.97, "30 fps"), (0.5, "less than 1 fps"), (0.2, "less than 1 fps")])
def test_a_picture_every_few_seconds_is_not_said_to_be_none(shown, fps, shown_as):
    assert status_lines(shown(), fps, "fast")[0].startswith(f"{shown_as}   ")
