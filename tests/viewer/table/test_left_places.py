"""How a person left a model is how it stands again, in this run and in others, until they give it back."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.models.catalogue import ChosenModel
from ashe_live.models.memory import ModelMemory
from ashe_live.models.placement import UNMOVED, Placement
from ashe_live.tracking.cube.faces import CORNERS
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.hands.requests import Command, Request
from ashe_live.viewer.session import Session
from ashe_live.viewer.table.beside import first_places
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
    beside = (ChosenModel("mug"), ChosenModel("mug", "aruco:4x4_50:7"))
    session = run(others=beside)
    session.handle(Request(Command.NEXT_IN_HAND), 0.0)
    left(session, LEFT)
    again = run(others=beside)
    placements = [stand.placement for stand in again.arrangement._stands]
    assert [same(each, UNMOVED) for each in placements] == [True, False, True]
    assert same(placements[1], LEFT)


def test_another_clip_shows_what_another_run_would(run) -> None:
    session = run()
    session.hand.placement = LEFT
    session.begin_anew(is_photo=False)
    assert same(session.hand.placement, LEFT)


def test_beside_a_body_a_model_is_as_large_as_it_was_left_and_as_clear_of_it_as_any(run, fakes) -> None:
    left(run(), LEFT)
    flat = fakes.tracked(0)
    body = Proxy("box", np.column_stack([flat.marker.side_m * CORNERS, np.zeros((8, 2))]))
    on_cube = TrackedFrame(flat.frame, flat.camera, replace(flat.marker, body=body))
    session = run()
    session.take(on_cube, 0.0)
    beside = first_places(on_cube, None).of(0)
    assert beside.shift_m != UNMOVED.shift_m
    assert same(session.hand.placement, Placement(LEFT.scale, LEFT.turn_rad, beside.shift_m))
    # A body's place is no reason to forget the other.
    session.arrangement.keep_places()
    assert same(run().hand.placement, LEFT)
