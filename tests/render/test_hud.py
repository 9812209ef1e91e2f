import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.render.hud import Hud, HudText
from ashe_live.render.scene import Overlay, Scene

TEXT = HudText(("60 fps", "light 120° / 35° ± 4°"), ("H help",), (("Space", "estimate the light"), ("Esc", "quit")))


def test_same_text_is_not_uploaded_again(make_renderer, stage) -> None:
    renderer, hud = make_renderer(), Hud()
    tracked = stage.tracked(150, None)
    for _ in range(3):
        renderer.render(Scene(tracked, overlays=hud.overlays(TEXT, (480, 360))))
    assert renderer.overlays.uploads == 3
    changed = HudText(("59 fps",), TEXT.hint, TEXT.help)
    renderer.render(Scene(tracked, overlays=hud.overlays(changed, (480, 360))))
    assert renderer.overlays.uploads == 4


@pytest.mark.parametrize("value", [0, 128, 255])
def test_text_is_legible_on_any_video(make_renderer, stage, value: int) -> None:
    """Contrast of the brightest letters to the plate at least 4.5 to 1 (WCAG 2.1, 1.4.3)."""
    renderer = make_renderer()
    (plate,) = Hud().overlays(HudText(("light 120° / 35° ± 4°",)), (480, 360))
    renderer.render(Scene(stage.tracked(value, None), overlays=(plate,)))
    width, height = plate.shown_size
    shown = renderer.read_bgr()[plate.top_px : plate.top_px + height, plate.left_px : plate.left_px + width]
    luminance = LINEAR_FROM_SRGB_8BIT[shown[..., ::-1]] @ REC709_LUMINANCE
    letters, background = np.percentile(luminance, (99, 30))
    assert (letters + 0.05) / (background + 0.05) >= 4.5


@pytest.mark.parametrize("content_scale", [1.0, 2.0])
@pytest.mark.parametrize("size", [(480, 360), (1280, 720)])
def test_plates_lie_inside_the_window(content_scale: float, size: tuple[int, int]) -> None:
    for overlay in Hud().overlays(TEXT, size, content_scale):
        width, height = overlay.shown_size
        assert 0 <= overlay.left_px <= overlay.left_px + width <= size[0]
        assert 0 <= overlay.top_px <= overlay.top_px + height <= size[1]


def test_letters_grow_with_the_displays_scale() -> None:
    (small,), (large,) = (Hud().overlays(HudText(("60 fps",)), (1280, 720), scale) for scale in (1.0, 2.0))
    assert large.shown_size[1] == pytest.approx(2 * small.shown_size[1], abs=3)


def test_long_help_shrinks_to_fit_a_small_window() -> None:
    rows = tuple((f"key {number}", "does something that takes a while to explain") for number in range(14))
    (plate,) = Hud().overlays(HudText(help=rows), (400, 280))
    assert plate.shown_size[0] <= 400
    assert plate.shown_size[1] <= 280


def test_nothing_to_say_is_nothing_to_draw() -> None:
    assert Hud().overlays(HudText(), (480, 360)) == ()


def test_overlay_lies_where_it_says_pixel_by_pixel(make_renderer, stage) -> None:
    renderer = make_renderer()
    rgba = np.random.default_rng(5).integers(0, 256, (20, 30, 4), dtype=np.uint8)
    rgba[..., 3] = 255
    renderer.render(Scene(stage.tracked(7, None), overlays=(Overlay(rgba, 40, 50),)))
    picture = renderer.read_bgr()
    np.testing.assert_array_equal(picture[50:70, 40:70, ::-1], rgba[..., :3])
    picture[50:70, 40:70] = 7
    assert (picture == 7).all()


def test_inset_is_scaled_to_its_size_and_overlays_stack(make_renderer, stage) -> None:
    renderer = make_renderer()
    white, black = (np.full((10, 10, 4), value, dtype=np.uint8) for value in (255, 0))
    black[..., 3] = 255
    inset, spot = Overlay(white, 100, 100, (200, 100)), Overlay(black, 150, 120)
    renderer.render(Scene(stage.tracked(7, None), overlays=(inset, spot)))
    picture = renderer.read_bgr()
    assert (picture == 255).all(axis=2).sum() == 200 * 100 - 100
    assert not picture[120:130, 150:160].any()


def test_overlay_of_another_kind_is_wrong_use() -> None:
    with pytest.raises(ValueError, match=r"\(h, w, 4\) uint8"):
        Overlay(np.zeros((4, 4, 3), np.uint8), 0, 0)
