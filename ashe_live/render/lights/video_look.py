"""The video's exposure, blur and noise, which the model must have to look as if the same camera had filmed it.

Everything is measured at the printed marker, of one frame: white paper around a black square with sharp edges.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import along_sides, mean_side_px
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.render.lights.cast_shadows import lit_past, shadow_hull
from ashe_live.render.lights.lighting import RGB, Lighting, Sun

PAPER_ALBEDO = 0.8  # of office paper, which reflects all colours alike
# Where nothing can be measured: paper comes out a little below the display's white, as in a well exposed photo.
ASSUMED_WHITE = 0.8
MIN_CONTRAST = 1.6  # of paper over black ink
RING_SIDES = (0.57, 0.62)  # from the marker's centre, in sides: on the paper's margin
LEAST_LEVEL = 0.05  # of the light in a shadow: black says nothing about white
MIN_PAPER = 0.02  # its linear brightness in the picture: darker is no white
AROUND = 12  # places along each of a polygon's edges
REACH_PX, STEP_PX = 7.0, 0.25  # of a profile across an edge, to both sides
BLUR_RANGE_PX = (0.0, 3.0)
BOX_VARIANCE_PX2 = 1 / 12  # of a pixel, which the model's own pixels have too
INTERPOLATION_VARIANCE_PX2 = 1 / 6  # of bilinear sampling, on average
NOISE_WINDOW_PX = 160
BODY_PRINT_SHARE = 0.7  # of a body's edge: the black square on its faces, as `tracking.cube.faces` has it printed
MOST_BORDER_PX = 1.5  # in a picture 640 pixels wide
LEAST_SINE = 0.1  # of a light's elevation, for how long its shadows are
COARSE_CHROMA = 0.6  # between the 1/2 of repeated pixels and the 1 of independent ones
LEAST_CHROMA_DETAIL = 0.05  # levels squared, that there is something to tell it by


@dataclass(frozen=True, slots=True)
class VideoLook:
    """Measured in one frame."""

    white_rgb: RGB  # linear RGB in the picture of a fully lit, level, perfectly white surface
    # Of the lens and the processing, beyond the pixel's own area; pixels of the video. None: not asked for.
    blur_sigma_px: float | None
    noise_sigma: float  # standard deviation of the encoded values in [0, 1]
    has_coarse_chroma: bool = False  # colour at half the resolution, as most encodings of video and photos have it


def white_of(tracked: TrackedFrame, lighting: Lighting | None = None, real_object: Proxy | None = None) -> RGB:
    """Linear RGB that white, fully lit at the marker's centre, has in a frame with a marker; grey without any paper.

    `lighting`: with lamps in it the paper is brighter towards them, and all of it may be in the real object's shadow.
    """
    assert tracked.marker is not None
    half = _print_side_m(tracked)
    along = np.linspace(-0.5, 0.5, AROUND)
    ring = np.concatenate([[(x, r), (x, -r), (r, x), (-r, x)] for r in RING_SIDES for x in along])
    inside = np.concatenate([[(0.45 * s, 0.9 * x), (0.9 * x, 0.45 * s)] for s in (-1, 1) for x in along])
    level = partial(_level, lighting, real_object)
    paper, ink = (_linear_at(tracked, half * points, level) for points in (ring, inside))
    grey = (ASSUMED_WHITE, ASSUMED_WHITE, ASSUMED_WHITE)
    if len(paper) < AROUND or len(ink) < AROUND:
        return grey
    brightness = paper @ REC709_LUMINANCE
    # Some of the paper may lie in a shadow.
    lit = paper[brightness >= np.quantile(brightness, 0.6)]
    if np.median(brightness) < max(MIN_CONTRAST * np.median(ink @ REC709_LUMINANCE), MIN_PAPER):
        return grey
    red, green, blue = (float(value) / PAPER_ALBEDO for value in lit.mean(axis=0))
    return red, green, blue


def look_of(
    tracked: TrackedFrame,
    blur: bool = True,
    noise: bool = True,
    lighting: Lighting | None = None,
    real_object: Proxy | None = None,
) -> VideoLook:
    """White (as `white_of`), blur and noise of a frame with a marker; None or 0 for what is not asked for."""
    assert tracked.marker is not None
    white = white_of(tracked, lighting, real_object)
    if not blur and not noise:
        return VideoLook(white, None, 0.0)
    grey = np.asarray(cv2.cvtColor(tracked.frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
    corners = tracked.marker.corners_px
    if tracked.marker.body is not None:
        half = 0.5 * _print_side_m(tracked)
        corners = _pixels(tracked, np.array([(-half, half), (half, half), (half, -half), (-half, -half)]))
    middle = corners.mean(axis=0)
    return VideoLook(
        white,
        edge_blur_px(grey, corners) if blur else None,
        noise_sigma(_window(grey, middle)) / 255 if noise else 0.0,
        blur and has_coarse_chroma(_window(tracked.frame.image_bgr, middle)),
    )


def edge_blur_px(grey: Image, corners_px: Float) -> float:
    """Sigma of the blur, in pixels, of (h, w) uint8 at the border of a dark convex polygon (k, 2); 0 if not to be told.

    Of a step blurred by a Gaussian, height over steepest slope is sqrt(2 pi) sigma. Profiles across the polygon's edges
    are brought together at their middles, in linear light.
    """
    offsets = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
    points, outwards = along_sides(corners_px, np.linspace(0.15, 0.85, AROUND))
    at = points[:, :, None] + offsets[:, None] * outwards[:, None, None]
    at = at.reshape(-1, len(offsets), 2)
    whole = ((at > 0) & (at < np.array(grey.shape[::-1]) - 1)).all(axis=(1, 2))
    if whole.sum() < AROUND:
        return 0.0
    x, y = np.moveaxis(at[whole].astype(np.float32), 2, 0)
    profiles = LINEAR_FROM_SRGB_8BIT[np.round(cv2.remap(grey, x, y, cv2.INTER_LINEAR)).astype(np.uint8)]
    black, white = np.median(profiles[:, :4], axis=1), np.median(profiles[:, -4:], axis=1)
    height = white - black
    good = height > 0.5 * np.median(height)
    if np.median(height) < 0.05 or good.sum() < AROUND:
        return 0.0
    steps = (profiles[good] - black[good, None]) / height[good, None]
    middles = np.abs(steps - 0.5).argmin(axis=1)
    reach = int(5 / STEP_PX)
    near = (middles >= reach) & (middles < len(offsets) - reach)
    if near.sum() < AROUND:
        return 0.0
    columns = middles[near, None] + np.arange(-reach, reach + 1)
    step = np.take_along_axis(steps[near], columns, axis=1).mean(axis=0)
    # Over half a pixel to both sides, so that noise does not steepen the slope.
    wide = int(0.5 / STEP_PX)
    slope = float((step[2 * wide :] - step[: -2 * wide]).max()) / (2 * wide * STEP_PX)
    variance = 1 / (2 * math.pi * max(slope, 1e-3) ** 2) - 4 * wide**2 * STEP_PX**2 / 12
    variance -= BOX_VARIANCE_PX2 + INTERPOLATION_VARIANCE_PX2
    return float(np.clip(math.sqrt(max(variance, 0.0)), *BLUR_RANGE_PX))


def unexplained_border_px(tracked: TrackedFrame, proxy: Proxy, sun: Sun) -> float:
    """Standard deviation (px) by which the real shadow's border is softer than lens and sun make it; 0 if by none.

    A camera's sharpening makes the marker's strong edges steeper than the weak ones of shadows, its denoising makes
    those softer, and a sun of unknown size counts as a bare one.
    """
    assert tracked.marker is not None
    T = tracked.marker.T_cam_marker
    body = proxy.points_marker()
    hull = shadow_hull(body, sun)
    points = np.column_stack([hull, np.zeros(len(hull))])
    if len(points) < 3 or (points @ T[2, :3] + T[2, 3]).min() <= 1e-3:
        return 0.0
    grey = np.asarray(cv2.cvtColor(tracked.frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
    corners = tracked.marker.corners_px
    border = edge_blur_px(grey, project(tracked.camera, T, points))
    # A disc's standard deviation is half its radius; heights are spread evenly along the border, the root of whose mean
    # square is 1 / sqrt(3) of the whole.
    sine = max(float(sun.to_light[2]), LEAST_SINE)
    penumbra_m = sun.tan_half_size * float(body[:, 2].max()) / math.sqrt(3) / sine / 2
    penumbra = penumbra_m * mean_side_px(corners) / tracked.marker.side_m
    # The shadow maps' own texels blur about as much as a pixel does.
    rest = border**2 - edge_blur_px(grey, corners) ** 2 - penumbra**2 - BOX_VARIANCE_PX2
    return min(math.sqrt(max(rest, 0.0)), MOST_BORDER_PX * tracked.frame.size[0] / 640)


def noise_sigma(grey: Image) -> float:
    """Standard deviation of the noise of (h, w) uint8, whatever is in the picture as long as half of it is smooth.

    Immerkaer, "Fast noise variance estimation", CVIU 1996, with the median in the place of the mean.
    """
    kernel = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
    response = cv2.filter2D(grey, cv2.CV_32F, kernel)[1:-1, 1:-1]
    return float(np.median(np.abs(response))) / (0.6745 * 6) if response.size else 0.0


def has_coarse_chroma(image_bgr: Image) -> bool:
    """Whether (h, w, 3) uint8 has its colours at half the resolution in each row, as 4:2:0 and 4:2:2 encodings do.

    Neighbours then differ much less than pixels that are two apart, of whatever content: by half of the variance where
    values are repeated, less where they are interpolated, while those of independent noise differ alike.
    """
    colours = cv2.cvtColor(image_bgr, cv2.COLOR_BGR2YCrCb)[..., 1:].astype(np.float32)
    if colours.shape[1] < 3:
        return False
    beside, beyond = (float(np.square(colours[:, step:] - colours[:, :-step]).mean()) for step in (1, 2))
    return beyond > LEAST_CHROMA_DETAIL and beside < COARSE_CHROMA * beyond


def _level(lighting: Lighting | None, real_object: Proxy | None, ground: Float) -> Float:
    """(n, 3) the light at places (n, 2) of the plane if a shadow covers all of them; else as if there were no shadow.

    Where light and shadow meet, the picture tells them apart better than an estimated light does.
    """
    if lighting is None:
        return np.ones((len(ground), 3))
    level = lighting.level_at(ground)
    if real_object is not None:
        for sun in lighting.suns:
            if not np.nan_to_num(lit_past(real_object, sun, ground), nan=1.0).any():
                level = level - np.outer(sun.ground_falloff(ground), sun.ground_share)
    return np.maximum(level, LEAST_LEVEL)


def _linear_at(tracked: TrackedFrame, ground: Float, level: Callable[[Float], Float]) -> Float:
    """(m, 3) linear RGB of those places (n, 2) of the print in view, over the light's `level` (n, 3) there."""
    pixels = _pixels(tracked, ground)
    if not np.isfinite(pixels).all():
        return np.zeros((0, 3))
    column, row = np.round(pixels).T
    width, height = tracked.frame.size
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    bgr = tracked.frame.image_bgr[row[seen].astype(int), column[seen].astype(int)]
    return np.asarray(LINEAR_FROM_SRGB_8BIT[bgr[:, ::-1]] / level(ground)[seen])


def _pixels(tracked: TrackedFrame, places: Float) -> Float:
    """(n, 2) pixels of places (n, 2) of the marker's upright print; NaN where any lies behind the camera.

    A body's is the one on its top.
    """
    assert tracked.marker is not None
    camera, T, body = tracked.camera, tracked.marker.T_cam_marker, tracked.marker.body
    height = 0.0 if body is None else tracked.marker.side_m
    points = np.column_stack([places, np.full(len(places), height)])
    if (points @ T[2, :3] + T[2, 3]).min() <= 0:
        return np.full((len(places), 2), np.nan)
    pixels = cv2.projectPoints(points, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)[0]
    return np.asarray(pixels.reshape(-1, 2), dtype=np.float64)


def _print_side_m(tracked: TrackedFrame) -> float:
    """Of the black square."""
    assert tracked.marker is not None
    return tracked.marker.side_m * (1.0 if tracked.marker.body is None else BODY_PRINT_SHARE)


def _window(grey: Image, centre: Float) -> Image:
    """The part around `centre` that stands for the whole; all of a small picture."""
    half = NOISE_WINDOW_PX // 2
    column, row = (
        int(np.clip(at, half, max(half, limit - half))) for at, limit in zip(centre, grey.shape[1::-1], strict=True)
    )
    return grey[max(0, row - half) : row + half, max(0, column - half) : column + half]
