"""A sheet that a shadow falls onto is shown as the ground that it lies on, light and shadow on it; nothing else is."""

from typing import Any

import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import BOX, CYLINDER, SHADOW_RATIO, Caster, Painted, paint
from tests.light.synthetic_masks import camera_towards

LOW = camera_towards((0.0, 0.0), 0.5, 25.0)
BESIDE = Caster(at=(0.115, 0.02))


def shown(scene: Painted) -> View:
    return View.of(scene.tracked, 640).with_paper_as_ground()


def linear_rgb(image_bgr: Image) -> np.ndarray:
    return np.asarray(LINEAR_FROM_SRGB_8BIT[image_bgr][..., ::-1])


@pytest.mark.parametrize("azimuth_deg", [0.0, 12.0, 25.0])
@pytest.mark.parametrize("elevation_deg", [28.0, 38.0])
def test_what_is_shown_is_the_ground_in_light_and_in_shadow(azimuth_deg: float, elevation_deg: float) -> None:
    scene = paint(BESIDE, azimuth_deg=azimuth_deg, elevation_deg=elevation_deg)
    view = shown(scene)
    assert view.is_ground[scene.sheet & ~scene.body].all()
    ground = np.median(linear_rgb(view.image_bgr)[scene.beside_sheet & ~scene.body & ~scene.shadow], axis=0)
    sheet = scene.sheet & ~scene.body
    parts = sheet & ~scene.shadow, sheet & scene.shadow
    lit, shaded = (np.median(linear_rgb(view.image_bgr)[each], axis=0) for each in parts)
    assert lit / ground == pytest.approx(1, rel=0.08)
    assert shaded / ground == pytest.approx(SHADOW_RATIO, rel=0.2)


def test_on_a_whole_page_the_marker_is_shown_as_well() -> None:
    scene = paint(BESIDE, azimuth_deg=12, elevation_deg=30, page_m=(0.105, 0.126, 0.105, 0.171))
    view = shown(scene)
    assert view.page is not None
    square = View.of(scene.tracked, 640).is_ground != view.is_ground
    ground = np.median(linear_rgb(view.image_bgr)[scene.beside_sheet & ~scene.body & ~scene.shadow], axis=0)
    shaded = np.median(linear_rgb(view.image_bgr)[square & scene.shadow], axis=0)
    assert shaded / ground == pytest.approx(SHADOW_RATIO, rel=0.25)
    light = make_estimator("proxy", BALANCED).estimate(scene.tracked).light
    assert light is not None
    assert np.degrees(angle_between(light.to_light_marker, scene.to_light)) < 3


@pytest.mark.parametrize(("ground", "caster"), [("plain", CYLINDER), ("checkered", BOX), ("bricks", CYLINDER)])
def test_a_light_whose_shadow_ends_on_the_sheet_is_found(ground: str, caster: Caster) -> None:
    scene = paint(Caster(caster.shape, (0.115, 0.02), rgb=caster.rgb), ground=ground, azimuth_deg=15, elevation_deg=34)
    light = make_estimator("proxy", BALANCED).estimate(scene.tracked).light
    assert light is not None
    assert np.degrees(angle_between(light.to_light_marker, scene.to_light)) < 3


@pytest.mark.parametrize(
    ("casters", "how"),
    [
        ([BOX], {"azimuth_deg": 200}),  # the shadow falls elsewhere
        ([], {"azimuth_deg": 20}),
        ([Caster(at=(0.04, -0.12), width_m=0.03, rgb=(0.2, 0.03, 0.2))], {"azimuth_deg": 90, "T_cam_marker": LOW}),
    ],
    ids=["shadow elsewhere", "empty", "hidden by an object"],
)
def test_a_sheet_without_a_shadow_stays(casters: list[Caster], how: dict[str, Any]) -> None:
    scene = paint(*casters, **how)
    assert not shown(scene).is_ground[scene.sheet & ~scene.body].any()
