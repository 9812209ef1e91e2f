"""What of the picture is shown, as keys choose it."""

from dataclasses import replace

import pytest

from ashe_live.core.proxy import Proxy
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.notice import NOTICE_S, Notice
from ashe_live.viewer.view_options import WHOLE, ShownParts, ViewOptions


@pytest.fixture
def view() -> ViewOptions:
    return ViewOptions(Notice())


@pytest.mark.parametrize(
    ("command", "is_on"),
    [
        (Command.MIRROR, lambda view: view.is_mirrored),
        (Command.TOGGLE_HUD, lambda view: not view.shows_hud),
        (Command.TOGGLE_HUD, lambda view: not view.has_time_bar),
    ],
)
def test_a_key_pressed_twice_changes_nothing(view, command, is_on) -> None:
    for expected in (False, True, False):
        assert is_on(view) is expected
        assert view.handle(command, None, 0.0)


def test_beside_the_help_there_is_no_room_for_a_time_bar(view) -> None:
    assert view.has_time_bar
    view.handle(Command.HELP, None, 0.0)
    assert view.help.is_shown
    assert not view.has_time_bar
    view.help.close()
    assert view.has_time_bar


def test_the_parts_go_round_and_it_is_said_that_all_is_shown_again(view) -> None:
    """Of less than all a line speaks for as long as it is so, and then not of all as well."""
    shown, now_s = [], 0.0
    for _ in range(2 * len(ShownParts)):
        assert (view.parts_line is None) is (view.parts is WHOLE)
        assert view.parts_line is None or view.parts_line.startswith(view.parts.value)
        now_s += 0.5 * NOTICE_S
        view.handle(Command.BEFORE_AFTER, None, now_s)
        shown.append(view.parts)
        said = view._notice.shown(now_s)
        assert (said is not None and said.startswith(WHOLE.value)) is (view.parts is WHOLE)
    assert shown == [*list(ShownParts)[1:], WHOLE] * 2


def test_a_sheet_is_covered_and_a_body_shown_until_somebody_chooses(view, fakes) -> None:
    sheet = fakes.tracked()
    body = Proxy("box", [[0.0, 0.0, 0.03, 0.0, 0.0]])
    cube = replace(sheet, marker=replace(sheet.marker, body=body))
    away = fakes.tracked(has_marker=False)
    for tracked, is_covered in ((None, True), (away, True), (sheet, True), (cube, False)):
        assert view.covers_marker(tracked) is view.vacates_body(tracked) is is_covered
    view.handle(Command.COVER_MARKER, away, 0.0)
    assert "no marker in view" in (view._notice.shown(0.0) or "")
    assert view.wants_cover is None
    view.handle(Command.COVER_MARKER, cube, 0.0)
    assert view.covers_marker(cube)
    view.cover_is_drawn = False
    assert not view.vacates_body(cube), "the body is still seen there"
    view.handle(Command.COVER_MARKER, cube, 0.0)
    assert not view.covers_marker(sheet)


def test_it_is_said_that_the_marker_is_shown_as_the_cover_may_not_have_been_there_yet(view, fakes) -> None:
    sheet, away = fakes.tracked(), fakes.tracked(has_marker=False)
    for tracked, said in ((away, "no marker in view"), (sheet, "the marker is shown: C covers it"), (sheet, None)):
        view.handle(Command.COVER_MARKER, tracked, 0.0)
        shown = view._notice.shown(0.1)
        assert shown is None if said is None else str(shown).startswith(said)
    view.handle(Command.COVER_MARKER, away, 0.0)
    view.wants_cover = False
    view.handle(Command.COVER_MARKER, sheet, 0.0)
    assert view._notice.shown(0.1) is None, "there is a marker by now"
