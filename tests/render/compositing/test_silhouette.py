"""Across the real object's outline the picture is what a camera would show of object, shadow and model."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.scene import Scene
from tests.render.camera.test_video_look import _sheet

FINE = 8
BLACK = (0.0, 0.0, 0.0, 1.0)
CORNERS = [(x, y, z) for x in (-0.105, -0.08) for y in (-0.032, -0.008) for z in (0.0, 0.05)]
POST = Proxy("box", np.array([(*corner, 0.0, 0.0) for corner in CORNERS]))
SHADOW = "shadow"
MODEL = "model"


def _covered(camera: Camera, T_cam_marker: Float, blur: float, off_px: float = 0.0) -> np.ndarray:
    """(h, w) share of each pixel that shows the object, `off_px` to the right of its proxy, by a lens of this blur."""
    outline = cv2.convexHull((project(camera, T_cam_marker, CORNERS) + np.array([off_px, 0.0])).astype(np.float32))
    fine = np.zeros((FINE * camera.size[1], FINE * camera.size[0]))
    cv2.fillConvexPoly(fine, np.round(((outline + 0.5) * FINE - 0.5) * 16).astype(int), 1.0, shift=4)
    return cv2.GaussianBlur(cv2.resize(fine, camera.size, interpolation=cv2.INTER_AREA), (0, 0), blur)


def _with_object(image: np.ndarray, covered: np.ndarray, level: float) -> np.ndarray:
    """(h, w) levels of a grey picture in which an object of this linear brightness covers so much of each pixel."""
    linear = LINEAR_FROM_SRGB_8BIT[image[..., 1]]
    return 255 * srgb_from_linear(linear + covered * (level - linear))


def _video(bare: TrackedFrame, levels: np.ndarray) -> TrackedFrame:
    grey = np.repeat(np.round(levels).astype(np.uint8)[..., None], 3, axis=2)
    return replace(bare, frame=replace(bare.frame, image_bgr=grey))


def _levels_off(
    make_renderer, stage, preset: RenderPreset, behind: str, level: float, blur: float, off_px: float
) -> np.ndarray:
    """Signed levels by which the picture is too bright beside the outline of an object of that linear brightness.

    The object in the video is `off_px` to the right of its proxy.
    """
    bare = _sheet(stage, blur=blur)
    camera, T_cam_marker = bare.camera, bare.marker.T_cam_marker
    covered = _covered(camera, T_cam_marker, blur, off_px)

    def with_object(image: np.ndarray) -> np.ndarray:
        return _with_object(image, covered, level)

    # In light from -x: a model whose shadow, or which itself, is behind the object in the picture.
    model = box((0.02, 0.12, 0.06), BLACK).moved(1.0, np.array([-0.125, 0.06, 0.0]))
    if behind == MODEL:
        model = stage.glowing_green(box((0.08, 0.01, 0.06)).moved(1.0, np.array([-0.09, 0.04, 0.0])))
    placed = stage.placed(model)
    light = stage.light(180, 30, (0.3, 0.3, 0.3))
    renderer = make_renderer(replace(preset, matches_noise=False))
    alone = stage.picture(renderer, Scene(bare, placed, Illumination((light,))))
    video = _video(bare, with_object(bare.frame.image_bgr))
    picture = stage.picture(renderer, Scene(video, placed, Illumination((light,), real_object=POST)))
    # Where what is behind the object is even, and changed.
    window = np.ones((9, 9))
    even = cv2.dilate(alone[..., 1], window).astype(int) - cv2.erode(alone[..., 1], window) <= 3
    changed = np.abs(alone[..., 1].astype(int) - bare.frame.image_bgr[..., 1]) > 20
    at_outline = cv2.dilate(covered, window) - cv2.erode(covered, window) > 0.05
    looked_at = even & changed & at_outline
    assert looked_at.sum() > 150
    return (picture[..., 1] - with_object(alone))[looked_at]


@pytest.mark.parametrize("behind", [SHADOW, MODEL])
@pytest.mark.parametrize("level", [0.01, 0.06, 0.7])
@pytest.mark.parametrize("blur", [0.3, 0.6])
def test_there_is_no_line_along_an_object_before_a_shadow_or_a_model(
    make_renderer, stage, behind: str, level: float, blur: float
) -> None:
    """Blurred as if the object were as bright as the ground, dark ones have lines up to 50 levels brighter there."""
    off = _levels_off(make_renderer, stage, BALANCED.render, behind, level, blur, 0.0)
    assert np.sqrt(np.mean(off**2)) < 2.8
    assert np.percentile(np.abs(off), 95) < 5


@pytest.mark.parametrize("behind", [SHADOW, MODEL])
@pytest.mark.parametrize("off_px", [-1.0, 1.0])
def test_there_is_no_sliver_beside_an_object_whose_outline_is_a_pixel_off(
    make_renderer, stage, behind: str, off_px: float
) -> None:
    off = _levels_off(make_renderer, stage, BALANCED.render, behind, 0.03, 0.6, off_px)
    assert np.sqrt(np.mean(off**2)) < 3
    assert np.percentile(np.abs(off), 99) < 10


def _edge_px(make_renderer, stage, bare: TrackedFrame, levels: np.ndarray, matches: bool = True) -> Float:
    """(rows,) the column in which POST, with these levels in the video, ends to the right before a model."""
    video = _video(bare, levels.clip(0, 255))
    # Behind all of the object in the picture, and black, so that what is left of the video tells how far that reaches.
    wall = box((0.3, 0.01, 0.3), BLACK).moved(1.0, np.array([-0.09, 0.0, 0.0]))
    renderer = make_renderer(replace(BALANCED.render, matches_noise=False, matches_outline=matches))
    picture = stage.picture(renderer, Scene(video, stage.placed(wall), Illumination(real_object=POST)))
    corners = project(bare.camera, bare.pose.T_cam_marker, [(-0.08, -0.008, z) for z in (0.008, 0.046)])
    (column, low), (_, high) = np.round(corners).astype(int)
    beside = slice(high, low), slice(column - 6, column + 7)
    drawn, seen = (LINEAR_FROM_SRGB_8BIT[image[(*beside, 1)]] for image in (picture, video.frame.image_bgr))
    return np.asarray((drawn / seen).clip(0, 1).sum(axis=1) + column - 6)


def _teeth_px(edge: Float) -> float:
    """RMS of how far an edge in one row is from where it is in the rows above and below."""
    return float(np.sqrt(np.mean((edge[1:-1] - (edge[:-2] + edge[2:]) / 2) ** 2)))


@pytest.mark.parametrize(("grain", "most_px"), [(5.0, 0.13), (8.0, 0.18)])
def test_a_straight_outline_between_grainy_surfaces_has_no_teeth(
    make_renderer, stage, grain: float, most_px: float
) -> None:
    """As each pixel's own few looks say, it would be the video's in one pixel and the body's in the next.

    `grain`: of object and ground, the deviation in levels.
    """
    bare = _sheet(stage, blur=0.6)
    squares = []
    for off_px in (-1.5, 0.0, 1.5):
        covered = _covered(bare.camera, bare.pose.T_cam_marker, 0.6, off_px)
        levels = _with_object(bare.frame.image_bgr, covered, 0.6)
        for seed in range(5):
            noise = cv2.GaussianBlur(np.random.default_rng(seed).normal(0, 1, covered.shape), (0, 0), 0.7)
            edge = _edge_px(make_renderer, stage, bare, levels + grain * noise / noise.std())
            squares.append(_teeth_px(edge) ** 2)
    assert np.sqrt(np.mean(squares)) < most_px


def test_an_object_with_a_rim_as_bright_as_the_ground_ends_where_its_body_does(make_renderer, stage) -> None:
    """The border within it, between its rim and what is darker, is not its outline."""
    bare = _sheet(stage, blur=0.6)
    levels = _with_object(bare.frame.image_bgr, _covered(bare.camera, bare.pose.T_cam_marker, 0.6, -4.0), 0.03)
    matched, drawn = (_edge_px(make_renderer, stage, bare, levels, matches) for matches in (True, False))
    assert np.abs(matched - drawn).max() < 0.2


def test_an_object_as_bright_as_the_ground_has_the_outline_that_is_drawn(make_renderer, stage) -> None:
    """Its outline cannot be told in the video: the picture is as good as without looking for it."""
    matched, drawn = (
        _levels_off(make_renderer, stage, replace(BALANCED.render, matches_outline=matches), SHADOW, 0.22, 0.6, 0.0)
        for matches in (True, False)
    )
    assert np.sqrt(np.mean(matched**2)) < 1.05 * np.sqrt(np.mean(drawn**2))


def test_a_model_in_front_of_the_object_is_drawn_as_if_no_outline_were_behind_it(make_renderer, stage) -> None:
    bare = _sheet(stage, blur=0.6)
    covered = _covered(bare.camera, bare.pose.T_cam_marker, 0.6)
    video = _video(bare, _with_object(bare.frame.image_bgr, covered, 0.01))
    around = Placement(shift_m=(-0.0925, -0.02))  # the object is inside of the block
    block, illumination = placed_on_marker(load_model("cube"), 0.08), Illumination(real_object=POST)
    matched, drawn = (
        stage.picture(
            make_renderer(replace(BALANCED.render, matches_noise=False, matches_outline=matches)),
            Scene(video, block, illumination, placement=around),
        ).astype(int)
        for matches in (True, False)
    )
    changed = np.abs(drawn - video.frame.image_bgr).max(axis=2) > 20
    assert (changed & (covered > 0.5)).sum() > 0.95 * (covered > 0.5).sum()
    assert np.abs(matched - drawn)[covered > 0].max() <= 1
