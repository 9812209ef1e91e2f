"""Where the time bar's parts are and what it says."""

from itertools import pairwise

import numpy as np
import pytest

from ashe_live.render.screen import Screen
from ashe_live.viewer.drawn.time_bar import Moment, TimeBar, bar_at, clock, text_of

PLACES = [
    ((320, 240), 1.0),
    ((640, 480), 1.0),
    ((1920, 1080), 1.0),
    ((3840, 2160), 2.0),
    ((480, 640), 2.0),
    ((40, 30), 1),
]


@pytest.mark.parametrize(("size", "scale"), PLACES)
def test_it_lies_at_the_bottom_and_inside(size, scale):
    plate, text, *line = TimeBar().overlays(Moment(3.0, 7.0, 90, 0.25, True), Screen(size, scale))
    assert (plate.left_px, plate.top_px + plate.shown_size[1], plate.shown_size[0]) == (0, size[1], size[0])
    if size[0] < 100:
        return
    for part in (text, *line):
        assert plate.top_px <= part.top_px
        assert part.top_px + part.shown_size[1] <= size[1]
        assert 0 <= part.left_px <= part.left_px + part.shown_size[0] <= size[0]
    assert text.left_px + text.shown_size[0] <= line[0].left_px
    assert line[0].shown_size[0] > 0.25 * size[0]


@pytest.mark.parametrize(("size", "scale"), PLACES)
def test_a_click_goes_to_where_the_knob_then_stands(size, scale):
    screen = Screen(size, scale)
    bar = bar_at(screen, 10.0)
    for x_px in np.linspace(bar.left, bar.right, 7):
        *_, rest, played, knob = TimeBar().overlays(Moment(10 * bar.share_at(x_px), 10.0), screen)
        assert played.left_px == rest.left_px == bar.left
        assert rest.left_px + rest.shown_size[0] == bar.right
        assert played.left_px + played.shown_size[0] == pytest.approx(x_px, abs=1)
        assert knob.left_px + knob.shown_size[0] // 2 == pytest.approx(x_px, abs=1)
    assert (bar.share_at(-1e6), bar.share_at(1e6)) == (0, 1)


@pytest.mark.parametrize("minutes", [2, 45, 200])
@pytest.mark.parametrize(("size", "scale"), [((400, 300), 1.0), ((1280, 720), 1.0), ((3840, 2160), 2.0)])
def test_the_longest_text_of_a_long_clip_ends_before_the_line(size, scale, minutes):
    last = Moment(60.0 * minutes, 60.0 * minutes, 60 * 60 * minutes, 0.25, True)
    _, text, *line = TimeBar().overlays(last, Screen(size, scale))
    ink = np.flatnonzero(text.image_rgba[..., 3].any(axis=0))
    assert text.left_px + ink[-1] < min(part.left_px for part in line[:2])


def test_only_a_wide_window_says_more_than_the_time_and_there_the_pointer_is_near_a_little_above_the_bar():
    moment, widths = Moment(3.0, 7.0, 90, 0.25, True), []
    for size, scale in (((400, 300), 1.0), ((640, 480), 1.0), ((800, 600), 2.0)):
        screen = Screen(size, scale)
        plate, text, *_ = TimeBar().overlays(moment, screen)
        widths.append(text.shown_size[0] / scale)
        bar = bar_at(screen, 7.0)
        near = [bar.is_near(y) for y in (plate.top_px - 30 * scale, plate.top_px - 10 * scale, size[1] - 1)]
        assert near == [False, True, True]
    assert widths[1] > 2 * widths[0]
    assert widths[2] == pytest.approx(widths[0], rel=0.1)


def test_time_moves_the_knob_and_nothing_is_uploaded_anew():
    bar = TimeBar()
    drawn = [bar.overlays(Moment(second, 9.0), Screen((640, 480))) for second in (2.0, 2.5, 2.9)]
    knobs = [overlays[-1].left_px for overlays in drawn]
    assert all(earlier < later for earlier, later in pairwise(knobs))
    for before, after in pairwise(drawn):
        assert all(a.image_rgba is b.image_rgba for a, b in zip(before, after, strict=True))
    _, text, *_ = bar.overlays(Moment(3.0, 9.0), Screen((640, 480)))
    assert not np.array_equal(text.image_rgba, drawn[0][1].image_rgba), "another second is written"


def test_a_clip_of_one_frame_has_a_bar_too():
    assert TimeBar().overlays(Moment(0.0, 0.0), Screen((640, 480)))


def test_it_says_where_the_picture_is():
    assert text_of(Moment(61.26, 125.0), True) == "1:01 / 2:05"
    assert text_of(Moment(61.26, 125.0, 1838), True) == "1:01.2 / 2:05.0   frame 1838"
    assert text_of(Moment(61.26, 125.0, 1838, 0.25, True), True) == "1:01.2 / 2:05.0   frame 1838   0.25x loop"
    assert text_of(Moment(61.26, 125.0, 1838, 0.25, True), False) == "1:01.2 / 2:05.0"
    assert (clock(59.99, False), clock(59.99, True), clock(0.3, True)) == ("0:59", "0:59.9", "0:00.3")


def test_a_bar_that_stands_still_is_the_same_objects():
    bar = TimeBar()
    first = bar.overlays(Moment(3.0, 7.0, 90), Screen((640, 480)))
    assert bar.overlays(Moment(3.0, 7.0, 90), Screen((640, 480))) is first
    assert bar.overlays(Moment(3.1, 7.0, 93), Screen((640, 480))) is not first
