"""The border of a virtual shadow, and of the model, is as sharp as the video that it stands in."""

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.bench.render.borders import shadow_border
from ashe_live.core.arrays import box_corners
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.light.explanation.border_widths import border_widths
from ashe_live.models.primitives import box
from ashe_live.quality import FAST, QUALITIES
from ashe_live.render.camera.edges import BOX_VARIANCE_PX2, SHARPENING_SIGMA_PX
from ashe_live.render.camera.grain import SILENT
from ashe_live.render.camera.video_look import VideoLook
from ashe_live.render.compositing.coarse import CoarseBlur, line_weights
from ashe_live.render.compositing.composite import SMALLEST, Composite, Footage, _weights
from ashe_live.render.gl.programs import Programs
from ashe_live.render.passes.surface import Surface
from ashe_live.render.passes.video import Video
from ashe_live.render.scene import Scene
from tests.render.camera.test_video_look import _sheet
from tests.render.in_turns import in_turns

TEN_TO_NINETY_SIGMAS = 2.563  # of a step that a Gaussian has blurred
HEIGHT = 0.05
BLACK = (0.0, 0.0, 0.0, 1.0)  # a tower whose sides light none of the ground


@pytest.mark.parametrize("variance", [0.05, 0.3, 0.6, 1.0, 2.0])
def test_kernel_has_the_variance_that_was_asked_for(variance: float) -> None:
    reach = 5
    weights = _weights(variance, reach)
    at = np.arange(-reach, reach + 1)
    line = weights[np.abs(at)]
    kernel = np.where(np.abs(at)[:, None] + np.abs(at) <= max(reach, SMALLEST), line[:, None] * line, 0.0)
    assert kernel.sum() == pytest.approx(1)
    assert (kernel >= 0).all()
    assert (kernel * at**2).sum() == pytest.approx(variance, rel=1e-3)


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("blur", [0.5, 0.8, 1.2])
def test_shadow_border_is_as_wide_as_the_cameras_blur_makes_it(make_renderer, stage, quality: str, blur: float) -> None:
    tracked = _sheet(stage, blur=blur)
    # A tall thin tower beside the marker, whose shadow falls on even ground; black, so that its sides light none of it.
    light = stage.light(45, 50, (0.2, 0.2, 0.2))
    points = box_corners(np.array([(-0.075, -0.02, 0.0), (-0.06, 0.02, HEIGHT)]))
    tower = stage.placed(box((0.015, 0.04, HEIGHT), BLACK).moved(1.0, np.array((-0.0675, 0.0, 0.0))))
    picture = stage.picture(make_renderer(QUALITIES[quality].render), Scene(tracked, tower, Illumination((light,))))
    places, outward = shadow_border(points, light.to_light_marker, tracked.camera, tracked.marker.T_cam_marker)
    widths = border_widths(picture, places, outward)
    # The far edge, where the sky that the tower hides changes no more; a sun of half a degree adds little.
    (foot,) = project(tracked.camera, tracked.marker.T_cam_marker, [(-0.0675, 0.0, 0.0)])
    away = np.linalg.norm(places - foot, axis=1)
    widths[away < np.median(away)] = np.nan
    expected = TEN_TO_NINETY_SIGMAS * np.sqrt(blur**2 + 1 / 12)
    assert np.isfinite(widths).sum() > 20
    assert 0.85 < np.nanmedian(widths) / expected < 1.2


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("across", [True, False])
def test_a_shadow_that_leaves_the_video_leaves_the_bars_beside_it_black(
    make_renderer, stage, quality: str, across: bool
) -> None:
    """As in a full screen of another shape; the shadow's end is blurred as the camera blurs."""
    tracked = _sheet(stage, blur=1.2)
    width, height = tracked.frame.size
    bars_px = 40
    renderer = make_renderer(QUALITIES[quality].render)
    renderer.resize((width + 2 * bars_px, height) if across else (width, height + 2 * bars_px))
    tower = stage.placed(box((0.04, 0.04, 0.3), BLACK))
    for azimuth_deg in range(0, 360, 90):
        shown = stage.picture(renderer, Scene(tracked, tower, Illumination((stage.light(azimuth_deg, 10),))))
        bars = (shown[:, :bars_px], shown[:, -bars_px:]) if across else (shown[:bars_px], shown[-bars_px:])
        assert not np.any(bars)


@pytest.mark.parametrize(("quality", "bars_px"), in_turns((bars,) for bars in ((40, 0), (0, 40), (33, 0))))
def test_bars_beside_the_video_do_not_change_a_shadow_that_leaves_it(
    make_renderer, stage, quality: str, bars_px: tuple[int, int]
) -> None:
    tracked = _sheet(stage, blur=1.2)
    width, height = tracked.frame.size
    across, up = bars_px
    renderer = make_renderer(QUALITIES[quality].render)
    tower = stage.placed(box((0.04, 0.04, 0.3), BLACK))
    for azimuth_deg in range(0, 360, 90):
        scene = Scene(tracked, tower, Illumination((stage.light(azimuth_deg, 10),)))
        renderer.resize((width, height))
        alone = stage.picture(renderer, scene)
        renderer.resize((width + 2 * across, height + 2 * up))
        within = stage.picture(renderer, scene)[up : up + height, across : across + width]
        assert np.abs(within.astype(int) - alone).max() <= 1


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_a_shadow_is_as_soft_as_the_real_one_though_the_camera_sharpens_its_marker(
    make_renderer, stage, quality: str
) -> None:
    """Strong edges are steep and the shadow's are not, as in a phone's picture, and nobody knows why."""
    tracked = _sheet(stage, blur=0.4)
    light = stage.light(45, 50, (0.2, 0.2, 0.2))
    post = Proxy("lathe", np.array([(-0.05, 0.06, 0.0, 0.012, 0.0), (-0.05, 0.06, 0.06, 0.012, 0.0)]))
    camera, T = tracked.camera, tracked.marker.T_cam_marker
    body = post.points_marker()
    cast = body[:, :2] - body[:, 2:] * (light.to_light_marker[:2] / light.to_light_marker[2])
    hull = cv2.convexHull(project(camera, T, np.column_stack([cast, np.zeros(len(cast))])).astype(np.float32))
    shade = np.zeros(tracked.frame.image_bgr.shape[:2], np.uint8)
    cv2.fillConvexPoly(shade, np.round(hull * 16).astype(int), 255, cv2.LINE_AA, 4)
    share = cv2.GaussianBlur(shade / 255.0, (0, 0), 1.3)[..., None]
    linear = LINEAR_FROM_SRGB_8BIT[tracked.frame.image_bgr] * (1 - 0.8 * share)
    image = np.round(255 * srgb_from_linear(linear)).astype(np.uint8)
    tracked = replace(tracked, frame=replace(tracked.frame, image_bgr=image))
    tower = stage.placed(box((0.015, 0.04, HEIGHT), BLACK).moved(1.0, np.array((-0.0675, 0.0, 0.0))))
    renderer = make_renderer(QUALITIES[quality].render)
    renderer.render(Scene(tracked, tower, Illumination((light,), real_object=post, seen_in=tracked)))
    points = box_corners(np.array([(-0.075, -0.02, 0.0), (-0.06, 0.02, HEIGHT)]))
    ours, real = (
        np.nanmedian(border_widths(picture, *shadow_border(body_points, light.to_light_marker, camera, T)))
        for picture, body_points in ((renderer.read_bgr(), points), (image, body))
    )
    assert 0.85 < ours / real < 1.2


@pytest.mark.parametrize("sharpening", [0.0, 0.5])
@pytest.mark.parametrize("blur", [0.5, 0.8, 1.2])
def test_where_a_models_shadow_meets_a_blurred_real_one_no_line_is_left(
    make_renderer, stage, blur: float, sharpening: float
) -> None:
    """All along a line across the border of the real shadow the ground is as dark as in either shadow."""
    ratio, height, border = 0.3, 0.05, -0.09
    bare = _sheet(stage)
    camera, T_cam_marker = bare.camera, bare.marker.T_cam_marker
    columns, rows = np.meshgrid(np.arange(4 * camera.size[0]), np.arange(4 * camera.size[1]))
    pixels = (np.column_stack([columns.ravel(), rows.ravel()]) + 0.5) / 4 - 0.5
    is_shaded = raycast_to_plane(camera, T_cam_marker, pixels)[:, 1].reshape(rows.shape) < border
    shaded = cv2.resize(is_shaded.astype(float), camera.size, interpolation=cv2.INTER_AREA)[..., None]
    scene = LINEAR_FROM_SRGB_8BIT[bare.frame.image_bgr] * (1 - (1 - ratio) * shaded)
    encoded = srgb_from_linear(cv2.GaussianBlur(scene, (0, 0), blur))
    encoded += sharpening * (encoded - cv2.GaussianBlur(encoded, (0, 0), 1.0))
    video = np.clip(np.round(255 * encoded), 0, 255).astype(np.uint8)
    tracked = replace(bare, frame=replace(bare.frame, image_bgr=video))
    # In light from -x: an object whose shadow is that half of the ground; and a black model before it, so far from what
    # is looked at that it hides none of its sky.
    corners = [(x, y, z, 0.0, 0.0) for x in (-0.14, -0.10) for y in (-0.3, border) for z in (0.0, 2 * height)]
    model = stage.placed(box((0.03, 0.06, height), BLACK).moved(1.0, np.array([-0.08, border, 0.0])))
    lit_rgb = np.full(3, LINEAR_FROM_SRGB_8BIT[bare.frame.image_bgr[-1, 0]])
    illumination = Illumination(
        (stage.light(180, 30, (ratio,) * 3),), real_object=Proxy("box", np.array(corners)), ground_rgb=lit_rgb
    )
    renderer = make_renderer(replace(FAST.render, matches_noise=False))
    picture = stage.picture(renderer, Scene(tracked, model, illumination))
    places = [(0.013, border + away, 0.0) for away in np.linspace(-0.006, 0.006, 41)]
    across = np.round(project(camera, T_cam_marker, places)).astype(int)
    left = LINEAR_FROM_SRGB_8BIT[picture[across[:, 1], across[:, 0], 1]] / lit_rgb[0] / ratio
    assert left.max() < 1.09
    assert left.min() > 0.87  # a sharpened picture has a dark line in the real shadow's own border


@pytest.mark.parametrize("sigma", [1.0, 1.5, 2.5, 3.5])
def test_blur_at_half_the_resolution_has_the_variance_that_was_asked_for(sigma: float) -> None:
    """With the mean of two pixels before it and interpolation after it, in the mean of both phases."""
    blur = CoarseBlur.of(sigma**2)
    weights = line_weights(*blur)
    line = weights[np.abs(np.arange(-blur.taps, blur.taps + 1))]
    size = 80
    variances = []
    for lit in (40, 41):
        row = np.zeros(size)
        row[lit] = 1.0
        half = np.convolve(row.reshape(-1, 2).mean(axis=1), line, mode="same")
        result = np.interp(np.arange(size) + 0.5, 2 * np.arange(size // 2) + 1.0, half)
        assert result.sum() == pytest.approx(1)
        variances.append(float(result @ (np.arange(size) - lit) ** 2))
    assert np.mean(variances) == pytest.approx(sigma**2, rel=0.02)


@pytest.fixture
def beside_light(ctx, stage) -> Callable[..., np.ndarray]:
    """(64, 64, 3) int BGR: the left half is a surface of that light (linear RGB), the right half is ground."""

    def compose(light: tuple[float, float, float], look: VideoLook, ground_bgr: tuple[int, int, int]) -> np.ndarray:
        tracked = stage.tracked(np.full((64, 64, 3), ground_bgr, np.uint8), None)
        whole = (0, 0, 64, 64)
        surface, video, programs = Surface(ctx, (64, 64), 0), Video(ctx), Programs(ctx)
        composite = Composite(ctx, programs)
        video.show(tracked, whole)
        added = np.zeros((64, 64, 4), np.float16)
        added[:, :32] = (*light, 1.0)
        for layer, values in zip(surface.layers, (added, np.repeat(added[..., 3:], 4, axis=2)), strict=True):
            layer.write(np.ascontiguousarray(values).tobytes())
        video.copy_or_draw(surface.colour, whole)
        composite.draw(surface, whole, Footage(whole, video, tracked, look))
        picture = surface.read_bgr().astype(int)
        ctx.detect_framebuffer(0).use()  # what is bound must not be released
        for held in (composite, video, surface, programs):
            held.release()
        return picture

    return compose


def test_lights_that_a_picture_shows_alike_have_the_same_borders(beside_light) -> None:
    """White and gold that are both overexposed, on red ground whose colours are coarse: gold's had green rims."""
    look, ground = VideoLook((0.8, 0.8, 0.8), 0.4, SILENT, 0.0, chroma_blur_px=2.0), (30, 90, 170)
    white, gold = (beside_light(light, look, ground) for light in ((4.0, 4.0, 4.0), (6.0, 4.0, 1.2)))
    assert white[:, :20].min() >= 254
    assert np.abs(white[:, 45:] - ground).max() <= 1
    assert np.abs(white - gold).max() <= 8


@pytest.mark.parametrize("light", [1.0, 3.0, 8.0])
def test_what_is_beyond_white_is_sharpened_as_by_a_camera_that_clips_first(beside_light, light: float) -> None:
    """Beside a highlight a sharpened picture has a dark line, but not a darker one the farther that is beyond white."""
    blur, sharpening, ground = 0.4, 0.6, 124
    seen = beside_light((light, light, light), VideoLook((0.8, 0.8, 0.8), blur, SILENT, sharpening), (ground,) * 3)

    def blurred(row: np.ndarray, variance: float) -> np.ndarray:
        at = np.arange(-8, 9)
        kernel = np.exp(-(at**2) / (2 * variance))
        return np.convolve(np.pad(row, 8, mode="edge"), kernel / kernel.sum(), "valid")

    scene = np.where(np.arange(64) < 32, light, LINEAR_FROM_SRGB_8BIT[ground])
    clipped = srgb_from_linear(np.minimum(blurred(scene, blur**2 + BOX_VARIANCE_PX2), 1.0))
    sharpened = clipped + sharpening * (clipped - blurred(clipped, SHARPENING_SIGMA_PX**2))
    expected = 255 * np.clip(sharpened, 0.0, 1.0)
    assert expected.min() < ground - 5
    assert np.abs(seen[32] - expected[:, None]).max() < 20
