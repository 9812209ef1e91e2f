"""Lights, illuminations and what an estimator answers: what they hold, and the times of an estimate's stages."""

import dataclasses
import math
import time
from collections.abc import Iterator

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate, StageClock
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame

SUN = Light((0.0, 0.0, 1.0))


def test_a_lamp_of_another_angular_size_has_a_radius_to_fit() -> None:
    lamp = dataclasses.replace(SUN, inverse_distance=2.0, radius_m=0.02).with_angular_size(0.1)
    assert lamp.angular_size_rad == 0.1
    assert lamp.radius_m == pytest.approx(0.5 * math.tan(0.05))
    assert SUN.with_angular_size(0.1).radius_m is None
    assert lamp.with_angular_size(None).radius_m == lamp.radius_m


@pytest.mark.parametrize("known", [{"shadow_rgb_ratio": np.full(3, 0.9)}, {"intensity_rgb_ratio": np.full(3, 7.0)}])
def test_without_a_light_the_ground_keeps_what_that_does_not_give(known: dict[str, Float]) -> None:
    light = dataclasses.replace(SUN, **known).with_ground_share(np.array([0.2, 0.5, 0.8]))
    np.testing.assert_allclose(light.ground_rgb_ratio, [0.8, 0.5, 0.2])
    assert (light.intensity_rgb_ratio is None) == ("intensity_rgb_ratio" not in known)


def test_no_light_needs_a_reason() -> None:
    with pytest.raises(ValueError, match="reason"):
        LightEstimate("paper", 0, Illumination())


def test_an_estimate_rests_on_its_own_frame_and_may_on_others() -> None:
    alone = LightEstimate("paper", 3, Illumination(), "no shadow found")
    assert alone.views == (3,)
    assert alone.span_rad is None
    several = dataclasses.replace(alone, views=(3, 1, 7), span_rad=0.4)
    assert several.views == (3, 1, 7)
    with pytest.raises(ValueError, match="first view of frame 3"):
        dataclasses.replace(alone, views=(1, 3))


def test_a_light_is_a_unit_vector_with_its_angles() -> None:
    light = Light(np.array([0.0, 2.0, 2.0]))
    assert np.linalg.norm(light.to_light_marker) == pytest.approx(1)
    assert (light.azimuth_deg, light.elevation_deg) == pytest.approx((90, 45))


def test_an_illumination_is_what_an_estimate_found_and_the_frame_it_was_found_in() -> None:
    pose = MarkerPose(np.eye(4), np.zeros((4, 2)), 0.08, 0.2, None)
    seen = TrackedFrame(Frame(np.zeros((48, 64, 3), np.uint8), 0, 0.0), Camera.from_hfov((64, 48), 60), pose)
    light = Light(np.array([0.3, -0.2, 1]))
    estimate = LightEstimate("proxy", 0, Illumination((light,), np.full(3, 0.3), np.full(3, 0.5)))
    illumination = estimate.illumination.as_seen_in(seen)
    assert illumination.light is estimate.light is light
    assert illumination.ground_rgb is estimate.illumination.ground_rgb
    assert illumination.seen_in is seen
    without_marker = dataclasses.replace(seen, marker=None)
    assert illumination.as_seen_in(without_marker).seen_in is None
    with pytest.raises(ValueError, match="where the ground is"):
        Illumination(seen_in=without_marker)


def test_a_lamp_is_where_its_inverse_distance_puts_it() -> None:
    lamp = Light(np.array([0.0, 3.0, 4.0]), inverse_distance=2.0, radius_m=0.02)

    assert lamp.kind == "lamp"
    np.testing.assert_allclose(lamp.position_marker_m, [0.0, 0.3, 0.4])
    np.testing.assert_allclose(lamp.homogeneous[:3] / lamp.homogeneous[3], [0.0, 0.3, 0.4])


def test_a_light_without_inverse_distance_is_a_sun() -> None:
    sun = Light(np.array([0.0, 3.0, 4.0]))

    assert sun.kind == "directional"
    assert sun.position_marker_m is None
    assert sun.homogeneous[3] == 0


@pytest.mark.parametrize("inverse_distance", [5e-324, 1e-200])
def test_a_lamp_farther_away_than_can_be_computed_with_is_a_sun(inverse_distance: float) -> None:
    """As the file of --as-shown may say."""
    light = Light(np.array([0.0, 0.0, 1.0]), inverse_distance=inverse_distance)
    assert (light.kind, light.inverse_distance, light.position_marker_m) == ("directional", 0.0, None)


@pytest.mark.parametrize("z", [1e-300, -1e-300, 1e-12, -1e-12, 5e-324])
def test_a_light_as_low_as_rounding_is_in_the_plane_and_has_no_shadow(z: float) -> None:
    """The shadow of a lamp there could not be computed, and drawing it failed."""
    light = Light((0.6, 0.8, z))
    assert light.to_light_marker.tolist() == [0.6, 0.8, 0.0]
    assert not np.signbit(light.to_light_marker[2])


@pytest.mark.parametrize("inverse_distance", [-1.0, -0.01, np.nan, np.inf, 1e4])
def test_a_lamp_is_neither_behind_the_plane_nor_inside_the_marker(inverse_distance: float) -> None:
    with pytest.raises(ValueError, match="inverse_distance"):
        Light(np.array([0.0, 0.0, 1.0]), inverse_distance=inverse_distance)


def test_each_stage_gets_the_time_since_the_one_before_and_the_total_all_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    moments: Iterator[float] = iter((10.0, 10.25, 10.5, 11.5, 12.0))
    monkeypatch.setattr(time, "perf_counter", lambda: next(moments))
    clock = StageClock()
    for stage in ("segment", "fit", "segment"):
        clock.end(stage)
    assert clock.timing_ms() == {"segment": 1250.0, "fit": 250.0, "total": 2000.0}
