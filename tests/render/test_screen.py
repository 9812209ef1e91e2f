"""How large a point is on a display, and what a strip at the bottom leaves of it."""

import pytest

from ashe_live.render.screen import Screen


@pytest.mark.parametrize(
    ("height_px", "stated", "scale"),
    [
        (480, 1.0, 1.0),  # never smaller than the display says
        (1080, 1.0, 1.0),
        (1349, 1.0, 1.0),  # in quarters, rounded down
        (1350, 1.0, 1.25),
        (2160, 1.0, 2.0),  # 4K on a display that states no scale
        (2160, 3.0, 3.0),
        (2160, 1.5, 2.0),
    ],
)
def test_letters_of_a_picture_that_is_seen_as_a_whole_have_the_size_they_have_on_1080_rows(
    height_px: int, stated: float, scale: float
) -> None:
    assert Screen.readable((100, height_px), stated) == Screen((100, height_px), scale)


def test_lengths_are_rounded_to_whole_pixels() -> None:
    assert [Screen((64, 48), 1.25).px(points) for points in (1, 2, 3, 10)] == [1, 2, 4, 12]


@pytest.mark.parametrize(("size", "is_minimised"), [((0, 0), True), ((0, 9), True), ((9, 0), True), ((1, 1), False)])
def test_a_window_without_a_pixel_is_minimised(size: tuple[int, int], is_minimised: bool) -> None:
    assert Screen(size).is_minimised is is_minimised


def test_above_a_strip_at_the_bottom_there_is_always_a_row() -> None:
    screen = Screen((64, 48), 2.0)
    assert screen.without_bottom(8) == Screen((64, 40), 2.0)
    assert screen.without_bottom(48) == screen.without_bottom(100) == Screen((64, 1), 2.0)
