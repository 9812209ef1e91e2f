"""What was done by hand while a clip was recorded comes back frame by frame, through the file that says so."""

import copy
import json
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ashe_live.core.contract import SCHEMA
from ashe_live.core.light import Illumination, Light
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.models.assembly.up import UPS
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel
from ashe_live.models.placement import Placement
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.output.as_shown import AsShown, read_as_shown, shown_now
from ashe_live.viewer.session import Session
from ashe_live.viewer.table.shelf import Shelf
from ashe_live.viewer.view_options import WHOLE, ShownParts
from tests.checkout import CHECKOUT

MOVED = Placement(1.5, 0.7, (0.02, -0.04))
LAMP = Light((0.2, -0.3, 0.7), shadow_rgb_ratio=(0.5, 0.4, 0.3), inverse_distance=2.5, radius_m=0.02)
SUN = Light((0.2, 0.3, 0.7), angular_size_rad=0.1, shadow_rgb_ratio=(0.5, 0.4, 0.3))

# What its own errors say of values of the wrong kind.
PYTHONS_OWN = re.compile(r"'\w+' object|iterable|indices|literal|len\(\)|int\(\)|real number, not|has shape")


@pytest.fixture
def begun(fakes):
    def session(model: str = "cube", *others: ChosenModel) -> Session:
        shelf = Shelf(model, 0.08, others=[other.name for other in others])
        return Session(shelf, fakes.Worker(), FirstEstimate(Steadiness(3)), others=others)

    return session


def written(as_shown: AsShown, folder: Path, session: Session) -> AsShown:
    path = folder / "shown.json"
    path.write_text(json.dumps(as_shown.to_json(), allow_nan=False))
    return read_as_shown(path, session.table.shelf)


def test_every_frame_is_as_it_was_shown(begun, fakes, tmp_path: Path) -> None:
    window, as_shown = begun("mug", ChosenModel("tree")), AsShown()
    as_shown.add(3, shown_now(window))
    window.hand.placement, window.hand.light = MOVED, Illumination((LAMP,))
    as_shown.add(5, shown_now(window))
    as_shown.add(6, shown_now(window))
    window.hand.light, window.view.wants_cover = Illumination((SUN,)), False
    window.view.parts = ShownParts.MODEL_ALONE
    as_shown.add(9, shown_now(window))
    assert not as_shown.is_plain
    assert [each["frame"] for each in as_shown.to_json()["shown"]] == [3, 5, 9]

    session = begun("cube")
    again = written(as_shown, tmp_path, session)
    for frame, placement, light in (
        (0, Placement(), None), (4, Placement(), None), (5, MOVED, LAMP), (8, MOVED, LAMP), (20, MOVED, SUN),
    ):  # fmt: skip
        session.take(fakes.tracked(frame), 0.0)
        again.set_up(session)
        (name, _, at), (other, _, beside) = session.arrangement.models(session.tracked)
        assert (name, at, other, beside.shift_m) == ("mug", placement, "tree", (0.1, 0.0))
        if light is None:
            assert session.shown.lights == ()
        else:
            np.testing.assert_allclose(session.shown.light.homogeneous, light.homogeneous, atol=1e-12)
            np.testing.assert_allclose(session.shown.light.shadow_rgb_ratio, light.shadow_rgb_ratio)
            assert session.shown.light.radius_m == light.radius_m
            assert session.shown.light.angular_size_rad == pytest.approx(light.angular_size_rad)
        expected = (ShownParts.MODEL_ALONE, False) if frame == 20 else (WHOLE, True)
        assert (session.view.parts, session.covers_marker) == expected


def test_models_turned_onto_another_side_come_back_so(begun, fakes, tmp_path: Path) -> None:
    window, as_shown = begun("mug"), AsShown()
    window.take(fakes.tracked(0), 0.0)
    as_shown.add(0, shown_now(window))
    shelf = window.table.shelf
    shelf.turn_up()
    window.arrangement.stand_as([replace(window.arrangement.stands[0], model=shelf.loaded("mug"))])
    as_shown.add(1, shown_now(window))
    turned_alone = AsShown()
    turned_alone.add(1, shown_now(window))
    assert not turned_alone.is_plain  # no flag of the command says which side is up

    session = begun("mug")
    again = written(as_shown, tmp_path, session)
    for frame, up in enumerate(UPS[:2]):
        session.take(fakes.tracked(frame), 0.0)
        again.set_up(session)
        assert session.arrangement.stands[0].model.model.up == up


def test_of_a_clip_that_was_played_again_the_last_time_counts(begun) -> None:
    window, as_shown = begun(), AsShown()
    for frame in range(10):
        as_shown.add(frame, shown_now(window))
    window.hand.placement = MOVED
    for frame in (0, 4, 6):  # on a machine that skips some
        as_shown.add(frame, shown_now(window))
    shown = as_shown.to_json()["shown"]
    assert [(each["frame"], each["models"][0]["scale"]) for each in shown] == [(0, MOVED.scale), (7, 1.0)]


def test_a_light_by_hand_shines_on_what_was_estimated(begun, fakes, tmp_path: Path) -> None:
    """On its ground and its real object, which the file does not hold."""
    window, as_shown = begun(), AsShown()
    window.hand.light = Illumination((SUN,))
    as_shown.add(0, shown_now(window))
    session = begun()
    ground = np.array((0.1, 0.2, 0.3))
    session.take(fakes.tracked(0), 0.0)
    session.room_light.take(Illumination((LAMP,), ground_rgb=ground, seen_in=session.tracked), session.tracked)
    written(as_shown, tmp_path, session).set_up(session)
    np.testing.assert_array_equal(session.shown.ground_rgb, ground)
    assert session.shown.seen_in is session.tracked
    np.testing.assert_allclose(session.shown.light.to_light_marker, SUN.to_light_marker)


def test_after_a_light_by_hand_the_estimated_one_is_shown_again(begun, fakes) -> None:
    window, as_shown = begun(), AsShown()
    window.hand.light = Illumination((SUN,))
    as_shown.add(0, shown_now(window))
    window.hand.light = None
    as_shown.add(1, shown_now(window))
    session = begun()
    for frame in range(2):
        session.take(fakes.tracked(frame), 0.0)
        as_shown.set_up(session)
    assert session.hand.light is None
    assert session.shown.lights == ()


def test_what_a_command_shows_anyhow_is_plain(begun) -> None:
    window, as_shown = begun(), AsShown()
    as_shown.add(0, shown_now(window))
    as_shown.add(1, shown_now(window))
    assert as_shown.is_plain
    window.hand.placement = Placement(turn_rad=math.radians(5))
    as_shown.add(2, shown_now(window))
    assert not as_shown.is_plain


@pytest.mark.parametrize("up", [None, "y", "z"])
def test_an_axis_that_a_person_has_named_is_not_plain(fakes, tmp_path: Path, up: str | None) -> None:
    """No flag of the command says it; without a word, "y" is what a glTF says itself, and of an OBJ a guess."""
    text = tmp_path / "tile.obj"
    text.write_text("v 0 0 0\nv 2 0 0\nv 0 1 3\nf 1 2 3\n")
    binary = tmp_path / "mug.glb"
    binary.write_bytes(resource("assets", "models", "mug.glb").read_bytes())
    for file, is_plain in ((text, up is None), (binary, up != "z")):
        session, as_shown = Session(Shelf(str(file), 0.08, up), fakes.Worker(), FirstEstimate()), AsShown()
        as_shown.add(0, shown_now(session))
        assert as_shown.is_plain == is_plain, file


def moved(window: Session) -> None:
    window.hand.placement = MOVED


def lit_by_hand(window: Session) -> None:
    window.hand.light = Illumination((SUN,))


def covered(window: Session) -> None:
    window.view.wants_cover = True


def in_parts(window: Session) -> None:
    window.view.parts = ShownParts.MODEL_ALONE


@pytest.mark.parametrize("change", [moved, lit_by_hand, covered, in_parts])
def test_whatever_is_done_by_hand_is_a_change_and_not_plain(begun, change: Callable[[Session], None]) -> None:
    window, as_shown = begun(), AsShown()
    as_shown.add(0, shown_now(window))
    change(window)
    as_shown.add(1, shown_now(window))
    assert [each["frame"] for each in as_shown.to_json()["shown"]] == [0, 1]
    from_the_start = AsShown()
    from_the_start.add(0, shown_now(window))
    assert not from_the_start.is_plain


def test_one_model_after_another_is_not_plain(begun) -> None:
    """A command names one."""
    as_shown = AsShown()
    for frame, model in enumerate(("cube", "mug")):
        as_shown.add(frame, shown_now(begun(model)))
    assert not as_shown.is_plain


@pytest.mark.parametrize(
    "content",
    [
        "[]",
        "3",
        "{}",
        '{"schema": 1, "shown": []}',
        '{"schema": 2, "shown": [1]}',
        '{"schema": 1, "shown": [{"frame": 0}]}',
    ],
)
def test_another_file_is_refused_in_one_line(begun, tmp_path: Path, content: str) -> None:
    path = tmp_path / "shown.json"
    path.write_text(content)
    with pytest.raises(UserError, match="does not say how a recording was shown"):
        read_as_shown(path, begun().table.shelf)


@pytest.mark.parametrize("value", ["x", 5, 0.5, {"a": 1}, [1], [[]], True, "", -1, 1e30, None])
def test_whatever_stands_in_a_field_is_refused_in_our_own_words(begun, tmp_path: Path, value: object) -> None:
    window, as_shown, path = begun(), AsShown(), tmp_path / "shown.json"
    shelf = window.table.shelf
    window.hand.light = Illumination((replace(SUN, inverse_distance=2.0),), ambient_rgb_ratio=np.full(3, 0.3))
    as_shown.add(0, shown_now(window))
    whole = as_shown.to_json()

    def places(content: object, before: tuple[object, ...] = ()) -> Iterator[tuple[object, ...]]:
        if isinstance(content, dict | list):
            for key, each in content.items() if isinstance(content, dict) else enumerate(content):
                yield (*before, key)
                yield from places(each, (*before, key))

    refused: dict[tuple[object, ...], str] = {}
    for place in places(whole):
        content: Any = copy.deepcopy(whole)
        at = content
        for key in place[:-1]:
            at = at[key]
        at[place[-1]] = value
        path.write_text(json.dumps(content))
        try:
            read_as_shown(path, shelf)
        except UserError as error:
            refused[place] = str(error)
    assert {place: said for place, said in refused.items() if PYTHONS_OWN.search(said)} == {}
    assert {("shown",), ("shown", 0), ("shown", 0, "models", 0)} <= set(refused)


def test_a_file_with_more_models_than_can_stand_there_is_refused(begun, tmp_path: Path) -> None:
    as_shown = AsShown()
    as_shown.add(0, shown_now(begun()))
    record = as_shown.to_json()
    record["shown"][0]["models"] = record["shown"][0]["models"][:1] * (MOST_MODELS + 1)
    (tmp_path / "shown.json").write_text(json.dumps(record))
    with pytest.raises(UserError, match=f"{MOST_MODELS} are the most"):
        read_as_shown(tmp_path / "shown.json", begun().table.shelf)


def test_a_damaged_light_or_place_is_refused(begun, tmp_path: Path) -> None:
    window, as_shown = begun(), AsShown()
    window.hand.light = Illumination((SUN,))
    as_shown.add(0, shown_now(window))
    for path, value in (
        (("models", 0, "scale"), 0),
        (("models", 0, "shift_m"), [1]),
        (("models", 0, "model"), 3),
        (("parts",), "none"),
        (("estimate", "lights", 0, "position_marker_m"), [0, 0, 0]),
        (("estimate", "lights", 0, "position_marker_m"), [0, 0, 1e30]),
        (("estimate", "lights", 0, "to_light_marker"), [0, 0, 0]),
        (("estimate", "lights", 0, "shadow_rgb_ratio"), [0.5, 1.5, 0.5]),
        (("estimate", "lights", 0, "intensity_rgb_ratio"), [1, -1, 1]),
        (("estimate", "ambient_rgb_ratio"), [-0.5, 0.5, 0.5]),
        (("models", 0, "seat"), 10**300),
        (("models", 0, "marker"), [7]),
    ):
        record = as_shown.to_json()
        assert record["schema"] == SCHEMA
        at = record["shown"][0]
        for key in path[:-1]:
            at = at[key]
        at[path[-1]] = value
        (tmp_path / "shown.json").write_text(json.dumps(record))
        with pytest.raises(UserError, match="does not say") as caught:
            read_as_shown(tmp_path / "shown.json", begun().table.shelf)
        assert not any(words in str(caught.value) for words in ("unpack", "division", "os.PathLike"))  # Python's own


def test_the_words_that_files_have_stay() -> None:
    """Those that `docs/contract.md` lists: a recording of an older version is read by them."""
    contract = (CHECKOUT / "docs" / "contract.md").read_text()
    assert all(f"`{parts.value}`" in contract for parts in ShownParts)
