"""Estimates by a clean plate: what is painted on the ground does not count, what its light shows still does."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators.proxy import ProxyEstimator
from tests.light.painted_scenes import BOX, CYLINDER, Painted, paint
from tests.light.synthetic_masks import camera_towards, direction

LAMP_M = 0.5 * direction(200.0, 50.0)


def estimated(scene: Painted, empty: Painted) -> LightEstimate:
    plate = empty.tracked.frame.image_bgr
    return ProxyEstimator().estimate(replace(scene.tracked, clean_plate_bgr=plate))


def marked(scene: Painted, mark: Painted) -> Painted:
    """The scene with a dark mark on its ground, where `mark` has a shadow: at the same body's foot."""
    is_mark = mark.shadow & ~scene.body
    linear = linear_from_srgb(np.asarray(scene.tracked.frame.image_bgr) / 255.0)
    linear[is_mark] *= 0.3
    image = np.round(255 * srgb_from_linear(linear)).astype(np.uint8)
    frame = scene.tracked.frame
    return replace(scene, tracked=replace(scene.tracked, frame=Frame(image, frame.index, frame.time_s)))


@pytest.mark.parametrize("ground", ["plain", "bricks", "planks"])
def test_paint_in_the_shape_of_a_shadow_does_not_mislead(ground) -> None:
    mark = paint(BOX, ground=ground, azimuth_deg=310.0, elevation_deg=45.0)
    scene = marked(paint(BOX, ground=ground, seed=1), mark)
    empty = marked(paint(ground=ground, seed=2), mark)
    found = estimated(scene, empty)
    assert len(found.lights) == 1
    assert np.degrees(angle_between(found.lights[0].to_light_marker, scene.to_light)) < 2.0
    assert found.lights[0].confidence > 0.8


def test_the_fall_of_a_lamp_s_light_is_still_seen() -> None:
    scene, empty = (paint(*casters, ground="bricks", lamp_m=LAMP_M, seed=len(casters)) for casters in ((CYLINDER,), ()))
    found = estimated(scene, empty)
    assert found.light is not None
    assert found.light.kind == "lamp"
    np.testing.assert_allclose(1 / found.light.inverse_distance, 0.5, rtol=0.15)


def test_the_ground_s_colour_is_that_of_the_picture() -> None:
    scene, empty = paint(BOX, ground="bricks", seed=1), paint(ground="bricks", seed=2)
    alone = ProxyEstimator().estimate(scene.tracked).illumination
    by_plate = estimated(scene, empty).illumination
    np.testing.assert_allclose(by_plate.ground_rgb, alone.ground_rgb, rtol=0.05)


def test_an_empty_table_shows_nothing() -> None:
    first, second = paint(ground="checkered", seed=1), paint(ground="checkered", seed=2)
    found = estimated(first, second)
    assert not found.lights
    assert found.reason


def test_other_views_which_show_the_ground_s_pattern_are_left_out() -> None:
    scene, empty = paint(BOX, ground="bricks", seed=1), paint(ground="bricks", seed=2)
    frozen = replace(scene.tracked, clean_plate_bgr=empty.tracked.frame.image_bgr)
    aside = paint(BOX, ground="bricks", T_cam_marker=camera_towards((0.3, 0.1), 0.55, 45.0)).tracked
    index = frozen.frame.index
    other = TrackedFrame(Frame(aside.frame.image_bgr, index + 1, 0.5), aside.camera, aside.marker)
    together, alone = (ProxyEstimator().estimate(frozen, others) for others in ((other,), ()))
    assert together.views == alone.views == (index,)
    np.testing.assert_array_equal(together.lights[0].to_light_marker, alone.lights[0].to_light_marker)
