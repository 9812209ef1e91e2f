"""The scenes that the cube's bench draws are those that it says."""

import math

import numpy as np
import pytest

from ashe_live.bench.cube.painted_scene import Folds, on_table
from ashe_live.bench.cube.scenes import APART_RAD, CAMERA, SETS, CubeSet, lamp, looking, sun
from ashe_live.core.transforms import angle_between, camera_centre, direction_from_angles, project


@pytest.mark.parametrize("one", SETS, ids=lambda one: one.name)
def test_a_set_has_the_lights_and_folds_of_its_name(one: CubeSet) -> None:
    wanted = 0 if "cloudy" in one.name else 2 if "two" in one.name else 1
    for scene in one.scenes(6):
        assert len(scene.lights) == wanted
        assert scene.folds.shifts.any() == scene.folds.turns.any() == ("crooked" in one.name)
        for number, light in enumerate(scene.lights):
            to_light = light.point[:3] / np.linalg.norm(light.point[:3])
            assert 12 <= math.degrees(math.asin(to_light[2])) <= 80
            assert all(angle_between(to_light, each.point[:3]) > APART_RAD for each in scene.lights[:number])
            away_m = np.linalg.norm(light.point[:3]) / light.point[3] if light.point[3] else math.inf
            assert (0.4 <= away_m <= 0.6) == ("lamp" in one.name)
            width_deg = math.degrees(light.size_rad)
            low, high = (3, 10) if "soft" in one.name else (2, 6) if "lamp" in one.name else (0.52, 0.54)
            assert low <= width_deg <= high
        eye = camera_centre(scene.T_cam_cube) - (0, 0, 0.02)
        assert 0.35 <= np.linalg.norm(eye) <= 0.6
        assert 25 <= math.degrees(math.acos(eye[2] / np.linalg.norm(eye))) <= 75
    assert one.followed == ("followed" in one.name or one.together)
    assert one.together == ("views" in one.name)


def test_faces_are_folded_to_either_side_by_no_more_than_is_said() -> None:
    rng, edge_m = np.random.default_rng(2), 0.05
    drawn = [Folds.drawn(rng, edge_m, most_m=2e-3, most_deg=3.0) for _ in range(20)]
    for values, most in (
        (edge_m * np.array([each.shifts for each in drawn]), 2e-3),
        (np.degrees([each.turns for each in drawn]), 3.0),
    ):
        for along in range(3):  # an axis
            low, high = values[..., along].min(), values[..., along].max()
            assert -most <= low < -0.9 * most
            assert 0.9 * most < high <= most


def test_a_camera_looks_at_the_cube_from_where_it_is_held_upright() -> None:
    T = looking(0.4, 50, 30)
    aim, higher = np.array([(0.0, 0.0, 0.02), (0.0, 0.0, 0.07)])
    assert camera_centre(T) == pytest.approx(aim + 0.4 * direction_from_angles(math.radians(30), math.radians(40)))
    middle, above = project(CAMERA, T, [aim, higher])
    assert middle == pytest.approx(CAMERA.K[:2, 2])
    assert above[0] == pytest.approx(middle[0])
    assert above[1] < middle[1]
    assert T[:3, :3] @ T[:3, :3].T == pytest.approx(np.eye(3))
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1)


@pytest.mark.parametrize("elevation_deg", [12, 45, 80])
def test_a_light_gives_the_table_what_is_asked_for_and_a_little_less_of_green_and_blue(elevation_deg: float) -> None:
    far = sun(70, elevation_deg, on_table=0.6)
    assert (far.point[3], far.irradiance_rgb.argmax()) == (0, 0)
    near = lamp(far, 0.5)
    assert near.point[:3] / near.point[3] == pytest.approx(0.5 * far.point[:3])
    for light in (far, near):
        given = on_table(light)
        assert given[0] == pytest.approx(0.6)
        assert 0.6 > given[1] > given[2] > 0.5
