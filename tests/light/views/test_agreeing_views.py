"""Which views show the same scene: by pictures painted with and without a change."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.view import View
from ashe_live.light.views.agreeing_views import WIDTH_PX, agreeing
from tests.light.painted_scenes import BOX, paint
from tests.light.synthetic_masks import camera_towards, direction

LIGHT = np.array([[*direction(200, 40), 0.0]])


def painted_from(heading_deg: float, caster=BOX, **rest) -> TrackedFrame:
    pose = camera_towards((0.06, 0.0), 0.5, 45.0, heading_deg)
    return paint(caster, T_cam_marker=pose, size=(480, 360), **rest).tracked


def true_body() -> Proxy:
    corners = np.concatenate([BOX.base(), BOX.top()])
    return Proxy("box", np.column_stack([corners, np.zeros((len(corners), 2))]))


def agree(*others: TrackedFrame, ground: str = "plain") -> list[bool]:
    views = [View.of(each, WIDTH_PX) for each in (painted_from(90, ground=ground), *others)]
    return agreeing(views, true_body(), LIGHT)


@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_an_unmoved_scene_agrees_from_everywhere(ground: str) -> None:
    others = [painted_from(heading, ground=ground, seed=i) for i, heading in enumerate((60, 80, 105, 130))]
    assert agree(*others, ground=ground) == [True] * 4


@pytest.mark.parametrize("exposure", [0.6, 1.4])
def test_another_exposure_is_no_other_scene(exposure: float) -> None:
    assert agree(painted_from(105, exposure=exposure)) == [True]


@pytest.mark.parametrize("change", [{"azimuth_deg": 222.0}, {"azimuth_deg": 20.0}, {"elevation_deg": 55.0}])
def test_another_light_is_another_scene(change: dict[str, float]) -> None:
    assert agree(painted_from(105, **change)) == [False]


def test_a_moved_object_is_another_scene() -> None:
    moved = dataclasses.replace(BOX, at=(0.15, 0.0))
    assert agree(painted_from(105, moved)) == [False]
    taken_away = paint(T_cam_marker=camera_towards((0.06, 0.0), 0.5, 45.0, 105), size=(480, 360)).tracked
    assert agree(taken_away) == [False]


def test_a_moved_marker_is_another_scene() -> None:
    # The print slides by 3 cm: seen from it, everything else does.
    away = dataclasses.replace(BOX, at=(BOX.at[0], BOX.at[1] - 0.03))
    assert agree(painted_from(105, away)) == [False]
