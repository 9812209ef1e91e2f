"""The menu: whatever it shows can be chosen with the mouse, wherever it was opened, and does what its key does."""

import copy

import numpy as np
import pytest

from ashe_live.render.hud import FONT_PT
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.controls import BINDINGS
from ashe_live.viewer.hands.menu import OFFERED, Menu, entries_for
from ashe_live.viewer.hands.requests import Command, MouseAction, MouseEvent, Request

SIZE = (640, 480)
ENTRIES = entries_for(("mug", "tree"), 1)
MENU, MOVED, PRESSED, RELEASED = MouseAction.MENU, MouseAction.MOVED, MouseAction.PRESSED, MouseAction.RELEASED


def opened(x_px: float = 50, y_px: float = 40, size: tuple[int, int] = SIZE) -> Menu:
    menu = Menu()
    assert menu.take_mouse(MouseEvent(MENU, x_px, y_px), lambda: ENTRIES, Screen(size))
    return menu


def plate(menu: Menu, size: tuple[int, int] = SIZE) -> tuple[int, int, int, int]:
    (overlay, *_) = menu.overlays(Screen(size))
    return overlay.left_px, overlay.top_px, *overlay.shown_size


def chosen_at(x_px: float, y_px: float, menu: Menu, size: tuple[int, int] = SIZE) -> Request | None:
    for action in (MOVED, PRESSED, RELEASED):
        assert menu.take_mouse(MouseEvent(action, x_px, y_px), lambda: ENTRIES, Screen(size))
    return menu.take_request()


def test_commands_are_worded_as_in_the_table_of_keys():
    words = {(binding.command, binding.help) for binding in BINDINGS}
    assert all((entry.request.command, entry.text) in words for entry in ENTRIES[2:])
    assert [entry.request.command for entry in ENTRIES[2:]] == list(OFFERED)


def test_the_chosen_model_is_marked():
    assert [entry.is_chosen for entry in ENTRIES[:2]] == [False, True]


@pytest.mark.parametrize("corner", [(0, 0), (639, 0), (0, 479), (639, 479)])
def test_every_row_can_be_chosen_wherever_it_was_opened(corner):
    left, top, width, height = plate(opened(*corner))
    assert min(left, top) >= 0
    assert left + width <= SIZE[0]
    assert top + height <= SIZE[1]
    found = set()
    for share in (0.2, 0.8):  # of two columns, from left to right
        for row in range(top, top + height, 6):
            menu = opened(*corner)
            found.add(request := chosen_at(left + share * width, row, menu))
            assert menu.is_open is (request is None)
    assert found - {None} == {entry.request for entry in ENTRIES}


@pytest.mark.parametrize("size", [(200, 150), (320, 240), (240, 60)])
def test_in_a_small_window_the_last_row_goes_on_to_the_entries_that_have_no_room(size: tuple[int, int]):
    found, pages, shown = [], 0, opened(0, 0, size)
    while True:
        left, top, width, height = plate(shown, size)
        assert min(left, top) >= 0
        assert left + width <= size[0]
        assert top + height <= size[1]
        here = len(found)
        for row in range(top, top + height, 2):
            menu = copy.copy(shown)
            request = chosen_at(left + 0.3 * width, row, menu, size)
            if request is not None and request not in found:
                found.append(request)
        assert len(found) > here
        pages += 1
        if len(found) == len(ENTRIES):
            break
        # A press on the last row shows the next page, and asks for nothing.
        assert chosen_at(left + 0.3 * width, top + height - 8, shown, size) is None
        assert shown.is_open
    assert pages > 1
    assert found == [entry.request for entry in ENTRIES]


@pytest.mark.parametrize("size", [SIZE, (1280, 720), (1920, 1080)])
def test_the_picture_stays_in_view_beside_it(size: tuple[int, int]):
    menu, entries = Menu(), entries_for(("cube", "goblet", "lantern", "mug", "tree"), 1)
    menu.take_mouse(MouseEvent(MENU, 0, 0), lambda: entries, Screen(size))
    _, _, width, height = plate(menu, size)
    assert width * height < 0.6 * size[0] * size[1]
    assert height < 0.8 * size[1]


@pytest.mark.parametrize("size", [SIZE, (1280, 720), (1000, 2000)])
@pytest.mark.parametrize("opened_at", [(0.0, 0.0), (0.3, 0.2), (1.0, 1.0)])
def test_what_is_pointed_at_is_what_is_brighter(size: tuple[int, int], opened_at: tuple[float, float]):
    x_px, y_px = (share * side for share, side in zip(opened_at, size, strict=True))
    for x in np.linspace(1, size[0] - 1, 5):
        for y in np.linspace(1, size[1] - 1, 60):
            menu = opened(x_px, y_px, size)
            menu.take_mouse(MouseEvent(MOVED, x, y), lambda: ENTRIES, Screen(size))
            bars = menu.overlays(Screen(size))[1:]
            wanted = chosen_at(x, y, menu, size) if menu.is_open and bars else None
            assert bool(bars) == (wanted is not None)
            for bar in bars:
                assert 0 <= x - bar.left_px < bar.shown_size[0]
                assert 0 <= y - bar.top_px < bar.shown_size[1]


def test_whatever_a_key_asks_for_without_saying_how_much_is_offered():
    """But for the models beside the one that is shown, which are there by name, and the end."""
    by_name = {Command.PREVIOUS_MODEL, Command.NEXT_MODEL}
    assert {each.command for each in BINDINGS if not each.arguments} - by_name - {Command.LEAVE} == set(OFFERED)


def test_it_opens_at_the_pointer_where_there_is_room():
    assert plate(opened(300, 100, (1920, 1080)), (1920, 1080))[:2] == (300, 100)


def test_opened_again_it_is_drawn_where_the_pointer_is_then():
    size = (1920, 1080)
    menu = opened(300, 100, size)
    before = plate(menu, size)
    menu.take_mouse(MouseEvent(MENU, 500, 50), lambda: ENTRIES, Screen(size))
    assert plate(menu, size) == (500, 50, *before[2:])


def test_it_stands_in_one_column_where_the_window_is_high_and_is_as_large_on_a_dense_screen():
    high, wide = (plate(opened(0, 0, size), size) for size in ((1000, 2000), (1280, 720)))
    assert high[3] > 1.8 * wide[3]
    assert high[2] < 0.6 * wide[2]
    menu, dense = Menu(), Screen((2000, 4000), 2.0)
    menu.take_mouse(MouseEvent(MENU, 0, 0), lambda: ENTRIES, dense)
    (overlay,) = menu.overlays(dense)
    np.testing.assert_allclose(overlay.shown_size, 2 * np.array(high[2:]), rtol=0.05)


def test_its_letters_are_of_the_usual_size_where_there_is_room_and_not_much_smaller_where_there_is_less():
    usual = 1.3 * FONT_PT * -(-len(ENTRIES) // 2)  # of two columns
    heights = [plate(opened(0, 0, size), size)[3] for size in ((1920, 1080), (1280, 720), SIZE)]
    assert min(heights[:2]) > usual
    assert heights[2] > 0.8 * usual


@pytest.mark.parametrize("beside", [(5, None), (None, 5), (-60, None), (None, -60)], ids=str)
def test_a_press_beside_it_closes_it_and_reaches_nothing_below(beside: tuple[int | None, int | None]):
    size = (1280, 720)
    menu = opened(100, 80, size)
    left, top, *extent = plate(menu, size)
    x, y = (
        begin + (length / 2 if by is None else by if by < 0 else length + by)
        for begin, length, by in zip((left, top), extent, beside, strict=True)
    )
    assert chosen_at(x, y, menu, size) is None
    assert not menu.is_open
    assert not menu.take_mouse(MouseEvent(PRESSED, 1, 1), lambda: ENTRIES, Screen(size))


def test_a_press_on_its_rim_asks_for_nothing_and_leaves_it_open():
    menu = opened()
    left, top, width, height = plate(menu)
    for x, y in ((left + width / 2, top + 1), (left + width - 1, top + height - 1)):
        assert chosen_at(x, y, menu) is None
        assert menu.is_open


def test_while_it_is_closed_the_mouse_is_the_picture_s():
    menu = Menu()
    assert not any(
        menu.take_mouse(MouseEvent(action, 5, 5), lambda: ENTRIES, Screen(SIZE))
        for action in (MOVED, PRESSED, RELEASED)
    )


def test_a_drag_that_it_interrupts_ends_with_its_button():
    """Opened while the left button is down: else the drag would go on, with no button down, once it is closed."""
    menu = opened()
    assert not menu.take_mouse(MouseEvent(RELEASED, 60, 60), lambda: ENTRIES, Screen(SIZE))
    assert menu.is_open


def test_the_row_under_the_pointer_is_brighter():
    menu = opened()
    left, top, width, height = plate(menu)
    assert len(menu.overlays(Screen(SIZE))) == 1
    menu.take_mouse(MouseEvent(MOVED, left + width / 2, top + height / 2), lambda: ENTRIES, Screen(SIZE))
    _, bar = menu.overlays(Screen(SIZE))
    assert bar.top_px <= top + height / 2 < bar.top_px + bar.shown_size[1]
    assert menu.overlays(Screen(SIZE)) is menu.overlays(Screen(SIZE))


@pytest.mark.parametrize("models", [("mug",), ("mug", "tree")], ids=["an odd number", "an even number"])
def test_two_columns_share_the_plate_between_their_letters_and_beside_the_last_row_is_nothing(models):
    entries, size = entries_for(models, 0), (1280, 720)
    menu = Menu()
    menu.take_mouse(MouseEvent(MENU, 0, 0), lambda: entries, Screen(size))
    left, top, width, height = plate(menu, size)
    bars = {}
    for y in range(top + 1, top + height, 4):
        for share in (0.02, 0.98):
            menu.take_mouse(MouseEvent(MOVED, left + share * width, y), lambda: entries, Screen(size))
            for bar in menu.overlays(Screen(size))[1:]:
                bars[bar.left_px, bar.top_px] = bar.shown_size
    assert len(bars) == len(entries)
    begins = sorted({x for x, _ in bars})
    assert {(x, x + bars[x, y][0]) for x, y in bars} == {(left, begins[1]), (begins[1], left + width)}
    between = menu.overlays(Screen(size))[0].image_rgba[height // 4 : height // 2, begins[1] - left]
    assert (between == between[0]).all(), "no letter lies on the border"


def test_opened_again_no_row_is_brighter_before_the_pointer_moves():
    menu = opened()
    left, top, width, height = plate(menu)
    menu.take_mouse(MouseEvent(MOVED, left + width / 2, top + height / 2), lambda: ENTRIES, Screen(SIZE))
    menu.take_mouse(MouseEvent(MENU, 50, 40), lambda: ENTRIES, Screen(SIZE))
    assert len(menu.overlays(Screen(SIZE))) == 1


def test_it_goes_when_the_window_changes_its_size():
    menu = opened()
    assert menu.overlays(Screen((800, 600))) == ()
    assert not menu.take_mouse(MouseEvent(MOVED, 60, 60), lambda: ENTRIES, Screen((800, 600)))
    assert not menu.is_open


@pytest.mark.parametrize("size", [(1, 1), (64, 48), (10_000, 30)])
def test_no_window_is_too_small(size):
    menu = opened(0, 0, size)
    assert np.isfinite(plate(menu, size)).all()


def test_entries_are_asked_for_only_when_it_opens():
    asked = []

    def entries():
        asked.append(True)
        return ENTRIES

    menu = Menu()
    for action in (MOVED, PRESSED, RELEASED, MENU, MOVED, PRESSED, RELEASED):
        menu.take_mouse(MouseEvent(action, 60, 60), entries, Screen(SIZE))
    assert len(asked) == 1


def test_names_of_any_length_and_number_are_offered_up_to_the_keys_there_are():
    many = entries_for(tuple(f"model {number}" for number in range(40)), 39)
    assert sum(entry.request.command is Command.CHOOSE_MODEL for entry in many) == 9


@pytest.mark.parametrize("size", [SIZE, (1280, 720)])
def test_a_long_name_is_cut_and_leaves_the_menu_as_large(size):
    """In letters that small windows had no room for, none of the menu could be read."""
    name = "wooden_chair_" * 19 + "final.glb"
    menu, entries = Menu(), entries_for((name, "tree"), 1)
    assert name.startswith(entries[0].text[:16])
    assert entries[0].text.endswith("final.glb")
    menu.take_mouse(MouseEvent(MENU, 0, 0), lambda: entries, Screen(size))
    _, _, width, height = plate(menu, size)
    assert width <= size[0]
    assert height > 0.9 * plate(opened(0, 0, size), size)[3]
