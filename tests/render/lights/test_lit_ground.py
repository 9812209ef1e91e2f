"""Lit ground at the border of a real object's shadow: painted pictures of a known shadow, and all of it in shadow."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.models.placement import Placement
from ashe_live.models.primitives import box
from ashe_live.quality import QUALITIES
from ashe_live.render.lights.seen.lit_ground import _of_nearest
from ashe_live.render.lights.seen.shadow import seen_shadows
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

RATIO = np.array((0.25, 0.32, 0.45))
FINER = 4
CORNERS = np.array([(x, y, z) for x in (-0.015, 0.015) for y in (0.02, 0.1) for z in (0, 0.07)])
BODY = Proxy("box", np.column_stack([CORNERS, np.zeros((8, 2))]))
GROUNDS = ("plain", "planks", "grain")


def _ground(kind: str, at: np.ndarray) -> np.ndarray:
    """(n, 3) linear colours at places (n, 2) of the plane."""
    rgb = np.tile((0.5, 0.36, 0.24), (len(at), 1))
    if kind == "planks":  # dark joints, across the longer borders of the shadow
        rgb[(at[:, 0] % 0.03) < 0.003] *= 0.35
    if kind == "grain":
        rgb *= (1 + 0.25 * np.sin(at[:, 0] * 900) * np.sin(at[:, 1] * 700))[:, None]
    return rgb


def _photo(linear: np.ndarray) -> np.ndarray:
    """(h, w, 3) uint8 BGR by a camera that sharpens brightness and blurs colours by 1.5 pixels."""
    encoded = srgb_from_linear(cv2.GaussianBlur(linear, (0, 0), 0.6)).astype(np.float32)
    ycc = cv2.cvtColor(encoded, cv2.COLOR_RGB2YCrCb)
    luma = ycc[..., :1]
    ycc[..., :1] += 0.6 * (luma - cv2.GaussianBlur(luma, (0, 0), 1.0)[..., None])
    ycc[..., 1:] = cv2.GaussianBlur(ycc[..., 1:], (0, 0), 1.5)
    image = np.rint(255 * np.clip(cv2.cvtColor(ycc, cv2.COLOR_YCrCb2RGB), 0, 1)).astype(np.uint8)
    return np.ascontiguousarray(image[..., ::-1])


class Painted:
    """A frame of a box in a sun, and the same ground with all of it in shadow."""

    def __init__(self, stage, kind: str, light) -> None:
        blank = stage.tracked(0, stage.pose(-60, 50, 0.45, (0.0, 0.06, 0.0)))
        width, height = blank.frame.size
        camera, T_cam_marker = blank.camera, blank.marker.T_cam_marker

        def ground_at(finer: int) -> np.ndarray:
            axes = ((np.arange(n * finer) + 0.5) / finer - 0.5 for n in (width, height))
            return raycast_to_plane(camera, T_cam_marker, np.stack(np.meshgrid(*axes), axis=2).reshape(-1, 2))[:, :2]

        def filled(points: np.ndarray, finer: int) -> np.ndarray:
            mask = np.zeros((height * finer, width * finer), np.uint8)
            hull = cv2.convexHull(((project(camera, T_cam_marker, points) + 0.5) * finer - 0.5).astype(np.float32))
            cv2.fillConvexPoly(mask, np.rint(hull).astype(np.int32), 1)
            return mask > 0

        cast = CORNERS - CORNERS[:, 2:] * light.to_light_marker / light.to_light_marker[2]
        colours = _ground(kind, ground_at(FINER)).reshape(height * FINER, width * FINER, 3)
        lit, shaded = colours.copy(), colours * RATIO
        lit[filled(cast, FINER)] *= RATIO
        for each in (lit, shaded):
            each[filled(CORNERS, FINER)] = (0.05, 0.02, 0.02)
        images = [_photo(cv2.resize(each, (width, height), interpolation=cv2.INTER_AREA)) for each in (lit, shaded)]
        self.tracked, self.all_in_shadow = stage.tracked(images[0], T_cam_marker, camera), images[1].astype(int)
        shadow = filled(cast, 1).astype(np.uint8)
        self.is_object = filled(CORNERS, 1)
        beside_object = cv2.dilate(self.is_object.astype(np.uint8), np.ones((25, 25))) > 0
        self.at_border = (cv2.dilate(shadow, np.ones((7, 7))) != cv2.erode(shadow, np.ones((7, 7)))) & ~beside_object


@pytest.fixture
def sun(stage):
    return stage.light(170, 35, tuple(RATIO))


@pytest.mark.parametrize("kind", GROUNDS)
def test_ground_at_a_shadows_border_is_found_as_it_is_when_it_is_lit(stage, sun, kind: str) -> None:
    painted = Painted(stage, kind, sun)
    (shadow,) = seen_shadows(BODY, painted.tracked, (sun,))
    ground = shadow.ground
    rows, columns = np.nonzero(ground.rgba[..., 3] > 0.9)
    assert len(rows) > 300
    texel_m = (ground.bounds[2:] - ground.bounds[:2]) / ground.rgba.shape[1::-1]
    at = ground.bounds[:2] + (np.column_stack([columns, rows]) + 0.5) * texel_m
    error = np.abs(np.log(ground.rgba[rows, columns, :3].astype(float) / _ground(kind, at)))
    assert np.median(error) < 0.06
    assert np.quantile(error, 0.9) < (0.15 if kind == "plain" else 0.5)


@pytest.mark.parametrize(("quality", "kind"), in_turns((kind,) for kind in GROUNDS))
def test_no_line_is_left_where_a_models_shadow_crosses_the_real_one(
    make_renderer, stage, sun, quality: str, kind: str
) -> None:
    """A wall takes all of the light: the ground is as in a photo in which nothing of it is lit."""
    painted, renderer = Painted(stage, kind, sun), make_renderer(QUALITIES[quality].render)
    ground_rgb = np.array((0.5, 0.36, 0.24))
    lit = Illumination((sun,), RATIO, ground_rgb, BODY).as_seen_in(painted.tracked)
    wall = stage.placed(box((0.01, 0.5, 0.25)))
    scene = Scene(painted.tracked, wall, lit, placement=Placement(shift_m=(-0.12, 0.06)), shows_model=False)
    off = np.abs(stage.picture(renderer, scene).astype(int) - painted.all_in_shadow)[painted.at_border]
    assert len(off) > 400
    assert off.mean() < 5.0
    assert np.quantile(off, 0.9) <= 8
    assert np.quantile(off, 0.99) <= 14


@pytest.mark.parametrize("quality", QUALITIES)
def test_no_dots_are_left_at_the_objects_foot_where_its_body_is_a_little_too_large(
    make_renderer, stage, quality: str
) -> None:
    sun = stage.light(60, 35, tuple(RATIO))
    painted, renderer = Painted(stage, "plain", sun), make_renderer(QUALITIES[quality].render)
    middle = np.array((0, 0.06, 0))
    larger = Proxy("box", np.column_stack([1.03 * (CORNERS - middle) + middle, np.zeros((8, 2))]))
    lit = Illumination((sun,), RATIO, np.array((0.5, 0.36, 0.24)), larger).as_seen_in(painted.tracked)
    towards = sun.to_light_marker[:2] / np.linalg.norm(sun.to_light_marker[:2])
    across = Placement(turn_rad=math.radians(60), shift_m=tuple(map(float, middle[:2] + 0.12 * towards)))
    wall = stage.placed(box((0.01, 0.5, 0.25)))
    scene = Scene(painted.tracked, wall, lit, placement=across, shows_model=False)
    off = stage.picture(renderer, scene).astype(int) - painted.all_in_shadow
    kernel, beyond = np.ones((3, 3), np.uint8), np.ones((15, 15), np.uint8)
    seen = painted.is_object.astype(np.uint8)
    beside = (cv2.dilate(seen, beyond) > 0) & (cv2.dilate(seen, kernel) == 0)
    assert np.abs(off[beside]).max() < 20


def test_beside_a_second_light_nothing_is_said(stage, sun) -> None:
    painted = Painted(stage, "plain", sun)
    shadows = seen_shadows(BODY, painted.tracked, (sun, stage.light(80, 40, tuple(RATIO))))
    assert all(shadow.ground is None for shadow in shadows)


def test_each_texel_has_the_penumbra_of_the_nearest_part_of_the_border() -> None:
    """As by all distances: where two parts are as near to half a texel, either one's counts."""
    rng = np.random.default_rng(0)
    height, width = 40, 60
    samples = np.column_stack([rng.integers(0, (width, height), (30, 2)), rng.uniform(1, 9, 30)]).astype(float)
    beyond = np.array([(-5.0, 3.0, 20.0), (10.0, height + 4.0, 20.0)])
    found = _of_nearest(np.vstack([samples, beyond]), (height, width))
    rows, columns = np.mgrid[:height, :width]
    away = np.hypot(columns[..., None] - samples[:, 0], rows[..., None] - samples[:, 1])
    may_be = away <= away.min(axis=2, keepdims=True) + 0.5
    assert (np.isclose(found[..., None], samples[:, 2], atol=1e-5) & may_be).any(axis=2).all()
    assert not _of_nearest(beyond, (height, width)).any()
