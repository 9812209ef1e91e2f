"""Lamps beside a painted cube: their distance by one shadow, and suns that are none."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.bench.cube.scenes import lamp
from ashe_live.bench.metrics import squared_sigmas
from ashe_live.core.light import Light
from ashe_live.core.transforms import ELLIPSE_95, angle_between
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.known_body import lamps
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, PaintedLight, frame_of, looking, sun


def found(light: PaintedLight) -> Light:
    frame = frame_of(CubeScene(CAMERA, looking(0.45, 45, 30), [light]))
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame)
    answer = make_estimator("proxy").estimate(tracked)
    assert len(answer.lights) == 1
    return answer.lights[0]


@pytest.mark.parametrize("distance_m", [0.4, 0.5, 0.7])
@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(200, 45), (120, 60), (300, 35)])
def test_a_lamps_place_is_estimated(azimuth_deg: float, elevation_deg: float, distance_m: float) -> None:
    true = lamp(sun(azimuth_deg, elevation_deg, size_deg=3.0), distance_m)
    light = found(true)
    assert light.kind == "lamp"
    assert 1 / light.inverse_distance == pytest.approx(distance_m, rel=0.1)
    assert angle_between(light.to_light_marker, true.point[:3]) < math.radians(2)
    assert light.lamp_covariance is not None
    assert np.linalg.eigvalsh(light.lamp_covariance).min() > 0
    sigma = math.sqrt(light.lamp_covariance[2, 2])
    assert abs(light.inverse_distance - 1 / distance_m) < 3 * sigma
    assert light.radius_m is not None
    assert light.radius_m == pytest.approx(distance_m * math.sin(math.radians(1.5)), rel=0.35)


def test_a_lamp_lights_the_table_as_it_does() -> None:
    true = lamp(sun(200, 45, on_table=0.6, size_deg=3.0), 0.5)
    light = found(true)
    assert light.intensity_rgb_ratio is not None
    given = true.irradiance_rgb * true.point[2] / np.linalg.norm(true.point[:3])
    assert light.intensity_rgb_ratio == pytest.approx(given / 0.3, rel=0.25)  # over the painter's sky


@pytest.mark.parametrize("elevation_deg", [20, 40, 65])
def test_a_sun_is_no_lamp(elevation_deg: float) -> None:
    for azimuth_deg in (80, 200, 320):
        assert found(sun(azimuth_deg, elevation_deg)).kind == "directional"


@pytest.mark.parametrize(
    ("azimuth_deg", "tilt_deg", "turn_deg"), [(200, 45, 30), (155, 60, 20), (65, 30, 300), (205, 42, 30)]
)
def test_a_low_lamp_whose_shadow_leaves_the_picture_is_as_unsure_as_it_is_far_off(
    azimuth_deg: float, tilt_deg: float, turn_deg: float
) -> None:
    true = lamp(sun(azimuth_deg, 15, on_table=0.5, size_deg=3.0), 0.5)
    frame = frame_of(CubeScene(CAMERA, looking(0.4, tilt_deg, turn_deg), [true]))
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame)
    answer = make_estimator("proxy").estimate(tracked)
    assert len(answer.lights) == 1
    light = answer.lights[0]
    assert light.covariance_rad2 is not None
    assert squared_sigmas(light.to_light_marker, light.covariance_rad2, true.point[:3]) < 3 * ELLIPSE_95
    assert angle_between(light.to_light_marker, true.point[:3]) < math.radians(8)


@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(200, 45), (120, 60), (300, 35)])
def test_a_lamp_to_whose_edges_nothing_can_be_fitted_is_no_sure_sun(
    azimuth_deg: float, elevation_deg: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lamps, "fitted", lambda *_, **__: None)
    true = lamp(sun(azimuth_deg, elevation_deg, size_deg=3.0), 0.4)
    light = found(true)
    assert light.covariance_rad2 is not None
    assert squared_sigmas(light.to_light_marker, light.covariance_rad2, true.point[:3]) < ELLIPSE_95


def test_where_nothing_is_known_of_the_bodys_errors_a_sun_to_which_no_lamp_can_be_fitted_stays_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lamps, "fitted", lambda *_, **__: None)
    true = sun(200, 45)
    frame = frame_of(CubeScene(CAMERA, looking(0.45, 45, 30), [true]))
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame)
    assert tracked.marker is not None
    perfect = replace(tracked, marker=replace(tracked.marker, pose_shape_errors=None))
    (light,) = make_estimator("proxy").estimate(perfect).lights
    assert light.kind == "directional"
    assert angle_between(light.to_light_marker, true.point[:3]) < math.radians(1)
