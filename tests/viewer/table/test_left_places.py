"""How a person left a model is how it stands again, in this run and in others, until they give it back."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import PlaneMarker
from ashe_live.core.types import TrackedFrame
from ashe_live.models.catalogue import ChosenModel
from ashe_live.models.memory import ModelMemory
from ashe_live.models.placement import UNMOVED, Placement
from ashe_live.render.beside import first_places
from ashe_live.tracking.cube.faces import CORNERS
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.hands.requests import Command, Request
from ashe_live.viewer.session import Session
from ashe_live.viewer.table.shelf import Shelf

LEFT = Placement(1.5, math.radians(30), (0.02, -0.04))


@pytest.fixture
def run(fakes, tmp_path: Path) -> Callable[..., Session]:
    """Another run of the program, on a marker of that side."""

    def begun(model: str = "mug", side_m: float = 0.08, has_places: bool = True, others=()) -> Session:
        memory = ModelMemory(tmp_path / "models.json", has_places)
        shelf = Shelf(model, side_m, None, memory, [other.name for other in others])
        session = Session(shelf, fakes.Worker(), FirstEstimate(Steadiness(3)), others=others)
        session.poll(0.0)
        return session

    return begun


def left(session: Session, placement: Placement) -> None:
    session.hand.placement = placement
    session.arrangement.keep_places()  # as at the end


def same(a: Placement, b: Placement) -> bool:
    return np.allclose(a.marker_from_placed, b.marker_from_placed, atol=1e-12)


def test_a_model_stands_in_the_next_run_as_it_was_left_and_says_so(run) -> None:
    left(run(), LEFT)
    session = run()
    assert same(session.hand.placement, LEFT)
    assert "mug stands as it was left: Backspace" in str(session.notice.shown(0.0))
    for other in (run("tree"), run(has_places=False)):
        assert other.hand.placement == UNMOVED
        assert "left" not in str(other.notice.shown(0.0))


def test_a_place_is_counted_in_sides_of_the_marker(run) -> None:
    left(run(), LEFT)
    assert same(run(side_m=0.16).hand.placement, Placement(1.5, math.radians(30), (0.04, -0.08)))


def test_what_is_given_back_is_forgotten_unless_that_is_undone(run) -> None:
    left(run(), LEFT)
    session = run()
    session.handle(Request(Command.RESET), 0.0)
    assert "mug stands as at first: Ctrl+Z" in str(session.notice.shown(0.0))
    assert session.hand.placement == run().hand.placement == UNMOVED
    session.handle(Request(Command.UNDO), 1.0)
    session.arrangement.keep_places()
    assert same(run().hand.placement, LEFT)


def test_light_and_place_that_are_given_back_together_are_both_spoken_of(run, fakes) -> None:
    left(run(), LEFT)
    session = run()
    session.take(fakes.tracked(), 0.0)
    session.handle(Request(Command.MOVE_LIGHT, (1, 0)), 0.0)
    session.handle(Request(Command.RESET), 1.0)
    assert "mug stands as at first" in str(session.notice.shown(1.0))
    assert "no longer by hand" in str(session.notice.shown(1.0))


def test_what_was_moved_in_this_run_is_spoken_of_as_well(run, fakes) -> None:
    session = run()
    session.take(fakes.tracked(), 0.0)
    session.handle(Request(Command.MOVE_LIGHT, (1, 0)), 0.0)
    session.handle(Request(Command.TURN_MODEL, 1), 1.0)
    session.handle(Request(Command.RESET), 2.0)
    assert "mug stands as at first and the light is no longer by hand: Ctrl+Z" in str(session.notice.shown(2.0))


def test_a_run_that_moves_nothing_changes_nothing(run, tmp_path: Path) -> None:
    left(run(), UNMOVED)
    assert not (tmp_path / "models.json").exists()
    left(run(), LEFT)
    before = (tmp_path / "models.json").read_bytes()
    session = run("tree")
    session.handle(Request(Command.CHOOSE_MODEL, 3), 0.0)
    session.arrangement.keep_places()
    assert (tmp_path / "models.json").read_bytes() == before


def test_each_place_among_several_is_remembered_by_itself(run) -> None:
    beside = (ChosenModel("mug"), ChosenModel("mug", "aruco:4x4_50:7"), ChosenModel("mug", "aruco:4x4_50:8"))
    session = run(others=beside)
    expected = [replace(LEFT, turn_rad=0.1 * number) for number in range(len(beside) + 1)]
    for placement in expected:
        left(session, placement)
        session.handle(Request(Command.NEXT_IN_HAND), 0.0)
    again = run(others=beside)
    for stand, placement in zip(again.arrangement._stands, expected, strict=True):
        assert same(stand.placement, placement)


def test_another_clip_shows_what_another_run_would(run) -> None:
    session = run()
    session.hand.placement = LEFT
    session.begin_anew(is_photo=False)
    assert same(session.hand.placement, LEFT)


def on_cube(flat: TrackedFrame, others: tuple[PlaneMarker, ...] = ()) -> TrackedFrame:
    body = Proxy("box", np.column_stack([flat.marker.side_m * CORNERS, np.zeros((8, 2))]))
    return replace(flat, marker=replace(flat.marker, body=body), others=others)


@pytest.mark.parametrize("moved_m", [None, (0.15, 0.01)], ids=["turned alone", "moved"])
def test_beside_a_body_a_model_comes_back_as_it_was_left_in_this_run(run, fakes, moved_m) -> None:
    """Where it was only turned, where models stand there, and not in the body."""
    session = run()
    session.take(on_cube(fakes.tracked(0)), 0.0)
    beside = session.hand.placement
    session.hand.placement = as_left = replace(beside, turn_rad=1.0, shift_m=moved_m or beside.shift_m)
    shelf = session.table.shelf
    for name in ("tree", "mug"):
        shelf.loaded(name)
        session.handle(Request(Command.CHOOSE_MODEL, shelf.names.index(name)), 0.0)
        session.poll(0.0)
        assert shelf.shown_name == name
        assert (session.hand.placement == as_left) == (name == "mug")
    session.arrangement.keep_places()
    on_a_flat_marker = run().hand.placement
    assert same(on_a_flat_marker, replace(as_left, shift_m=moved_m or UNMOVED.shift_m))


def test_in_a_new_light_models_step_out_of_the_bodys_shadow_but_for_those_that_were_moved(run, fakes) -> None:
    """What else was done to them stays as it is."""
    seen = on_cube(fakes.tracked(0))
    session = run(others=[ChosenModel("tree"), ChosenModel("mug")])
    session.take(seen, 0.0)
    larger, moved, unmoved = session.arrangement._stands
    session.hand.placement = replace(larger.placement, scale=1.5)
    moved_by_hand = replace(moved.placement, shift_m=(0.2, 0.1))
    session.arrangement._stands[1] = replace(moved, placement=moved_by_hand)
    to_light = np.array((*larger.placement.shift_m, 0.1))  # from over it, so that the shadow falls away from it
    for light in (Light(to_light), Light(to_light * (-1, -1, 1))):
        session.arrangement.stand_clear(seen, light, in_its_place=False, in_new_light=True)
        first = first_places(seen, light)
        now = [stand.placement for stand in session.arrangement.stands]
        assert now[0] == replace(larger.placement, scale=1.5, shift_m=first.of(0).shift_m)
        assert now[1] == moved_by_hand
        assert now[2] == first.of(unmoved.seat)
    assert first.of(0).shift_m != larger.placement.shift_m


def test_on_a_flat_marker_beside_the_body_a_model_stands_as_on_any(run, fakes) -> None:
    spec, at_m = "aruco:4x4_50:7", (0.2, 0.1)
    flat = fakes.tracked(0)
    session = run(others=[ChosenModel("mug", spec)])
    session.handle(Request(Command.NEXT_IN_HAND), 0.0)
    session.handle(Request(Command.SCALE_MODEL, 2), 0.0)
    session.take(on_cube(flat, (PlaneMarker(spec, np.array(at_m), 0.0, flat.marker.side_m),)), 0.0)
    _, (_, _, placement) = session.arrangement.models(session.tracked)
    assert placement.shift_m == pytest.approx(at_m)


def test_beside_a_body_a_model_is_as_large_as_it_was_left_and_as_clear_of_it_as_any(run, fakes) -> None:
    left(run(), LEFT)
    session = run()
    session.take(seen := on_cube(fakes.tracked(0)), 0.0)
    beside = first_places(seen, None).of(0)
    assert beside.shift_m != UNMOVED.shift_m
    assert same(session.hand.placement, Placement(LEFT.scale, LEFT.turn_rad, beside.shift_m))
    # A body's place is no reason to forget the other.
    session.arrangement.keep_places()
    assert same(run().hand.placement, LEFT)
