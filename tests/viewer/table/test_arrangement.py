"""Several models on the table: which one is in the hand, and where each stands."""

import itertools
import math
import threading
from concurrent.futures import wait
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.proxy import Proxy
from ashe_live.core.square import PlaneMarker
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel
from ashe_live.models.placement import BESIDE_SIDES, UNMOVED, Placement
from ashe_live.models.reading import read_model
from ashe_live.tracking.cube.faces import CORNERS
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.display import bare_scene
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.hands.requests import Command, Drag, Request
from ashe_live.viewer.session import Session
from ashe_live.viewer.status import status_lines
from ashe_live.viewer.table import shelf as shelf_module
from ashe_live.viewer.table.shelf import Shelf
from tests.patience import PATIENCE_S

SIDE_M = 0.08
OTHER = "aruco:4x4_50:7"


@pytest.fixture
def make(fakes):
    def session(*others: ChosenModel) -> Session:
        shelf = Shelf("cube", SIDE_M, others=[other.name for other in others])
        return Session(shelf, fakes.Worker(), FirstEstimate(Steadiness(3)), others=others)

    return session


def asked(session: Session, *commands: Command | Request) -> None:
    for command in commands:
        request = command if isinstance(command, Request) else Request(command)
        assert session.handle(request, 0.0)
        session.poll(0.0)


def names(session: Session) -> list[str]:
    return [name for name, _, _ in session.arrangement.models(session.tracked)]


def places(session: Session) -> list[Placement | None]:
    return [placement for _, _, placement in session.arrangement.models(session.tracked)]


def with_other(tracked: TrackedFrame, centre_m=(0.2, 0.1), turn_rad=0.0, side_m=SIDE_M) -> TrackedFrame:
    other = PlaneMarker(OTHER, np.array(centre_m), turn_rad, side_m)
    return TrackedFrame(tracked.frame, tracked.camera, tracked.marker, others=(other,))


def test_placements_chain_as_their_matrices_do():
    outer, inner = Placement(1.5, 0.7, (0.1, -0.2)), Placement(0.4, 2.9, (-0.3, 0.05))
    chained = (outer @ inner).marker_from_placed
    np.testing.assert_allclose(chained, outer.marker_from_placed @ inner.marker_from_placed, atol=1e-12)
    assert UNMOVED @ inner is inner
    np.testing.assert_allclose(outer.turned(outer.turned((1.0, 2.0)), back=True), (1.0, 2.0))


def test_several_stand_side_by_side_and_do_not_overlap(make, fakes):
    session = make(ChosenModel("mug"), ChosenModel("tree"))
    session.take(fakes.tracked(0), 0.0)
    assert names(session) == ["cube", "mug", "tree"]
    shifts = [place.shift_m[0] / SIDE_M for place in places(session)]
    assert shifts == pytest.approx([0.0, BESIDE_SIDES, -BESIDE_SIDES])
    scene = bare_scene(session)
    assert [placement for _, placement in scene.models] == places(session)
    boxes = [model.bounds[:, 0] + place.shift_m[0] for model, place in scene.models]
    boxes.sort(key=lambda box: box[0])
    assert all(left[1] < right[0] for left, right in itertools.pairwise(boxes))


def test_beside_a_cube_no_model_stands_in_it(make, fakes):
    session = make(ChosenModel("mug"))
    flat = fakes.tracked(0)
    body = Proxy("box", np.column_stack([SIDE_M * CORNERS, np.zeros((8, 2))]))
    session.take(replace(flat, marker=replace(flat.marker, body=body)), 0.0)
    asked(session, Command.ADD_MODEL)
    shifts = np.array([place.shift_m for place in places(session)])
    assert len(shifts) == 3
    assert np.abs(shifts).max(axis=1).min() > 1.1 * SIDE_M
    session.arrangement.give_back()
    assert places(session)[2].shift_m == tuple(shifts[2])


def test_keys_change_the_one_in_hand_alone(make, fakes):
    session = make(ChosenModel("mug"))
    session.take(fakes.tracked(0), 0.0)
    cube, mug = places(session)
    asked(session, Request(Command.SCALE_MODEL, 2))
    assert places(session)[1] == mug
    asked(session, Command.NEXT_IN_HAND, Request(Command.TURN_MODEL, 3))
    larger, turned = places(session)
    assert larger.scale > cube.scale
    assert turned.turn_rad == pytest.approx(math.radians(15))
    assert turned.shift_m == mug.shift_m
    asked(session, Command.UNDO)
    assert places(session) == [larger, mug]
    asked(session, Command.NEXT_IN_HAND, Command.RESET)
    assert places(session) == [cube, mug]


def test_one_more_is_put_beside_and_taken_away_again(make, fakes):
    session = make()
    session.take(fakes.tracked(0), 0.0)
    asked(session, Command.REMOVE_MODEL)
    assert names(session) == ["cube"]
    asked(session, Command.NEXT_IN_HAND)
    assert "T" in session.notice.text
    asked(session, Command.ADD_MODEL)
    assert names(session) == ["cube", "cube"]
    asked(session, Request(Command.CHOOSE_MODEL, 2))
    name = session.table.shelf.chosen_name
    session.table.shelf.loaded(name)
    session.poll(0.0)
    assert names(session) == ["cube", name]
    assert session.table.in_hand_text == f"{name} (2 of 2)"
    assert places(session)[0] == UNMOVED
    assert places(session)[1].shift_m[0] == pytest.approx(BESIDE_SIDES * SIDE_M)
    asked(session, Command.REMOVE_MODEL)
    assert (names(session), session.table.in_hand_text) == (["cube"], "cube")
    assert session.notice.text == f"{name} is taken away: Ctrl+Z puts it back"
    asked(session, *[Command.ADD_MODEL] * MOST_MODELS)
    assert len(names(session)) == MOST_MODELS
    assert len({place.shift_m for place in places(session)}) == MOST_MODELS


def test_a_model_that_was_added_or_taken_away_is_as_before_after_undo(make, fakes):
    session = make(ChosenModel("mug"))
    session.take(fakes.tracked(0), 0.0)
    asked(session, Request(Command.SCALE_MODEL, 2))
    before = names(session), places(session)
    asked(session, Command.ADD_MODEL, Request(Command.TURN_MODEL, 3), Request(Command.CHOOSE_MODEL, 2))
    session.table.shelf.loaded(session.table.shelf.chosen_name)
    session.poll(0.0)
    asked(session, Request(Command.SCALE_MODEL, -1), Command.UNDO, Command.UNDO)
    assert (names(session), places(session)) == before
    assert "gone again" in session.notice.text
    assert session.table.in_hand_text == "cube (1 of 2)"
    asked(session, Command.REMOVE_MODEL, Request(Command.SCALE_MODEL, 4), Command.UNDO, Command.UNDO)
    assert (names(session), places(session)) == before
    assert "cube is back" in session.notice.text
    assert session.arrangement.in_hand == 0
    asked(session, Command.UNDO)  # what was done to it before
    assert places(session)[0] == UNMOVED
    asked(session, Command.UNDO)
    assert "nothing" in session.notice.text


def test_what_was_done_to_one_is_undone_after_another_was_taken_up(make, fakes):
    session = make(ChosenModel("mug"), ChosenModel("tree"))
    session.take(fakes.tracked(0), 0.0)
    first = places(session)
    asked(session, Request(Command.TURN_MODEL, 3), *[Command.NEXT_IN_HAND] * 2, Request(Command.SCALE_MODEL, 2))
    asked(session, Command.UNDO, Command.UNDO)
    assert session.arrangement.in_hand == 0  # both steps to the tree at once
    assert session.notice.text == "undone: cube is in hand again"
    assert places(session)[0] != first[0]
    asked(session, Command.UNDO)
    assert places(session) == first
    asked(session, Command.UNDO)
    assert "nothing" in session.notice.text


def test_steps_round_to_the_same_one_are_no_step_to_undo(make, fakes):
    session = make(ChosenModel("mug"))
    session.take(fakes.tracked(0), 0.0)
    first = places(session)
    asked(session, Request(Command.TURN_MODEL, 3), Command.NEXT_IN_HAND, Command.NEXT_IN_HAND, Command.UNDO)
    assert places(session) == first


def test_a_drag_that_takes_up_another_one_is_undone_with_what_was_done_before(make, fakes):
    session = make(ChosenModel("mug"))
    tracked = fakes.tracked(0, tilt_deg=40.0)
    session.take(tracked, 0.0)
    first = places(session)
    asked(session, Request(Command.TURN_MODEL, 3))
    middle = np.array([(*first[1].shift_m, 0.02)])
    ((x, y),) = project(tracked.camera, tracked.marker.T_cam_marker, middle)
    asked(session, Request(Command.MOVE_MODEL, Drag((x, y), (x + 5, y), is_first=True)))
    assert session.arrangement.in_hand == 1
    asked(session, *[Command.UNDO] * 3)
    assert (session.arrangement.in_hand, places(session)) == (0, first)


def test_a_drag_takes_up_the_model_that_it_begins_on(make, fakes):
    session = make(ChosenModel("mug"))
    tracked = fakes.tracked(0, tilt_deg=40.0)
    session.take(tracked, 0.0)
    middles = np.array([(*place.shift_m, 0.02) for place in places(session)])
    pixels = project(tracked.camera, tracked.marker.T_cam_marker, middles)
    for number in (1, 0):
        begin = tuple(pixels[number])
        drag = Drag(begin, (begin[0] + 5, begin[1]), is_first=True)
        before = places(session)
        asked(session, Request(Command.MOVE_MODEL, drag))
        assert session.arrangement.in_hand == number
        moved = [now != then for now, then in zip(places(session), before, strict=True)]
        assert moved == [each == number for each in range(2)]


@pytest.mark.parametrize("command", [Command.NEXT_IN_HAND, Command.ADD_MODEL, Command.REMOVE_MODEL])
def test_a_drag_moves_no_model_but_the_one_that_it_grabbed(make, fakes, command):
    """Shift is held then, and with it T, by which one is added, takes one away."""
    session = make(ChosenModel("mug"))
    tracked = fakes.tracked(0, tilt_deg=40.0)
    session.take(tracked, 0.0)
    middle = np.array([(*places(session)[0].shift_m, 0.02)])
    ((x, y),) = project(tracked.camera, tracked.marker.T_cam_marker, middle)

    def drag(begin: float, now: float) -> None:
        asked(session, Request(Command.MOVE_MODEL, Drag((x + begin, y), (x + now, y), is_first=now == begin + 5)))

    drag(0, 5)
    assert session.arrangement.in_hand == 0
    asked(session, command)
    before = places(session)
    drag(0, 30)
    assert places(session) == before
    drag(30, 35)  # the button goes down again
    assert places(session) != before


def test_a_model_stands_on_its_own_marker_and_is_as_large_as_that(make, fakes):
    session = make(ChosenModel("mug", OTHER))
    assert places(session) == [UNMOVED, None], "before the first frame"
    session.take(fakes.tracked(0, has_marker=False), 0.0)
    assert places(session) == [UNMOVED, None]
    session.take(fakes.tracked(0), 0.0)
    assert places(session) == [UNMOVED, None]
    assert bare_scene(session).others[0][1] is None
    assert any(f"{OTHER}: not in view" in line for line in status_lines(session, None, "fast"))
    asked(session, Command.NEXT_IN_HAND, Request(Command.MOVE_MODEL, (1, 0)))
    assert OTHER in session.notice.text  # is not in view
    session.take(with_other(fakes.tracked(1), (0.2, 0.1), 0.5, SIDE_M / 2), 0.1)
    assert not any("not in view" in line for line in status_lines(session, None, "fast"))
    place = places(session)[1]
    assert (place.scale, place.turn_rad) == pytest.approx((0.5, 0.5))
    assert place.shift_m == pytest.approx((0.2, 0.1))


def test_on_the_followed_marker_its_own_model_stands_beside_those_without_a_number(make, fakes):
    session = make(ChosenModel("mug", OTHER), ChosenModel("tree"))
    session.take(fakes.tracked(0), 0.0)
    session.arrangement.followed = OTHER
    assert session.arrangement.without_marker(session.tracked) == ()
    cube, mug, tree = (place.shift_m[0] / (BESIDE_SIDES * SIDE_M) for place in places(session))
    assert (cube, tree, mug) == pytest.approx((0, 1, -1))
    session.arrangement.followed = "aruco:4x4_50:1"
    assert places(session)[1] is None


def test_what_is_moved_by_hand_goes_with_its_marker(make, fakes):
    session = make(ChosenModel("mug", OTHER))
    session.take(with_other(fakes.tracked(0)), 0.0)
    asked(session, Command.NEXT_IN_HAND)
    asked(session, *[Request(Command.MOVE_MODEL, (1, 0))] * 4)
    moved = np.array(places(session)[1].shift_m) - (0.2, 0.1)
    assert np.linalg.norm(moved) > 0.01
    session.take(with_other(fakes.tracked(1), (0.0, 0.3), math.pi / 2), 0.1)
    turned = np.array(places(session)[1].shift_m) - (0.0, 0.3)
    np.testing.assert_allclose(turned, (-moved[1], moved[0]), atol=1e-12)
    # An arrow key moves it where it shows in the picture, however its marker lies.
    before = np.array(places(session)[1].shift_m)
    asked(session, Request(Command.MOVE_MODEL, (1, 0)))
    np.testing.assert_allclose(np.array(places(session)[1].shift_m) - before, moved / 4, atol=1e-12)


def test_they_are_named_as_a_command_takes_them(make, fakes):
    session = make(ChosenModel("mug"), ChosenModel("tree", OTHER))
    session.take(fakes.tracked(0), 0.0)
    asked(session, Request(Command.CHOOSE_MODEL, 2))
    name = session.table.shelf.chosen_name
    session.table.shelf.loaded(name)
    session.poll(0.0)
    assert session.arrangement.chosen == [ChosenModel(name), ChosenModel("mug"), ChosenModel("tree", OTHER)]


def test_another_clip_begins_with_all_of_them_at_their_places(make, fakes):
    session = make(ChosenModel("mug"))
    session.take(fakes.tracked(0), 0.0)
    first = places(session)
    asked(session, Request(Command.SCALE_MODEL, 2), Command.NEXT_IN_HAND, Request(Command.TURN_MODEL, 3))
    session.begin_anew(is_photo=False)
    session.take(fakes.tracked(0), 0.0)
    assert places(session) == first


@pytest.fixture
def slow_models(monkeypatch):
    """All models but the cube are loaded once this is set."""
    go_on = threading.Event()

    def slowly(name: str, side_m: float, up: str | None):
        if name != "cube":
            assert go_on.wait(PATIENCE_S)
        if name == "broken.glb":
            raise UserError("broken.glb is broken", "mend it")
        return read_model(name, side_m, up)

    monkeypatch.setattr(shelf_module, "read_model", slowly)
    yield go_on
    go_on.set()


def loaded(session: Session, name: str, go_on: threading.Event) -> None:
    """Lets `name` be loaded, and the session notice it."""
    go_on.set()
    wait([session.table.shelf._load(name)], PATIENCE_S)
    session.poll(0.0)


@pytest.mark.parametrize("left_by", [Command.NEXT_IN_HAND, Command.ADD_MODEL, Command.REMOVE_MODEL])
def test_a_model_gets_the_one_that_was_chosen_for_it_also_where_another_is_taken_up_meanwhile(
    make, fakes, slow_models, left_by
):
    session = make(ChosenModel("cube"))
    session.take(fakes.tracked(0), 0.0)
    shelf = session.table.shelf
    asked(session, Request(Command.CHOOSE_MODEL, shelf.names.index("mug")), left_by)
    taken_up = session.arrangement.in_hand
    loaded(session, "mug", slow_models)
    asked(session, *([Command.UNDO] if left_by is Command.REMOVE_MODEL else []))
    expected = {Command.NEXT_IN_HAND: ["mug", "cube"], Command.ADD_MODEL: ["mug", "cube", "mug"]}
    assert names(session) == expected.get(left_by, ["mug", "cube"])
    assert session.arrangement.stands[0].model.model.name == shelf.loaded("mug").model.name
    if left_by is Command.NEXT_IN_HAND:
        assert session.arrangement.in_hand == taken_up == 1
        assert session.table.model_name == "cube"


def test_a_model_that_is_taken_up_again_still_awaits_the_one_that_was_chosen_for_it(make, fakes, slow_models):
    session = make(ChosenModel("cube"))
    session.take(fakes.tracked(0), 0.0)
    shelf = session.table.shelf
    asked(session, Request(Command.CHOOSE_MODEL, shelf.names.index("mug")), Command.NEXT_IN_HAND)
    asked(session, Command.NEXT_IN_HAND, Request(Command.TURN_MODEL, 2))
    assert names(session) == ["cube", "cube"]
    loaded(session, "mug", slow_models)
    assert names(session) == ["mug", "cube"]
    assert session.table.in_hand_text == "mug (1 of 2)"


def test_a_model_that_is_turned_up_is_so_also_where_another_is_taken_up_meanwhile(make, fakes, slow_models):
    slow_models.set()
    session = make(ChosenModel("mug"))
    session.take(fakes.tracked(0), 0.0)
    slow_models.clear()
    asked(session, Command.NEXT_IN_HAND)
    before = session.arrangement.stands[1].model.model.up
    asked(session, Command.TURN_UP, Command.NEXT_IN_HAND)
    assert session.arrangement.stands[1].model.model.up == before
    loaded(session, "mug", slow_models)
    assert session.arrangement.stands[1].model.model.up != before
    assert names(session) == ["cube", "mug"]


def test_a_model_stays_where_the_one_that_was_chosen_for_it_cannot_be_read(make, fakes, slow_models):
    session = make(ChosenModel("cube"))
    session.take(fakes.tracked(0), 0.0)
    shelf = session.table.shelf
    shelf.add("broken.glb")
    asked(session, Command.NEXT_IN_HAND)
    shelf.add("other.glb")  # after it in the list, and chosen now
    loaded(session, "broken.glb", slow_models)
    assert names(session) == ["cube", "cube"]
    assert "broken.glb is broken" in session.notice.text
    assert shelf.names[-1] == shelf.chosen_name == "other.glb"
    assert "broken.glb" not in shelf.names
