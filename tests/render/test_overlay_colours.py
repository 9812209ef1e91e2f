"""What the overlays say by colour is seen by everybody: also by those who do not see all colours, and on any video."""

from itertools import combinations

import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.light import Illumination
from ashe_live.drawing import colours
from ashe_live.models.primitives import box
from ashe_live.render import hud
from ashe_live.render.scene import Scene

# Linear RGB as a person without that kind of cone sees it: Machado, Oliveira and Fernandes, "A Physiologically-based
# Model for Simulation of Color Vision Deficiency", IEEE TVCG 15(6), 2009, severity 1.
SEEN_BY = {
    "most": np.eye(3),
    "protanopes": np.array(
        [(0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)]
    ),
    "deuteranopes": np.array(
        [(0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.01182, 0.04294, 0.968881)]
    ),
    "tritanopes": np.array(
        [(1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.3039)]
    ),
}
XYZ_FROM_RGB = np.array(
    [(0.4124564, 0.3575761, 0.1804375), (0.2126729, 0.7151522, 0.072175), (0.0193339, 0.119192, 0.9503041)]
)
D65 = np.array((0.95047, 1.0, 1.08883))
# CIE 1976 difference; 2.3 is just noticeable side by side.
TOLD_APART = 30
# Web Content Accessibility Guidelines 2.1: 1.4.3 text, 1.4.11 graphical objects.
TEXT_CONTRAST, GRAPHICS_CONTRAST = 4.5, 3.0
TOGETHER = {
    "object, its shadow and the light": (colours.OBJECT_BGR, colours.SHADOW_BGR, colours.LIGHT_BGR),
    "not explained and not seen": (colours.UNEXPLAINED_BGR, colours.UNSEEN_BGR),
    "a light and its ellipses": (colours.INK_BGR, colours.SHADOW_BGR, colours.PAPER_BGR),
}


def linear(bgr: tuple[int, ...]) -> np.ndarray:
    return LINEAR_FROM_SRGB_8BIT[list(bgr[:3])[::-1]]


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIE 1976 L*a*b* of linear RGB."""
    x, y, z = np.cbrt(np.maximum(XYZ_FROM_RGB @ np.clip(rgb, 0, 1) / D65, 216 / 24389))
    return np.array((116 * y - 16, 500 * (x - y), 200 * (y - z)))


def contrast(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    low, high = np.sort(np.broadcast_arrays(one @ REC709_LUMINANCE, other @ REC709_LUMINANCE), axis=0)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("eyes", SEEN_BY)
@pytest.mark.parametrize("together", TOGETHER)
def test_colours_that_are_shown_together_can_be_distinguished(together: str, eyes: str) -> None:
    seen = [lab(SEEN_BY[eyes] @ linear(bgr)) for bgr in TOGETHER[together]]
    assert min(np.linalg.norm(one - other) for one, other in combinations(seen, 2)) > TOLD_APART


def test_the_law_refuses_red_and_green() -> None:
    """Of the same lightness, which is what a deuteranope takes for one colour."""
    red, green = (lab(SEEN_BY["deuteranopes"] @ linear(bgr)) for bgr in ((60, 70, 200), (60, 130, 100)))
    assert np.linalg.norm(red - green) < TOLD_APART


@pytest.mark.parametrize("ink", [colours.INK_BGR, colours.FAINT_BGR])
def test_writing_on_sheets_is_legible(ink: tuple[int, ...]) -> None:
    assert contrast(linear(ink), linear(colours.PAPER_BGR)) >= TEXT_CONTRAST


@pytest.mark.parametrize("video", [0, 128, 255])
def test_writing_on_the_video_is_legible(video: int) -> None:
    *plate, alpha = hud.PLATE_SRGBA
    under = np.round((np.array(plate) * alpha + video * (255 - alpha)) / 255).astype(int)
    assert contrast(linear(hud.TEXT_SRGBA[2::-1]), linear(tuple(under[::-1]))) >= TEXT_CONTRAST


@pytest.mark.parametrize("video", [0, 60, 128, 150, 190, 255])
def test_arrow_stands_out_from_any_video(make_renderer, stage, video: int) -> None:
    """By its middle, or by its rim, which is dark."""
    light, model = stage.light(30, 50), stage.placed(box((0.08, 0.08, 0.1)))
    renderer = make_renderer()
    tracked = stage.tracked(video, stage.pose(30, 40))
    without = stage.picture(renderer, Scene(tracked, model, Illumination((light,))))
    shown = stage.picture(renderer, Scene(tracked, model, Illumination((light,)), True))
    of_arrow = (shown != without).any(axis=2)
    assert of_arrow.sum() > 100
    ratios = contrast(LINEAR_FROM_SRGB_8BIT[shown[of_arrow][:, ::-1]], linear((video,) * 3))
    assert np.percentile(ratios, 90) >= GRAPHICS_CONTRAST
