"""Painted cubes are the truth of a bench: their light and shadows are checked against geometry and Lambert's law."""

import dataclasses
import math

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.painted_scene import CubeScene, Folds, PaintedLight, hull_of
from ashe_live.bench.cube.painter import PAPER, painted
from ashe_live.bench.cube.scenes import SETS, looking, sun
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.transforms import image_from_plane, project
from ashe_live.tracking.cube.faces import FACES

CAMERA = Camera.from_hfov((320, 240), 60)
EDGE_M = 0.06
T_CAM_CUBE = looking(0.4, 50, 30)
TABLE_RGB = np.array([0.42, 0.36, 0.3])
SKY_RGB = np.array([0.25, 0.3, 0.35])


def plain(*lights: PaintedLight) -> CubeScene:
    """Without noise or stains, so that levels are exact to the rounding of a picture."""
    return CubeScene(
        CAMERA, T_CAM_CUBE, lights, sky_rgb=SKY_RGB, edge_m=EDGE_M, table_rgb=TABLE_RGB, mottled=0.0, noise=0.0
    )


def linear_at(image: Image, point: tuple[float, float, float]) -> Float:
    """(3,) linear RGB of the pixel that shows a point of the cube's frame."""
    ((column, row),) = np.round(project(CAMERA, T_CAM_CUBE, [point])).astype(int)
    return LINEAR_FROM_SRGB_8BIT[image[row, column, ::-1]]


def test_level_surfaces_have_their_reflectance_times_the_exposure() -> None:
    scene = plain(sun(200, 40))
    image = painted(scene)
    # Far from the cube, which hides sky from the table near it.
    assert linear_at(image, (-0.12, 0.2, 0)) == pytest.approx(scene.exposure * TABLE_RGB, rel=0.03)
    # The white margin around the print of the top face.
    assert linear_at(image, (0.026, 0.026, EDGE_M)) == pytest.approx(scene.exposure * PAPER, rel=0.03)


def test_between_faces_that_are_folded_apart_there_is_paper_and_no_table() -> None:
    """A top that is lifted by a tenth of the edge: below it one sees neither through the cube nor past it."""
    shifts = np.zeros((5, 3))
    (top,) = (number for number, face in enumerate(FACES) if face.outwards[2] > 0)
    shifts[top, 2] = 0.1
    scene = dataclasses.replace(plain(sun(200, 40)), folds=Folds(shifts=shifts))
    gap = (EDGE_M / 2, 0.0, 1.05 * EDGE_M)  # towards the camera
    assert linear_at(painted(scene), gap) == pytest.approx(scene.exposure * PAPER, rel=0.03)


def test_the_shadow_lies_where_the_hull_casts_it_and_has_the_skys_light() -> None:
    light = sun(120, 35)
    scene = plain(light)
    body = hull_of(scene)
    cast = body - body[:, 2:] * light.point[:3] / light.point[2]
    pixels = project(CAMERA, T_CAM_CUBE, np.concatenate([cast, body])).astype(np.float32)
    shadow, cube = cv2.convexHull(pixels[: len(body)]), cv2.convexHull(pixels[len(body) :])
    image = painted(scene)
    dark = LINEAR_FROM_SRGB_8BIT[image[..., ::-1]] / (scene.exposure * TABLE_RGB)
    ratio = SKY_RGB / (SKY_RGB + light.irradiance_rgb * light.point[2])
    compared = 0
    for row in range(0, 240, 4):
        for column in range(0, 320, 4):
            inside, of_cube = (cv2.pointPolygonTest(hull, (column, row), True) for hull in (shadow, cube))
            if of_cube > -3 or abs(inside) < 3:
                continue
            if inside > 0:
                # At the cube's foot it hides nearly half of the sky as well.
                assert (dark[row, column] < ratio + 0.02).all()
                assert (dark[row, column] > 0.5 * ratio).all()
                compared += 1
            else:
                assert (dark[row, column] > 0.5 * (1 + ratio)).all()
    assert compared > 50


def test_a_lamp_far_away_is_a_sun() -> None:
    light = sun(200, 40)
    lamp = dataclasses.replace(light, point=np.append(light.point[:3], 1e-5))
    difference = painted(plain(light)).astype(int) - painted(plain(lamp))
    assert np.abs(difference).max() <= 1


def test_a_lamp_falls_off_by_the_square_and_the_cosine() -> None:
    place = np.array((0.15, 0.1, 0.3))
    distance = float(np.linalg.norm(place))
    lamp = PaintedLight(np.append(place / distance, 1 / distance), np.full(3, 0.7), math.radians(0.5))
    scene = dataclasses.replace(plain(lamp), sky_rgb=np.full(3, 1e-3))
    image = painted(scene)
    # Both out of the shadow, which lies on the other side of the cube and reaches 6 cm aside.
    near, far = (0.06, 0.06, 0.0), (0.0, -0.12, 0.0)
    falls = [(distance / float(np.linalg.norm(place - there))) ** 3 for there in (near, far)]
    found = linear_at(image, near) / linear_at(image, far)
    assert found == pytest.approx(falls[0] / falls[1], rel=0.04)


def test_a_wider_light_makes_softer_borders() -> None:
    lights = (sun(120, 35, size_deg=0.5), sun(120, 35, size_deg=8))
    sharp, soft = (cv2.cvtColor(painted(plain(light)), cv2.COLOR_BGR2GRAY).astype(float) for light in lights)
    # Along the shadow's axis, across its far end.
    tip = hull_of(plain())[:, 2].max() / math.tan(math.radians(35))
    away = -np.array([math.cos(math.radians(120)), math.sin(math.radians(120))])
    places = [np.append((tip + step) * away, 0.0) for step in np.linspace(-0.02, 0.05, 60)]
    columns, rows = np.round(project(CAMERA, T_CAM_CUBE, places)).astype(int).T
    steepest = [np.diff(picture[rows, columns]).max() for picture in (sharp, soft)]
    assert steepest[1] < 0.6 * steepest[0]


def test_sets_share_no_scene_whatever_the_seed() -> None:
    """But for a cube that was followed, which is another set's, seen once more."""
    drawn = [
        tuple(next(one.scenes(1, seed)).T_cam_cube.ravel()) for one in SETS if not one.followed for seed in range(8)
    ]
    assert len(set(drawn)) == len(drawn)
    followed = [tuple(next(one.scenes(1)).T_cam_cube.ravel()) for one in SETS if one.followed]
    assert set(followed) < set(drawn)


def test_the_grain_of_a_table_stays_on_it_while_the_camera_moves() -> None:
    """Seen from aside, and drawn back onto the plane, it is what it was; grain drawn anew for each picture is not."""
    here, aside = looking(0.45, 35, 20), looking(0.45, 35, 45)
    scene = CubeScene(CAMERA, here, [sun(200, 50)], noise=0.0, mottled=0.1, seed=4)
    moved = dataclasses.replace(scene, T_cam_cube=aside)
    first, on_table, anew = (
        painted(each)[..., 1].astype(float) for each in (scene, dataclasses.replace(moved, grain_from=here), moved)
    )
    to_first = image_from_plane(CAMERA, here) @ np.linalg.inv(image_from_plane(CAMERA, aside))
    window = np.s_[150:190, 30:90]  # table that both show, away from the cube and its shadow

    def likeness(other: Float) -> float:
        back = cv2.warpPerspective(other, to_first, CAMERA.size)
        return float(np.corrcoef(back[window].ravel(), first[window].ravel())[0, 1])

    assert likeness(on_table) > 0.9
    assert abs(likeness(anew)) < 0.3
