"""Cubes on gravel: single stones hide no shadow, and edges stay where they are."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.bench.cube.painted_scene import hull_of
from ashe_live.bench.cube.painter import projected
from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.known_body.outline.texture import without_texture
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import NO_LIGHTS
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, looking, painted, sun

STONE_PX, STONES = 6, 0.35  # how far stones lie apart, and the standard deviation of the logarithm of what they reflect
VIEW = looking(0.4, 50, 30)
SUNS = (sun(80, 40, 0.5), sun(170, 35, 0.4))


def stones(seed: int, shape: tuple[int, int] = (480, 640)) -> Float32:
    """(h, w) what a mosaic of stones reflects, over its mean."""
    rng = np.random.default_rng(seed)
    seeds = np.full(shape, 255, np.uint8)
    count = shape[0] * shape[1] // STONE_PX**2
    seeds[rng.integers(shape[0], size=count), rng.integers(shape[1], size=count)] = 0
    _, labels = cv2.distanceTransformWithLabels(seeds, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    of_stones = np.exp(rng.normal(0, STONES, int(labels.max()) + 1)) / math.exp(STONES**2 / 2)
    return np.asarray(of_stones[labels], dtype=np.float32)


def on_gravel(picture: Image, scene: CubeScene) -> Image:
    """A painted picture of a scene whose table is made of stones."""
    outline = cv2.convexHull(projected(CAMERA, scene.T_cam_cube, hull_of(scene)).astype(np.int32))
    cube = cv2.fillConvexPoly(np.zeros(picture.shape[:2], np.uint8), outline, 1)
    is_cube = cv2.dilate(cube, np.ones((5, 5), np.uint8))[..., None] > 0
    table = LINEAR_FROM_SRGB_8BIT[picture] * stones(scene.seed)[..., None]
    return np.where(is_cube, picture, (255 * srgb_from_linear(table.clip(0, 1)) + 0.5).astype(np.uint8))


def tracked(picture: Image) -> TrackedFrame:
    return MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(Frame(picture, 0, 0.0))


def in_view(picture: Image) -> Float:
    """(2,) of both suns' shadows, the part of the outline that is seen."""
    frame = tracked(picture)
    assert frame.marker is not None
    assert frame.marker.body is not None
    seen = Seen.of(View.of(frame, 640), frame.marker.body)
    assert seen is not None
    nearest = [int((seen.templates.lights[:, :3] @ light.point[:3]).argmax()) for light in SUNS]
    return seen.rims(NO_LIGHTS).in_view[nearest]


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4])
def test_stones_that_shine_hide_no_shadow(seed: int) -> None:
    scene = CubeScene(CAMERA, VIEW, SUNS, exposure=0.7, seed=seed)
    picture = painted(scene)
    assert (in_view(on_gravel(picture, scene)) > 0.68 * in_view(picture)).all()


def halves() -> tuple[Float32, Mask]:
    """(h, w) light that falls to its half at the column 99.5, and ground but for a bright thing at the left."""
    light = np.where(np.arange(200) < 100, 0.4, 0.8) * np.ones((160, 1))
    is_ground = np.ones(light.shape, bool)
    is_ground[:, :50] = False
    light[:, :50] = 3.0
    return light.astype(np.float32), is_ground


def test_a_smooth_table_is_left_as_it_is() -> None:
    light, is_ground = halves()
    assert without_texture(light, is_ground, 0.8)[0] is light


def test_edges_stay_where_they_are_and_nothing_shines_onto_the_ground() -> None:
    light, is_ground = halves()
    rough = light * stones(0, light.shape)
    smooth, _ = without_texture(rough, is_ground, 0.8)
    assert smooth[:, :50] == pytest.approx(rough[:, :50])
    assert smooth[:, 110:].std() < 0.9 * rough[:, 110:].std()
    assert smooth[:, 50:53].mean() == pytest.approx(rough[:, 50:56].mean(), rel=0.1)  # beside what shines
    # What is lit between is as long: an edge a pixel aside would change it by 0.017.
    assert smooth[:, 80:120].mean() == pytest.approx(rough[:, 80:120].mean(), rel=0.005)
