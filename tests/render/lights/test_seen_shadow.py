"""Where a picture shows a real object's shadow: painted pictures of an object with a step, which its body lacks."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy, ProxyMesh
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame
from ashe_live.models.placement import Placement
from ashe_live.models.primitives import box
from ashe_live.quality import QUALITIES
from ashe_live.render.lights.ground_shadows import OUTLINE_ERROR
from ashe_live.render.lights.seen.shadow import seen_shadows
from ashe_live.render.lights.seen.shadow_maps import SeenShadowMaps
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

RATIO = np.array((0.3, 0.33, 0.4))
FINER = 4  # pixels to a side in which a pixel of a painted picture is divided
OBJECT_RGB = np.array((0.05, 0.02, 0.02))
# A step: its lower half twice as long as its upper one. Centre y, half length, height; metres.
PARTS = ((0.06, 0.04, 0.03), (0.04, 0.02, 0.07))
HALF_WIDTH = 0.015
GROUNDS = ("plain", "checks", "joints")


def _corners(middle_y: float, half_length: float, height: float) -> np.ndarray:
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (0, 1)])
    return signs * (HALF_WIDTH, half_length, height) + (0.0, middle_y, 0.0)


BODY = Proxy("box", np.column_stack([np.concatenate([_corners(*part) for part in PARTS]), np.zeros((16, 2))]))


def _cast(points: np.ndarray, light) -> np.ndarray:
    to_light = light.to_light_marker
    return points[:, :2] - points[:, 2:] * to_light[:2] / to_light[2]


# Narrower than the object.
NARROW = Proxy("box", BODY.spheroids_marker * (0.6, 1, 1, 1, 1))


def _filled(hull_px: np.ndarray, shape: tuple[int, int], finer: int = 1) -> np.ndarray:
    """(h, w) bool: the pixels, or so many times finer ones, within the convex hull of pixels (n, 2)."""
    mask = np.zeros((shape[0] * finer, shape[1] * finer), np.uint8)
    hull = cv2.convexHull(((hull_px + 0.5) * finer - 0.5).astype(np.float32))
    cv2.fillConvexPoly(mask, np.rint(hull).astype(np.int32), 1)
    return mask > 0


def _ground(kind: str, at: np.ndarray) -> np.ndarray:
    """(n, 3) linear colours at places (n, 2) of the plane."""
    tiles = np.floor(at / 0.025)
    if kind == "checks":
        is_pale = tiles.sum(axis=1) % 2 == 0
    elif kind == "joints":  # in shadow as bright as the tiles are in the light
        is_pale = (at - 0.025 * tiles < 0.004).any(axis=1)
    else:
        is_pale = np.zeros(len(at), bool)
    return np.where(is_pale[:, None], (0.75, 0.72, 0.7), (0.3, 0.22, 0.2))


class Painted:
    """A frame of the stepped object in a sun, and what is true in it."""

    def __init__(self, stage, kind: str, light, casts: bool = True) -> None:
        tracked = stage.tracked(0, stage.pose(-60, 50, 0.45, (0.0, 0.06, 0.0)))
        width, height = tracked.frame.size
        shape = height, width

        def seen(points: np.ndarray) -> np.ndarray:
            return project(tracked.camera, tracked.marker.T_cam_marker, points)

        def cast(points: np.ndarray) -> np.ndarray:
            to_light = light.to_light_marker
            return seen(points - points[:, 2:] * to_light / to_light[2])

        def ground_at(finer: int) -> np.ndarray:
            axes = ((np.arange(n * finer) + 0.5) / finer - 0.5 for n in (width, height))
            pixels = np.stack(np.meshgrid(*axes), axis=2).reshape(-1, 2)
            return raycast_to_plane(tracked.camera, tracked.marker.T_cam_marker, pixels)[:, :2]

        colours = _ground(kind, ground_at(FINER)).reshape(height * FINER, width * FINER, 3)
        self.ground_rgb = colours.mean(axis=(0, 1))
        parts = [_corners(*part) for part in PARTS]
        colours[np.any([_filled(cast(part), shape, FINER) for part in parts], axis=0) & casts] *= RATIO
        colours[np.any([_filled(seen(part), shape, FINER) for part in parts], axis=0)] = OBJECT_RGB
        rgb = cv2.resize(colours, (width, height), interpolation=cv2.INTER_AREA)
        noise = np.random.default_rng(5).normal(0, 1.5, rgb.shape)
        encoded = 255 * srgb_from_linear(cv2.GaussianBlur(rgb, (0, 0), 0.6)) + noise
        image = np.clip(np.rint(encoded), 0, 255).astype(np.uint8)[..., ::-1]
        self.tracked = replace(tracked, frame=Frame(np.ascontiguousarray(image), 0, 0.0))
        self.at = ground_at(1).reshape(height, width, 2)
        beside = cv2.dilate(_filled(seen(BODY.points_marker()), shape).astype(np.uint8), np.ones((13, 13))) == 0
        shaded = np.any([_filled(cast(part), shape) for part in parts], axis=0).astype(np.uint8)
        narrow = cv2.dilate(_filled(cast(NARROW.points_marker()), shape).astype(np.uint8), np.ones((3, 3)))
        self.beyond_narrow = beside & (cv2.erode(shaded, np.ones((5, 5))) > 0) & (narrow == 0)
        inner = np.ones((9, 9), np.uint8)  # four pixels from the shadow's border
        self.in_shadow = beside & (cv2.erode(shaded, inner) > 0)
        self.in_notch = beside & _filled(cast(BODY.points_marker()), shape) & (cv2.dilate(shaded, inner) == 0)


def _told(shadow, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The share of the light at places (..., 2), and how far it is told."""
    rows, columns = shadow.share.shape[:2]
    texels = (at - shadow.bounds[:2]) / (shadow.bounds[2:] - shadow.bounds[:2]) * (columns, rows) - 0.5
    x, y = np.moveaxis(texels.astype(np.float32), -1, 0)
    return tuple(np.moveaxis(cv2.remap(shadow.share, x, y, cv2.INTER_LINEAR, borderValue=0) / 255.0, -1, 0))


@pytest.fixture
def sun(stage):
    return stage.light(170, 35, tuple(RATIO))


@pytest.mark.parametrize("kind", GROUNDS)
def test_light_in_a_step_of_the_object_is_seen_and_its_shadow_stays(stage, sun, kind: str) -> None:
    painted = Painted(stage, kind, sun)
    (shadow,) = seen_shadows(BODY, painted.tracked, (sun,))
    assert np.array_equal(shadow.light, (*sun.to_light_marker, 0.0))
    share, told = _told(shadow, painted.at)
    assert painted.in_notch.sum() > 100
    assert painted.in_shadow.sum() > 1000
    assert ((share * told)[painted.in_notch] > 0.9).mean() > 0.9
    assert ((share * told)[painted.in_shadow] > 0.1).mean() < 0.005


def _stepped() -> Proxy:
    """The object itself, whose shadow is the painted one."""
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([corners for a, b, c, d in faces for corners in ((a, b, c), (a, c, d))])
    points = np.concatenate([_corners(*part) for part in PARTS])
    return replace(BODY, mesh=ProxyMesh(points, np.concatenate([triangles, triangles + 8]).astype(np.uint32)))


def _shaded(renderer, stage, painted: Painted, light, body: Proxy) -> np.ndarray:
    """The ground behind a wall, which keeps the light from all of the object's shadow."""
    lit = Illumination((light,), RATIO, painted.ground_rgb, body).as_seen_in(painted.tracked)
    wall = stage.placed(box((0.01, 0.5, 0.25)))
    scene = Scene(painted.tracked, wall, lit, placement=Placement(shift_m=(-0.12, 0.06)), shows_model=False)
    return stage.picture(renderer, scene).astype(int)


@pytest.mark.parametrize("kind", GROUNDS)
def test_shadow_beside_that_of_a_body_that_is_too_narrow_is_seen(stage, sun, kind: str) -> None:
    painted = Painted(stage, kind, sun)
    (shadow,) = seen_shadows(NARROW, painted.tracked, (sun,))
    share, told = _told(shadow, painted.at)
    assert painted.beyond_narrow.sum() > 100
    assert (((1 - share) * told)[painted.beyond_narrow] > 0.5).mean() > 0.8


@pytest.mark.parametrize(("quality", "kind"), in_turns((kind,) for kind in GROUNDS))
def test_model_takes_the_light_in_a_step_once_and_none_in_the_shadow(
    make_renderer, stage, sun, quality: str, kind: str
) -> None:
    painted, renderer = Painted(stage, kind, sun), make_renderer(QUALITIES[quality].render)
    drawn, true = (_shaded(renderer, stage, painted, sun, body) for body in (BODY, _stepped()))
    taken = painted.tracked.frame.image_bgr - true
    assert np.median(taken[painted.in_notch]) > 20
    for where in (painted.in_notch, painted.in_shadow):
        assert np.abs(drawn - true)[where].mean() < 1.0
        assert np.quantile(np.abs(drawn - true)[where], 0.95) <= 4


def test_light_that_was_moved_since_has_the_bodys_shadow(make_renderer, stage, sun, ctx) -> None:
    painted = Painted(stage, "plain", sun)
    maps = SeenShadowMaps(ctx, seen_shadows(BODY, painted.tracked, (sun,)))
    assert maps.of(np.array((*sun.to_light_marker, 0.0))) is not None
    assert maps.of(np.array((*stage.light(171, 35).to_light_marker, 0.0))) is None
    maps.release()
    renderer = make_renderer()
    shadows = renderer._models_on_video._ground_shadows
    lit = Illumination((sun,), RATIO, painted.ground_rgb, BODY).as_seen_in(painted.tracked)
    wall = stage.placed(box((0.01, 0.5, 0.25)))
    for light, error in ((sun, 0.0), (stage.light(171, 35, tuple(RATIO)), OUTLINE_ERROR), (sun, 0.0)):
        renderer.render(
            Scene(painted.tracked, wall, lit.relit((light,), RATIO), placement=Placement(shift_m=(-0.12, 0.06)))
        )
        assert shadows.outline_errors.tolist() == [error]


def test_nothing_is_said_where_no_shadow_is_seen_nor_of_a_mesh_nor_of_an_unmeasured_light(stage, sun) -> None:
    painted = Painted(stage, "plain", sun)
    assert seen_shadows(BODY, Painted(stage, "plain", sun, casts=False).tracked, (sun,)) == ()
    assert seen_shadows(_stepped(), painted.tracked, (sun,)) == ()
    for level in (0, 255):
        even = np.full_like(painted.tracked.frame.image_bgr, level)
        assert seen_shadows(BODY, replace(painted.tracked, frame=Frame(even, 0, 0.0)), (sun,)) == ()
    assert seen_shadows(BODY, painted.tracked, (replace(sun, shadow_rgb_ratio=None),)) == ()
    assert seen_shadows(BODY, None, (sun,)) == ()
    assert seen_shadows(BODY, replace(painted.tracked, marker=None), (sun,)) == ()
