import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.render import hud
from ashe_live.render.hud import Hud, HudText
from ashe_live.render.scene import Overlay, Scene
from ashe_live.render.screen import Screen

TEXT = HudText(("60 fps", "light 120° / 35° ± 4°"), ("H help",), (("Space", "estimate the light"), ("Esc", "quit")))


def test_same_text_is_not_uploaded_again(make_renderer, stage) -> None:
    renderer, hud = make_renderer(), Hud()
    tracked = stage.tracked(150, None)
    changed = HudText(("59 fps",), TEXT.hint, TEXT.help)
    held = []
    for text in (TEXT, TEXT, TEXT, changed):
        renderer.render(Scene(tracked, overlays=hud.overlays(text, Screen((480, 360)))))
        held.append({texture for _, texture in renderer.overlays._textures.values()})
    assert len(held[0]) == 3
    assert held[0] == held[1] == held[2]
    assert len(held[3] - held[2]) == 1


@pytest.mark.parametrize("value", [0, 128, 255])
def test_text_is_legible_on_any_video(make_renderer, stage, value: int) -> None:
    """Contrast of the brightest letters to the plate at least 4.5 to 1 (WCAG 2.1, 1.4.3)."""
    renderer = make_renderer()
    (plate,) = Hud().overlays(HudText(("light 120° / 35° ± 4°",)), Screen((480, 360)))
    renderer.render(Scene(stage.tracked(value, None), overlays=(plate,)))
    width, height = plate.shown_size
    shown = renderer.read_bgr()[plate.top_px : plate.top_px + height, plate.left_px : plate.left_px + width]
    luminance = LINEAR_FROM_SRGB_8BIT[shown[..., ::-1]] @ REC709_LUMINANCE
    letters, background = np.percentile(luminance, (99, 30))
    assert (letters + 0.05) / (background + 0.05) >= 4.5


LONG = HudText(
    ("60 fps   lantern   auto (balanced)", "marker: 0.02 px", "no clear light: " + "a reason that goes on " * 4),
    ("what helps: " + "this and that, " * 6, "recording ashe-live-2026-01-01-12-00-00.mp4: V stops"),
)
HELP = HudText(help=tuple((f"key {number}", "does something that takes a while to say") for number in range(26)))
SIZES = [(320, 240), (480, 360), (640, 360), (1280, 720), (1366, 768), (3840, 2160)]


@pytest.mark.parametrize("content_scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("text", [TEXT, LONG, HELP])
@pytest.mark.parametrize("size", SIZES)
def test_no_text_is_cut_and_none_lies_on_other_text(size: tuple[int, int], text: HudText, content_scale: float) -> None:
    corners = HudText(text.status, text.hint)
    for shown, free_width in ((corners, size[0]), (corners, round(0.6 * size[0])), (HudText(help=text.help), size[0])):
        overlays = Hud().overlays(shown, Screen(size, content_scale), free_width)
        assert len(overlays) == bool(shown.status) + bool(shown.hint) + bool(shown.help)
        for overlay in overlays:
            width, height = overlay.shown_size
            assert 0 <= overlay.left_px <= overlay.left_px + width <= free_width
            assert 0 <= overlay.top_px <= overlay.top_px + height <= size[1]
        if len(overlays) == 2:
            status, hint = overlays
            assert status.top_px + status.shown_size[1] <= hint.top_px


def test_a_line_is_broken_before_its_letters_become_smaller() -> None:
    (short,) = Hud().overlays(HudText(("a word",)), Screen((640, 480)))
    (broken,) = Hud().overlays(HudText(("a word " * 24,)), Screen((640, 480)))
    lines, rest = divmod(broken.shown_size[1] - short.shown_size[1], 20)
    assert lines >= 1
    assert rest == 0


@pytest.mark.parametrize("scale", [1, 2])
def test_letters_are_smaller_in_a_small_window_of_which_text_would_cover_half(scale: int) -> None:
    """And no smaller than can be read as well, nor of another size when a line comes."""
    lines = ("the marker is not found: if another one is there, name it with --marker,", "such as one of your own")
    for width, height, font_pt in ((480, 360, 11.25), (400, 300, 11), (640, 480, 15), (1280, 480, 15), (640, 320, 11)):
        screen = Screen((scale * width, scale * height), scale)
        for hint in ((), lines):
            blocks = hud._blocks(HudText(("60 fps   model: cube",), hint), screen, screen.size)
            assert {block.font_px for block in blocks} == {scale * font_pt}


def test_the_time_for_a_line_grows_with_it_and_not_with_its_square(monkeypatch) -> None:
    """What is measured is counted in letters: eight times the words, at most ten times as many."""
    measured = 0
    extent = hud._extent

    def counted(rows, font_px):
        nonlocal measured
        measured += sum(len(cell) for row in rows for cell in row)
        return extent(rows, font_px)

    monkeypatch.setattr(hud, "_extent", counted)
    few, many = [], []
    for words, sums in ((500, few), (4000, many)):
        measured = 0
        assert " ".join(hud._wrapped("word " * words, 15, 600)) == "word " * words
        sums.append(measured)
    assert many[0] < 10 * few[0]


@pytest.mark.parametrize("line", ["", "  60 fps   cube ", "a " + "folder/" * 60 + "a.glb is not there", "w" * 500])
def test_nothing_of_a_line_is_lost_when_it_is_broken(line: str) -> None:
    parts = hud._wrapped(line, 15, 300)
    assert "".join(parts).replace(" ", "") == line.replace(" ", "")
    assert all(hud._extent(((part,),), 15)[0] <= 300 for part in parts)
    assert all(word in line for part in parts for word in part.split(" "))


@pytest.mark.parametrize("width", [120, 160, 200, 240, 280])
def test_no_number_is_parted_from_its_sign_and_no_key_from_what_it_does(width: int) -> None:
    line = "60 fps   balanced   H: keys, elevation 42° ± 1.0°, 98 % sure, light: 83 % of the red, P goes on"
    parts = hud._wrapped(line, 15, width)
    assert " ".join(parts).split() == line.split()
    for whole in ("H: keys", "42° ± 1.0°,", "98 %", "83 %", "P goes on"):
        assert any(whole in part for part in parts)


def test_no_part_of_a_broken_line_is_indented() -> None:
    _, *rest = hud._wrapped("60 fps   lantern (2 of 2)   balanced   paused   H: keys", 15, 120)
    assert rest
    assert all(part == part.lstrip() for part in rest)


HOSTILE = {
    "many words": "word " * 300_000,
    "a long word": "w" * 1_500_000,
    "control characters": "\x1b[2J\x00\x07\r\n",
    "another direction": "\u202egnp.exe\u2066",
    "lines within a line": "one\u2028two\x85three\nfour",
    "half characters": "name-\udcff.glb",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_whatever_a_file_says_fits_on_the_picture(name: str) -> None:
    status, hint = Hud().overlays(HudText((HOSTILE[name],), ("choose another",)), Screen((640, 480)))
    width, height = status.shown_size
    assert status.left_px + width <= 640
    assert status.top_px + height <= hint.top_px


@pytest.mark.parametrize("columns", [1, 3])
def test_each_row_is_written_below_the_one_before_and_each_cell_in_its_column(columns: int) -> None:
    """The same words in every row but one, which has none: what is written repeats, and nothing is written there."""
    words = ("Hx", "wide words", "Hy")[:columns]
    rows = words, ("",) * columns, words, ("i", *words[1:])
    layout = hud.row_layout(rows, 15.0)
    ink = hud.rows_plate(rows, 15.0)[..., 0] > 2 * hud.PLATE_SRGBA[0]
    assert ink.shape[::-1] == layout.size
    inside = ink[layout.padding : -layout.padding]
    first, empty, third, last = (inside[row * layout.line : (row + 1) * layout.line] for row in range(4))
    assert not empty.any()
    np.testing.assert_array_equal(third, first)
    begin = layout.padding
    for place, width in enumerate(layout.column_widths):
        (across,) = np.nonzero(first[:, begin - 2 : begin + width + 2].any(axis=0))
        assert across[0] < 5
        assert across[-1] > hud.text_width(words[place], 15.0) - 3
        begin += width + layout.column_gap
    if columns > 1:
        beside = layout.padding + layout.column_widths[0] + layout.column_gap // 2
        np.testing.assert_array_equal(last[:, beside:], first[:, beside:])


@pytest.mark.parametrize("count", [1, 2, 7, 8])
def test_rows_in_two_columns_are_all_rows(count: int) -> None:
    rows = tuple((f"key {number}", f"does {number}") for number in range(count))
    halves = hud.in_two(rows)
    assert len(halves) == (count + 1) // 2
    in_order = [*(row[:2] for row in halves), *(row[2:] for row in halves)]
    assert [row for row in in_order if any(row)] == list(rows)


def test_letters_are_no_smaller_than_they_have_to_be() -> None:
    rows = (("word " * 20,),) * 3
    (plate,) = Hud().overlays(HudText(help=rows), Screen((2000, 1000)))
    width, height = plate.shown_size
    for has_room, least in ((1.02, 1.0), (0.9, 0.84)):
        size = round(has_room * (width + 16)), height + 16
        (fitted,) = Hud().overlays(HudText(help=rows), Screen(size))
        assert least * width <= fitted.shown_size[0] <= size[0]


@pytest.mark.parametrize("size", [(1, 1), (12, 300), (300, 12)])
def test_no_window_is_too_small_for_words_to_be_laid_out(size: tuple[int, int]) -> None:
    assert len(Hud().overlays(HudText(("word " * 3,), ("hint",)), Screen(size))) == 2


def test_a_line_that_the_window_has_room_for_is_not_broken() -> None:
    (short,), (long,) = (Hud().overlays(HudText((words,)), Screen((1280, 720))) for words in ("a word", "a word " * 20))
    assert long.shown_size[0] > 720
    assert long.shown_size[1] == short.shown_size[1]


def test_help_stands_in_two_halves_where_it_is_too_long_for_one() -> None:
    (tall,) = Hud().overlays(HELP, Screen((1280, 800)))
    (wide,) = Hud().overlays(HELP, Screen((1280, 400)))
    assert tall.shown_size[1] > 1.9 * wide.shown_size[1] - 40
    assert wide.shown_size[0] > 1.9 * tall.shown_size[0] - 40


@pytest.mark.parametrize(
    ("size", "said", "scale"), [((1280, 720), 1, 1), ((3840, 2160), 1, 2), ((3840, 2160), 2.5, 2.5)]
)
def test_letters_follow_the_picture_where_the_display_does_not_say(size, said, scale) -> None:
    assert Screen.readable(size, said) == Screen(size, scale)


def test_letters_grow_with_the_displays_scale() -> None:
    (small,), (large,) = (Hud().overlays(HudText(("60 fps",)), Screen((2560, 1440), scale)) for scale in (1.0, 2.0))
    assert large.shown_size[1] == pytest.approx(2 * small.shown_size[1], abs=3)


def test_nothing_to_say_is_nothing_to_draw() -> None:
    assert Hud().overlays(HudText(), Screen((480, 360))) == ()


def test_overlay_lies_where_it_says_pixel_by_pixel(make_renderer, stage) -> None:
    rgba = np.random.default_rng(5).integers(0, 256, (20, 30, 4), dtype=np.uint8)
    rgba[..., 3] = 255
    picture = stage.picture(make_renderer(), Scene(stage.tracked(7, None), overlays=(Overlay(rgba, 40, 50),)))
    np.testing.assert_array_equal(picture[50:70, 40:70, ::-1], rgba[..., :3])
    picture[50:70, 40:70] = 7
    assert (picture == 7).all()


def test_inset_is_scaled_to_its_size_and_overlays_stack(make_renderer, stage) -> None:
    white, black = (np.full((10, 10, 4), value, dtype=np.uint8) for value in (255, 0))
    black[..., 3] = 255
    inset, spot = Overlay(white, 100, 100, (200, 100)), Overlay(black, 150, 120)
    picture = stage.picture(make_renderer(), Scene(stage.tracked(7, None), overlays=(inset, spot)))
    assert (picture == 255).all(axis=2).sum() == 200 * 100 - 100
    assert not picture[120:130, 150:160].any()


def test_overlay_of_another_kind_is_wrong_use() -> None:
    with pytest.raises(ValueError, match=r"\(h, w, 4\) uint8"):
        Overlay(np.zeros((4, 4, 3), np.uint8), 0, 0)
