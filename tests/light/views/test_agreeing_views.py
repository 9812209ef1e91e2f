"""Which views show the same scene: by pictures painted with and without a change."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.view import View
from ashe_live.light.views.agreeing_views import WIDTH_PX, agreeing
from tests.light.painted_scenes import BOX, Caster
from tests.light.painted_views import painted_from, true_box
from tests.light.synthetic_masks import direction

LIGHT = np.array([[*direction(200, 40), 0.0]])


def seen_from(heading_deg: float, *casters: Caster, **how: Any) -> TrackedFrame:
    return painted_from(heading_deg, *casters, **how).tracked


def agree(*others: TrackedFrame, ground: str = "plain") -> list[bool]:
    views = [View.of(each, WIDTH_PX) for each in (seen_from(90, BOX, ground=ground), *others)]
    return agreeing(views, true_box(), LIGHT)


@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_an_unmoved_scene_agrees_from_everywhere(ground: str) -> None:
    others = [seen_from(heading, BOX, ground=ground, seed=i) for i, heading in enumerate((60, 80, 105, 130))]
    assert agree(*others, ground=ground) == [True] * 4


@pytest.mark.parametrize("exposure", [0.6, 1.4])
def test_another_exposure_is_no_other_scene(exposure: float) -> None:
    assert agree(seen_from(105, BOX, exposure=exposure)) == [True]


@pytest.mark.parametrize("change", [{"azimuth_deg": 222.0}, {"azimuth_deg": 20.0}, {"elevation_deg": 55.0}])
def test_another_light_is_another_scene(change: dict[str, float]) -> None:
    assert agree(seen_from(105, BOX, **change)) == [False]


def test_a_moved_object_is_another_scene() -> None:
    moved = dataclasses.replace(BOX, at=(0.15, 0.0))
    assert agree(seen_from(105, moved)) == [False]
    assert agree(seen_from(105)) == [False]  # taken away


def test_a_moved_marker_is_another_scene() -> None:
    # The print slides by 3 cm: seen from it, everything else does.
    away = dataclasses.replace(BOX, at=(BOX.at[0], BOX.at[1] - 0.03))
    assert agree(seen_from(105, away)) == [False]
