"""A hand before the covered sheet is seen before it, and a shadow that comes onto the sheet goes on on its cover."""

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE, srgb_from_linear
from ashe_live.core.light import Illumination, Light
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED
from ashe_live.render.camera.exposure import gain_and_slope
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.cover.ground_cover import ground_cover
from ashe_live.render.cover.over_sheet import TEXELS_A_SIDE, over_sheet
from ashe_live.render.scene import Scene

SIDE = 0.08
PAPER_HALF = 0.62 * SIDE
GROUND, PAPER, INK, SKIN = (0.42, 0.28, 0.16), (0.75, 0.75, 0.75), (0.03, 0.03, 0.03), (0.5, 0.29, 0.2)
RATIO = np.array((0.25, 0.3, 0.38))
ONE_SUN = Illumination((Light((0.5, 0.2, 0.8), shadow_rgb_ratio=RATIO),))
ONE_LAMP = Illumination((Light((0.5, 0.2, 0.8), inverse_distance=0.5, intensity_rgb_ratio=1 / RATIO - 1),))


def finger(x, y):
    """Across paper, ink and a white cell."""
    return (np.abs(y - 0.4 * x) < 0.009) & (x > -0.03)


def shade(x, y):
    return np.abs(x + 0.3 * y - 0.015) < 0.022


def compressed(linear):
    """A tone curve with a shoulder from half of full scale on."""
    return np.where(linear < 0.5, linear, 0.5 + 0.35 * np.log1p(np.maximum(linear - 0.5, 0) / 0.35))


def view(
    stage,
    hand=None,
    shaded=None,
    azimuth: float = -80.0,
    gain=1.0,
    noise: float = 0.7,
    dist=(0.0,) * 5,
    toned=lambda linear: linear,
):
    """A table with a printed sheet; `hand` and `shaded` ((n,), (n,)) metres -> (n,) where these are."""
    T, plain = stage.pose(azimuth, 55, 0.36), stage.camera()
    camera = Camera(plain.size, plain.K, np.array(dist), "file")
    rows, columns = np.mgrid[0:360, 0:480]
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
    straight = cv2.undistortPoints(pixels[:, None], camera.K, camera.dist, P=camera.K)[:, 0]
    x, y, _ = raycast_to_plane(plain, T, straight).T
    linear = np.array(GROUND) * (1 + 0.1 * np.sin(400 * y + 3 * np.sin(60 * x)))[:, None]
    away = np.maximum(np.abs(x), np.abs(y))
    linear[away < PAPER_HALF] = PAPER
    is_cell = (np.abs(x - 0.02) < SIDE / 12) | (np.abs(y + 0.015) < SIDE / 12)
    linear[(away < SIDE / 2) & ~(is_cell & (away < SIDE / 3))] = INK
    if shaded is not None:
        linear[shaded(x, y)] *= RATIO
    if hand is not None:
        linear[hand(x, y)] = SKIN
    picture = 255 * srgb_from_linear(np.clip(toned(gain * linear), 0, 1)).reshape(360, 480, 3)[..., ::-1]
    picture = cv2.GaussianBlur(picture, (0, 0), 0.6)
    picture += np.random.default_rng(round(-1000 * azimuth)).normal(0, 1, picture.shape) * noise
    frame = Frame(np.ascontiguousarray(np.clip(np.round(picture), 0, 255).astype(np.uint8)), 1, 0.0)
    corners = project_distorted(camera, T, square_corners(SIDE))
    return TrackedFrame(frame, camera, MarkerPose(T, corners, SIDE, 0.0, None))


def compared(before: TrackedFrame, now: TrackedFrame, illumination: Illumination = ONE_SUN):
    """(h, w) x and y of the places compared, and (h, w, 2) what is over them, or None."""
    cover = ground_cover(before, illumination, is_draft=True)
    assert cover is not None
    assert cover.sheet is not None
    gain, slope = gain_and_slope(now, cover.around, cover.around_rgb)
    x, y = np.moveaxis(cover.sheet.places, 2, 0)
    return x, y, over_sheet(now, cover.sheet, gain, slope)


def inside(x, y, shape, margin_m: float = 0.004):
    """Where all places within a margin are in the shape, and where none is; on the sheet."""
    steps = [(0, 0), (margin_m, 0), (-margin_m, 0), (0, margin_m), (0, -margin_m)]
    near = np.array([shape(x + right, y + up) for right, up in steps])
    on_sheet = np.maximum(np.abs(x), np.abs(y)) < PAPER_HALF - margin_m
    return near.all(axis=0) & on_sheet, ~near.any(axis=0) & on_sheet


@pytest.mark.parametrize("dist", [(0.0,) * 5, (-0.25, 0.06, 0.0, 0.0, 0.0)], ids=["straight", "distorted"])
@pytest.mark.parametrize("gain", [1.0, (0.8, 0.7, 0.75)], ids=["as before", "darker"])
def test_a_hand_is_seen_on_paper_and_ink_alike(stage, gain, dist) -> None:
    x, y, over = compared(view(stage, dist=dist), view(stage, hand=finger, azimuth=-78, gain=gain, dist=dist))
    within, beside = inside(x, y, finger)
    assert over[within, 0].min() > 0.5
    assert over[beside, 0].max() < 0.5


def test_a_hand_has_no_rim_of_the_paper_beside_it(stage) -> None:
    x, y, over = compared(view(stage), view(stage, hand=finger))
    texel = SIDE / TEXELS_A_SIDE
    is_near = finger(x + texel, y) | finger(x - texel, y) | finger(x, y + texel) | finger(x, y - texel)
    on_sheet = np.maximum(np.abs(x), np.abs(y)) < PAPER_HALF - 0.004
    assert over[is_near & ~finger(x, y) & on_sheet, 0].mean() < 0.1
    assert over[finger(x, y) & on_sheet, 0].mean() > 0.75


@pytest.mark.parametrize("illumination", [ONE_SUN, ONE_LAMP], ids=["sun", "lamp of known intensity"])
def test_a_shadow_is_seen_on_paper_and_goes_on_across_the_ink(stage, illumination) -> None:
    x, y, over = compared(view(stage), view(stage, shaded=shade), illumination)
    within, beside = inside(x, y, shade, 0.012)
    assert over[..., 0].max() == 0
    np.testing.assert_allclose(over[within, 1], np.log(RATIO) @ REC709_LUMINANCE, atol=0.15)
    assert np.abs(over[beside, 1]).max() < 0.02


def test_what_comes_with_its_own_shadow_is_told_from_it(stage) -> None:
    both = view(stage, hand=lambda x, y: finger(x, y) & ~shade(x, y), shaded=shade)
    x, y, over = compared(view(stage), both)
    within, beside = inside(x, y, finger)
    assert over[within & inside(x, y, shade)[1], 0].min() > 0.5
    assert over[beside, 0].max() < 0.5
    assert np.median(over[inside(x, y, shade, 0.012)[0], 1]) == pytest.approx(np.log(RATIO) @ REC709_LUMINANCE, abs=0.1)


@pytest.mark.parametrize("azimuth", [-80.3, -75.0, -55.0])
@pytest.mark.parametrize("gain", [1.0, 0.6, (0.9, 1.0, 1.1)])
def test_nothing_is_seen_where_only_camera_and_exposure_have_changed(stage, azimuth, gain) -> None:
    assert compared(view(stage), view(stage, azimuth=azimuth, gain=gain))[2] is None


def test_paper_that_the_tone_curve_compresses_as_the_light_grows_is_in_no_shadow(stage) -> None:
    """As when the sun comes out, and the exposure follows only later."""
    assert compared(view(stage), view(stage, gain=1.7, toned=compressed))[2] is None
    x, y, over = compared(view(stage), view(stage, shaded=shade, gain=1.7, toned=compressed))
    within, beside = inside(x, y, shade, 0.012)
    assert np.abs(over[beside, 1]).max() < 1e-6
    assert over[within, 1].max() < -0.5


def test_a_sheet_that_a_hand_was_on_is_covered_once_it_has_gone(stage) -> None:
    over = compared(view(stage, hand=finger), view(stage, azimuth=-79))[2]
    assert over is None or over[..., 0].max() == 0


def test_a_hand_is_drawn_before_the_cover_and_the_rest_stays_covered(make_renderer, stage) -> None:
    aside = stage.placed(box((0.01, 0.01, 0.01)).moved(1.0, np.array((-0.075, 0.06, 0.0))))
    renderer = make_renderer(BALANCED.render)
    before, now = view(stage), view(stage, hand=finger)
    pictures = []
    for tracked in (before, now):
        pictures.append(stage.picture(renderer, Scene(tracked, aside, covers_marker=True)).astype(float))
    T, camera = now.marker.T_cam_marker, now.camera
    x, y = np.mgrid[-PAPER_HALF:PAPER_HALF:60j, -PAPER_HALF:PAPER_HALF:60j]
    at = np.round(project_distorted(camera, T, np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]))).astype(int)
    column, row = at.T.reshape(2, *x.shape)
    within, beside = inside(x, y, finger)
    as_seen = np.abs(pictures[1] - now.frame.image_bgr).max(axis=2)[row, column]
    as_covered = np.abs(pictures[1] - pictures[0]).max(axis=2)[row, column]
    assert np.quantile(as_seen[within], 0.95) < 12
    assert np.quantile(as_covered[beside], 0.95) < 12


def test_the_models_shadow_takes_no_light_that_another_shadow_has_taken(make_renderer, stage) -> None:
    light = stage.light(-60, 35, tuple(RATIO))
    model, illumination = stage.placed(box((0.012, 0.012, 0.06))), Illumination((light,))
    renderer = make_renderer(BALANCED.render)
    pictures = []
    for tracked in (view(stage), view(stage, shaded=lambda x, y: np.hypot(x, y) < 0.9 * SIDE)):
        renderer.render(Scene(tracked, model, illumination, covers_marker=True))
        pictures.append(LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()[..., ::-1]])
    way = light.to_light_marker[:2] / light.to_light_marker[2]
    aside = 0.02 * np.array((-way[1], way[0])) / np.linalg.norm(way)
    spots = [(*(-0.036 * way), 0.0), (*(-0.036 * way + aside), 0.0)]  # in the model's shadow, and beside it
    at = np.round(project_distorted(tracked.camera, tracked.marker.T_cam_marker, np.array(spots))).astype(int)
    lit, shaded = (
        [each[row - 1 : row + 2, column - 1 : column + 2].mean(axis=(0, 1)) for column, row in at] for each in pictures
    )
    np.testing.assert_allclose(shaded[0], lit[0], rtol=0.12)
    np.testing.assert_allclose(shaded[1], RATIO * lit[1], rtol=0.15)
