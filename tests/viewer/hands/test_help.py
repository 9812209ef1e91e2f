"""The table of keys in windows of any size."""

import pytest

from ashe_live.render.hud import Hud, HudText
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.controls import help_rows
from ashe_live.viewer.hands.help import LEGIBLE_PT, Help

SIZES = [(200, 150), (300, 225), (225, 300), (320, 240), (480, 270), (640, 480), (1920, 1080)]


def turned_through(screen) -> list:
    help, pages = Help(), []
    help.turn()
    while help.is_shown:
        pages.append(help.rows(screen))
        help.turn()
    return pages


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("size", SIZES)
def test_every_key_is_on_one_of_the_pages_and_every_page_inside_the_window(size, scale):
    pages = turned_through(Screen(size, scale))
    rows = [row for page in pages for row in page]
    assert [row for row in rows if row in help_rows()] == list(help_rows())
    for page in pages:
        (plate,) = Hud().overlays(HudText(help=page), Screen(size, scale))
        width, height = plate.shown_size
        assert 0 <= plate.left_px <= size[0] - width
        assert 0 <= plate.top_px <= size[1] - height


def test_pages_have_letters_that_can_be_read_and_a_large_window_needs_one():
    assert len(turned_through(Screen((640, 480)))) == 1
    pages = turned_through(Screen((300, 225)))
    assert 1 < len(pages) < 6
    for page in pages:
        (plate,) = Hud().overlays(HudText(help=page), Screen((300, 225)))
        assert plate.shown_size[1] >= 1.35 * LEGIBLE_PT * len(page)
    assert all("next" in page[-1][1] for page in pages[:-1])
    assert "next" not in pages[-1][-1][1]


def test_pages_are_numbered_and_come_again_from_the_first_however_the_help_was_left():
    screen, help = Screen((300, 225)), Help()
    pages = turned_through(screen)
    numbers = [page[-1][1].split(":")[0] for page in pages[:-1]]
    assert numbers == [f"page {number} of {len(pages)}" for number in range(1, len(pages))]
    help.turn()
    help.rows(screen)
    help.turn()
    assert help.rows(screen) == pages[1]
    help.close()
    assert not help.is_shown
    for _ in range(2):
        for page in pages:
            help.turn()
            assert help.rows(screen) == page
        help.turn()
        assert not help.is_shown


def test_a_window_that_grows_shows_all_and_the_key_hides_it():
    help = Help()
    help.turn()
    help.rows(Screen((300, 225)))
    help.turn()
    assert help.rows(Screen((1280, 720))) == help_rows()
    help.turn()
    assert not help.is_shown
