"""A table's pattern has edges everywhere: outlines are laid where no shadow is, and lines of a cloth are no light's."""

import dataclasses

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.painter import projected
from ashe_live.core.light import LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, raycast_to_plane
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.known_body.outline.edges import shadow_edges
from ashe_live.light.known_body.outline.elsewhere import laid
from ashe_live.light.known_body.outline.room import Outline
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.light.known_body.test_shadow_edges import BODY, view
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, PaintedLight, frame_of, looking, sun

# Distance, tilt and azimuth of the camera; width of the cloth's stripes; where they begin; whether others cross them.
CLOTHS = [
    (0.474, 50.2, 333.8, 0.0221, 0.85, False),
    (0.398, 27.7, 124.0, 0.0219, 0.52, True),
    (0.426, 36.0, 253.0, 0.0337, 0.12, True),
    (0.492, 59.8, 228.3, 0.0234, 0.64, True),
]
Cloth = tuple[float, float, float, float, float, bool]


def estimate_on(cloth: Cloth, lights: list[PaintedLight]) -> LightEstimate:
    """Of a cube that stands along the stripes of a cloth."""
    distance_m, tilt_deg, azimuth_deg, width_m, start, is_checked = cloth
    scene = CubeScene(CAMERA, looking(distance_m, tilt_deg, azimuth_deg), lights, sky_rgb=np.full(3, 0.6))
    frame = frame_of(scene)
    columns, rows = np.meshgrid(np.arange(640.0), np.arange(480.0))
    places = raycast_to_plane(CAMERA, scene.T_cam_cube, np.column_stack([columns.ravel(), rows.ravel()]))
    across = places[:, : 2 if is_checked else 1]
    dark = (np.floor(across / width_m + start) % 2).mean(axis=1).reshape(480, 640)
    cube = cv2.convexHull(projected(CAMERA, scene.T_cam_cube, BODY.points_marker()).astype(np.float32))
    on_table = cv2.fillConvexPoly(np.ones((480, 640), np.uint8), np.round(cube).astype(np.int32), 0)
    printed = frame.image_bgr * (1 - 0.16 * dark * on_table)[..., None]  # in linear light 0.7 of it is left
    frame = dataclasses.replace(frame, image_bgr=np.round(printed).astype(np.uint8))
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame)
    assert tracked.marker is not None
    return make_estimator("proxy").estimate(tracked)


@pytest.mark.parametrize("cloth", CLOTHS)
def test_the_lines_of_a_cloth_are_no_shadows_edges(cloth: Cloth) -> None:
    assert estimate_on(cloth, []).lights == ()


@pytest.mark.parametrize("cloth", CLOTHS)
def test_on_a_cloth_a_sun_is_found_all_the_same(cloth: Cloth) -> None:
    light = sun(cloth[2] + 110, 40)
    answer = estimate_on(cloth, [light])
    assert len(answer.lights) == 1
    assert answer.lights[0].confidence is not None
    assert answer.lights[0].confidence > 0.9
    assert angle_between(answer.lights[0].to_light_marker, light.point[:3]) < np.radians(3)


@pytest.mark.parametrize("move", [(0.1, 0.04), (-0.07, 0.12), (0.02, -0.15)])
def test_a_laid_outline_is_the_shadow_of_the_body_in_that_place(move: tuple[float, float]) -> None:
    light, seen = np.array((0.9, -0.5, 1.0, 0.0)), view()
    at_home = shadow_edges(BODY, light, seen)
    moved_points = BODY.spheroids_marker + np.array((*move, 0.0, 0.0, 0.0))
    there = shadow_edges(Proxy("box", moved_points), light, seen)
    assert at_home is not None
    assert there is not None
    moves = np.array([move, (0.0, 0.0)])
    found, by_move = laid(at_home, np.arange(len(at_home.points_px)), moves, seen)
    count = len(at_home.points_px)
    assert np.abs(Outline.of(there.corners_px).distances(found.points_px[:count])).max() < 1e-6
    assert found.points_px[count:] == pytest.approx(at_home.points_px)
    assert found.normals_px[count:] == pytest.approx(at_home.normals_px)
    outside = found.points_px[:count] + found.normals_px[:count]
    assert Outline.of(there.corners_px).distances(outside) == pytest.approx(1.0)
    small = 1e-6
    for axis in range(2):
        further, _ = laid(at_home, np.arange(count), np.array([move]) + small * np.eye(2)[axis], seen)
        step = ((further.points_px - found.points_px[:count]) * found.normals_px[:count]).sum(axis=1)
        assert step / small == pytest.approx(by_move[:count, axis], rel=1e-3, abs=1e-2)
