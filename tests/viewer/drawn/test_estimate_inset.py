"""The inset behind the key D."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.drawing.colours import OBJECT_BGR, SHADOW_BGR
from ashe_live.drawing.steps_sheet import steps_sheet
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.estimators.view_search import Trace
from ashe_live.light.ground.lit_ground import fit_lit_ground
from ashe_live.light.pixels.view import View
from ashe_live.render.scene import Overlay
from ashe_live.viewer.drawn.estimate_inset import EstimateInset, Span, inset_overlays
from ashe_live.viewer.estimates.light_watch import NewAnswer

SIZE = (640, 480)
# A flat disc 10 cm above the marker plane, beside the optical axis; the camera looks straight down from 40 cm.
DISC = Proxy("disc", np.array([[-0.05, 0.0, 0.1, 0.02, 0.0]]))


def drawn(overlay, colour_bgr):
    """(h, w): where the inset, grey elsewhere, is tinted as that colour is: towards blue or towards red."""
    blue_over_red = overlay.image_rgba[:, :, 2].astype(int) - overlay.image_rgba[:, :, 0]
    return blue_over_red * np.sign(colour_bgr[0] - colour_bgr[2]) > 60


def centre_x(overlay, colour_bgr):
    _, x = np.nonzero(drawn(overlay, colour_bgr))
    return (x.min() + x.max()) / 2 / overlay.shown_size[0]


@pytest.fixture
def answer(fakes):
    """The light comes from the right, at 45 degrees; no masks."""
    found = fakes.estimate()
    lit_by = replace(found.illumination, real_object=DISC)
    estimate = replace(found, illumination=lit_by, object_mask=None, shadow_mask=None)
    return NewAnswer(estimate, fakes.tracked(), asked_s=0.0, steps_bgr=None, is_news=True)


def test_body_and_shadow_are_outlined_where_they_are(answer):
    inset, _ = inset_overlays(answer, SIZE)
    focal = 64 / 2 / np.tan(np.radians(30)) / 64  # in widths of the picture
    assert centre_x(inset, OBJECT_BGR) == pytest.approx(0.5 - focal * 0.05 / 0.3, abs=0.03)
    assert centre_x(inset, SHADOW_BGR) == pytest.approx(0.5 - focal * 0.15 / 0.4, abs=0.03)


def test_the_rose_stands_above_the_picture(answer):
    inset, rose = inset_overlays(answer, SIZE)
    assert rose.shown_size[0] == rose.shown_size[1]
    assert rose.top_px + rose.shown_size[1] < inset.top_px
    assert rose.left_px + rose.shown_size[0] == inset.left_px + inset.shown_size[0]


@pytest.mark.parametrize("width", [640, 1800])
def test_a_flat_window_shows_all_of_the_picture_and_no_rose_that_would_be_cut_off(answer, width):
    (inset,) = inset_overlays(answer, (width, 200))
    assert inset.top_px >= 0
    assert inset.shown_size[0] / inset.shown_size[1] == pytest.approx(64 / 48, abs=0.03)


def test_a_trace_is_one_sheet_with_the_answer_in_it(answer):
    trace = Trace(View.of(answer.frozen, 64))

    def sheet_of() -> Overlay:
        steps_bgr = steps_sheet(answer.frozen, answer.estimate, trace)
        (sheet,) = inset_overlays(replace(answer, steps_bgr=steps_bgr), SIZE)
        return sheet

    first = sheet_of()
    trace.ground = fit_lit_ground(trace.view.image_bgr, trace.view.is_ground, BALANCED.ground)
    trace.unlit = np.zeros_like(trace.view.is_ground)
    steps = sheet_of()
    assert first.shown_size[1] < steps.shown_size[1] <= SIZE[1]
    assert drawn(steps, OBJECT_BGR).any()
    for sheet in (first, steps):
        assert sheet.left_px >= SIZE[0] / 2
        assert sheet.left_px + sheet.shown_size[0] <= SIZE[0]
        assert sheet.top_px >= 0
        assert sheet.top_px + sheet.shown_size[1] <= SIZE[1]


def test_without_a_light_there_is_only_the_picture(answer):
    none = LightEstimate("fake", 0, Illumination(), "no shadow found")
    (inset,) = inset_overlays(replace(answer, estimate=none), SIZE)
    assert not drawn(inset, OBJECT_BGR).any()


def covers(overlays, span: Span) -> bool:
    return any(
        overlay.left_px < span.right
        and span.left < overlay.left_px + overlay.shown_size[0]
        and overlay.top_px < span.bottom
        and span.top < overlay.top_px + overlay.shown_size[1]
        for overlay in overlays
    )


@pytest.mark.parametrize(
    "model", [Span(440, 330, 560, 470), Span(440, 20, 560, 160), Span(300, 120, 470, 360), Span(480, 205, 520, 260)]
)
def test_the_inset_leaves_the_model_uncovered(answer, model):
    """In the corner, above it, so near that only a smaller one has room, and between the corners."""
    inset = EstimateInset()
    shown = inset.overlays(answer, SIZE, model)
    assert len(shown) == 2
    assert not covers(shown, model)
    assert inset.overlays(answer, SIZE, model) is shown


def test_an_inset_that_covers_nothing_stays(answer):
    inset = EstimateInset()
    first = inset.overlays(answer, SIZE, None)
    assert inset.overlays(answer, SIZE, Span(0, 0, 100, 480)) is first
    assert inset.overlays(answer, SIZE, Span(480, 5, 600, 60)) is first, "it is above"
    moved = inset.overlays(answer, SIZE, Span(440, 330, 560, 470))
    assert moved is not first
    assert inset.overlays(answer, SIZE, None) is moved


def test_a_model_that_fills_the_window_leaves_the_smallest_inset(answer):
    full = inset_overlays(answer, SIZE)
    shown = EstimateInset().overlays(answer, SIZE, Span(0, 0, *SIZE))
    assert shown[0].shown_size[0] < 0.7 * full[0].shown_size[0]


def test_the_inset_is_that_of_the_last_answer_in_the_window_as_it_is_now(answer):
    inset = EstimateInset()
    shown = inset.overlays(answer, SIZE, None)
    towards = (-1.0, 0.0, 1.0)
    lit_by = replace(answer.estimate.illumination, lights=(Light(towards),))
    other = replace(answer, estimate=replace(answer.estimate, illumination=lit_by))
    for now, size, is_mirrored in ((other, SIZE, False), (other, (800, 600), False), (other, (800, 600), True)):
        before, shown = shown, inset.overlays(now, size, None, is_mirrored)
        assert shown is not before
        for drawn_now, wanted in zip(shown, inset_overlays(now, size, is_mirrored), strict=True):
            assert (drawn_now.left_px, drawn_now.top_px) == (wanted.left_px, wanted.top_px)
            np.testing.assert_array_equal(drawn_now.image_rgba, wanted.image_rgba)
