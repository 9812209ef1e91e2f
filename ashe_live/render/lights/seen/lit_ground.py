"""What the ground at the border of a real object's shadow looks like when it is lit, as a picture tells.

Where a model's shadow crosses that border, the video must say how much of the light there is left in a pixel. On ground
with a pattern its brightness alone cannot: what is dark may be in shadow or black. So the ground is made up across the
border, from both of its sides: what is in shadow is divided by the light's ratio, and a band around the border is
inpainted (Telea 2004). The picture over that is the border's profile in each channel, with the blur of colours and the
sharpening of the camera. Its medians along the border are free of the ground's grain; the picture over these is the
lit ground with its grain. In the middle of a steep border, where a part of a pixel would count, what was inpainted
stays, but for joints and other lines that cross it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE, srgb_from_linear
from ashe_live.core.light import Light
from ashe_live.core.types import TrackedFrame
from ashe_live.render.lights.cast_shadows import cast_by_point, shadow_hull_of_point
from ashe_live.render.lights.lighting import angular_size
from ashe_live.render.lights.seen.plane import PlaneInPicture

LUMINANCE = REC709_LUMINANCE.astype(np.float32)
MOST_TEXELS = 640  # a side of the rectified plane
MARGIN = 0.25  # around the body's shadow, over the root of its area
BORDER_PX = 3.0  # to either side of the border, beside its penumbra: blur of lens and colours, and the border's error
WIDEST = 0.15  # of that with the penumbra, over the root of the area of the body's shadow
LEAST_PX, LEAST_SINE = 0.25, 0.2  # of a texel, and of the light's elevation, by which is divided
HULL_PARTS = 8  # in which an edge of the body's shadow is divided
OBJECT_TEXELS = 4  # around what is hidden, where the object would be inpainted onto the ground
INPAINTING_TEXELS = 4  # radius within which what is known counts
HEADROOM = 0.8  # of the encoded light that is inpainted, as ground in shadow may be brighter than white when it is lit
ALONG_TEXELS = 5  # to either side along the border, of the median
SMOOTHED = 1.0, 2.5  # of the profile before its direction is taken, and of its structure tensor; texels
OVERSHOOT = 0.6, 1.6  # a border is no darker than the shadow, and no brighter than lit ground, by more (ground.frag)
STEEP = 0.4, 0.9  # differences of neighbours over their brightness, from which on inpainted ground counts, and alone
LINES = 0.3, 0.5  # logarithms of grained over inpainted ground, from which on there may be a line, and is
FADING_TEXELS = 0.7
LEAST_RATIO = 0.02
DARKEST, MOST_LIGHT = 1e-4, 60.0


@dataclass(frozen=True, slots=True, eq=False)
class LitGround:
    """A part of the marker's plane in which ground at a shadow's border is known."""

    bounds: Float  # (4,) lower x, y and upper x, y, metres
    ratio: Float  # (3,) linear RGB, of ground in the shadow over lit ground
    rgba: NDArray[np.float16]  # (h, w, 4) rows by y: linear RGB of the lit ground, and how far it is known


def lit_ground(
    points: Float, seen_in: TrackedFrame, light: Light, ratio: Float, coarse: PlaneInPicture, is_dark: Mask
) -> LitGround | None:
    """At the border of the shadow of a body of points (n, 3). None where none of it is seen.

    ratio: (3,) of ground in the shadow over lit ground. is_dark: (h, w) where the shadow lies in the plane `coarse`.
    """
    hull = shadow_hull_of_point(points, light.homogeneous)
    plane = PlaneInPicture.around(seen_in, hull, MARGIN, MOST_TEXELS)
    if plane is None:
        return None
    dark = plane.from_other(coarse, is_dark)
    from_border = _signed_distance(dark)
    width = np.minimum(_half_widths(plane, from_border, points, hull, light), WIDEST * plane.size)
    around = np.abs(from_border) < width
    hidden = plane.hidden(seen_in, points)
    band = around & ~_grown(hidden, OBJECT_TEXELS)
    if not band.any():
        return None
    ratio = np.clip(ratio, LEAST_RATIO, 1.0).astype(np.float32)
    seen = np.maximum(plane.linear_rgb, DARKEST)
    filled = _filled(np.where(dark[..., None], seen / ratio, seen), around & _grown(band, 2 * OBJECT_TEXELS))
    profile = _along_border((seen / filled).astype(np.float32), band, hidden)
    profile = np.clip(profile, OVERSHOOT[0] * ratio, OVERSHOOT[1])
    grained = seen / profile
    lines = np.abs(np.log((grained @ LUMINANCE) / (filled @ LUMINANCE)))
    steep = _steepness(profile, band) * np.clip((LINES[1] - lines) / (LINES[1] - LINES[0]), 0, 1)
    lit = grained + steep[..., None] * (filled - grained)
    known = cv2.GaussianBlur(cv2.erode(band.astype(np.float32), np.ones((3, 3))), (0, 0), FADING_TEXELS)
    rgba = np.dstack([np.where(band[..., None], lit, filled), known * band])
    return LitGround(plane.bounds, ratio.astype(np.float64), np.minimum(rgba, MOST_LIGHT).astype(np.float16))


def _signed_distance(mask: Mask) -> NDArray[np.float32]:
    """(h, w) texels from a mask's border, negative within it."""
    inside, outside = (cv2.distanceTransform(each.astype(np.uint8), cv2.DIST_L2, 5) for each in (mask, ~mask))
    return np.asarray(np.where(mask, 0.5 - inside, outside - 0.5), np.float32)


def _half_widths(
    plane: PlaneInPicture, from_border: NDArray[np.float32], points: Float, hull: Float, light: Light
) -> NDArray[np.float32]:
    """(h, w) texels from the border of a shadow over which it is blurred; 0 farther away than that is anywhere.

    That is BORDER_PX in the picture, and the penumbra of the point of the body that casts the border there.
    """
    smooth = cv2.GaussianBlur(from_border, (0, 0), SMOOTHED[0])
    down, across = np.gradient(plane.pixels, axis=(0, 1))
    slope = np.stack([cv2.Sobel(smooth, cv2.CV_32F, *axes) for axes in ((1, 0), (0, 1))], axis=2)
    slope = slope / np.maximum(np.linalg.norm(slope, axis=2), 1e-6)[..., None]
    px = np.linalg.norm(slope[..., :1] * across + slope[..., 1:] * down, axis=2)  # of a texel across the border
    width = np.asarray(BORDER_PX / np.maximum(px, LEAST_PX), np.float32)
    cast = cast_by_point(points, light.homogeneous)
    of_corner = ((hull[:, None] - cast) ** 2).sum(axis=2).argmin(axis=1)
    reach_m = np.linalg.norm(np.column_stack([hull, np.zeros(len(hull))]) - points[of_corner], axis=1)
    penumbra = reach_m * np.tan(angular_size(light) / 2) / max(light.to_light_marker[2], LEAST_SINE) / plane.texel_m
    corners = (hull - plane.bounds[:2]) / plane.texel_m - 0.5
    shares = np.linspace(0, 1, HULL_PARTS, endpoint=False)[:, None, None]
    ends = np.concatenate([corners, penumbra[:, None]], axis=1)
    samples = (ends + shares * (np.roll(ends, -1, axis=0) - ends)).reshape(-1, 3)
    nearest = _of_nearest(samples, width.shape)
    return np.where(np.abs(from_border) < width + penumbra.max(), width + nearest, 0).astype(np.float32)


def _of_nearest(samples: Float, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """(h, w) at each texel the value of the nearest of samples (n, 3): x and y in texels, and a value.

    Samples beyond the map do not count; 0 where none is within it.
    """
    columns, rows = np.rint(samples[:, :2]).astype(int).T
    inside = (columns >= 0) & (columns < shape[1]) & (rows >= 0) & (rows < shape[0])
    if not inside.any():
        return np.zeros(shape, np.float32)
    at = rows[inside], columns[inside]
    elsewhere = np.ones(shape, np.uint8)
    elsewhere[at] = 0
    _, labels = cv2.distanceTransformWithLabels(elsewhere, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    values = np.zeros(int(labels.max()) + 1, np.float32)
    values[labels[at]] = samples[inside, 2]
    return values[labels]


def _filled(linear_rgb: NDArray[np.float32], where: Mask) -> NDArray[np.float32]:
    """(h, w, 3) with the pixels of a mask inpainted."""
    encoded = np.rint(255 * srgb_from_linear(np.clip(HEADROOM * linear_rgb, 0, 1))).astype(np.uint8)
    inpainted = cv2.inpaint(encoded, where.astype(np.uint8), INPAINTING_TEXELS, cv2.INPAINT_TELEA)
    filled = LINEAR_FROM_SRGB_8BIT[inpainted] / HEADROOM
    return np.maximum(np.where(where[..., None], filled, linear_rgb), DARKEST).astype(np.float32)


def _along_border(shares: NDArray[np.float32], band: Mask, hidden: Mask) -> NDArray[np.float32]:
    """(h, w, 3) in a band: medians of `shares` (h, w, 3) along lines that follow the border; these beside it."""
    brightness = np.clip(shares @ LUMINANCE, 0.0, OVERSHOOT[1])
    across, down = _tangents(np.where(hidden, 1.0, brightness).astype(np.float32), hidden)
    rows, columns = (each.astype(np.float32) for each in np.nonzero(band))
    is_seen = np.asarray(~hidden, np.float32)
    samples = []
    for sign in (1, -1):
        x, y, before = columns.copy(), rows.copy(), None
        for step in range(ALONG_TEXELS + 1):
            if step > 0 or sign > 0:
                at = x[None], y[None]
                sample = cv2.remap(shares, *at, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)[0]
                sample[cv2.remap(is_seen, *at, cv2.INTER_LINEAR, borderValue=0)[0] < 0.99] = np.nan
                samples.append(sample)
            row, column = (
                np.clip(np.rint(each), 0, n - 1).astype(int) for each, n in zip((y, x), band.shape, strict=True)
            )
            along = np.stack([across[row, column], down[row, column]])
            along *= sign if before is None else np.where((along * before).sum(axis=0) < 0, -1, 1)
            x, y, before = x + along[0], y + along[1], along
    found = shares.copy()
    found[band] = np.nanmedian(samples, axis=0)  # what is in the band itself is seen
    return found


def _tangents(values: NDArray[np.float32], hidden: Mask) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(h, w) x and y of unit vectors along the steps of values (h, w), by their structure tensor."""
    smooth = cv2.GaussianBlur(values, (0, 0), SMOOTHED[0])
    x, y = (np.where(hidden, 0, cv2.Sobel(smooth, cv2.CV_32F, *axes)) for axes in ((1, 0), (0, 1)))
    xx, xy, yy = (cv2.GaussianBlur(each, (0, 0), SMOOTHED[1]) for each in (x * x, x * y, y * y))
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    return -np.sin(angle), np.cos(angle)


def _steepness(profile: NDArray[np.float32], band: Mask) -> NDArray[np.float32]:
    """(h, w) from 0 to 1, by how much a border's profile differs between neighbours."""
    brightness, kernel = np.asarray(profile @ LUMINANCE, np.float32), np.ones((3, 3), np.uint8)
    differences = (cv2.dilate(brightness, kernel) - cv2.erode(brightness, kernel)) / brightness
    steep = np.where(band, np.clip((differences - STEEP[0]) / (STEEP[1] - STEEP[0]), 0, 1), 0)
    return np.asarray(cv2.GaussianBlur(steep.astype(np.float32), (0, 0), FADING_TEXELS))


def _grown(mask: Mask, by: int) -> Mask:
    return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((2 * by + 1, 2 * by + 1), np.uint8)) > 0)
