"""Why there is no answer: what is said must be what is wrong."""

import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.light.no_answer import DARK, NOTHING_THERE, TOO_BRIGHT, TOO_DARK, fault_of_exposure
from ashe_live.light.proxy import ProxyEstimator
from ashe_live.light.view import View
from tests.light.painted_scenes import BOX, Painted, paint

SMALL = (320, 240)


def reason(scene: Painted) -> str | None:
    return ProxyEstimator().estimate(scene.tracked).reason


def fault(image_bgr: Image) -> str | None:
    scene = paint(BOX, size=SMALL)
    scene.tracked.frame.image_bgr.setflags(write=True)
    scene.tracked.frame.image_bgr[:] = image_bgr
    return fault_of_exposure(View.of(scene.tracked, SMALL[0]))


@pytest.mark.parametrize(("exposure", "expected"), [(0.002, TOO_DARK), (30.0, TOO_BRIGHT)])
@pytest.mark.parametrize("ground", ["plain", "checkered"])
def test_a_picture_that_shows_nothing_for_its_exposure_says_so(ground: str, exposure: float, expected: str) -> None:
    assert reason(paint(BOX, ground=ground, size=SMALL, exposure=exposure)) == expected


@pytest.mark.parametrize("exposure", [0.25, 1.0])
def test_exposure_is_not_blamed_for_an_empty_table(exposure: float) -> None:
    assert reason(paint(size=SMALL, exposure=exposure)) == NOTHING_THERE


def test_the_ground_tells_the_exposure_and_its_brightest_channel_the_ground() -> None:
    blue = np.zeros((SMALL[1], SMALL[0], 3), np.uint8)
    blue[..., 0] = 200
    assert fault(blue) is None
    assert fault(np.full_like(blue, DARK - 1)) == TOO_DARK
    assert fault(np.full_like(blue, 255)) == TOO_BRIGHT
    blue[: SMALL[1] // 4] = 255  # a bright window is not the table
    assert fault(blue) is None


def test_a_picture_without_ground_is_not_blamed_for_its_exposure() -> None:
    scene = paint(BOX, size=SMALL)
    view = View.of(scene.tracked, SMALL[0])
    empty = View(view.image_bgr, view.camera, view.T_cam_marker, view.side_m, np.zeros_like(view.is_ground))
    assert fault_of_exposure(empty) is None
