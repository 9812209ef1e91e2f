"""Measures how much less relief the ground shows in the real object's shadow than in the light.

A sun makes bumps and grain bright on one side and dark on the other; the sky alone hardly does. Print and stains keep
their contrast.
"""

from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.camera.shadow_border import OUTLINE_ERROR
from ashe_live.render.lights.cast_shadows import cast_by_point
from ashe_live.render.lights.lighting import Lighting

MEANS_ACROSS = 80  # local means across a picture, as `render/compositing/ground_means.py` draws them
FLOOR = 0.01  # share of the mean that is added to brightness before its logarithm is taken, as noise may be near 0
DARKEST = 1e-5  # least value added
AROUND = 0.1  # the shadow is compared with lit ground within this distance of it, over the picture's width
SHEET = 2.0  # assumed side of the marker's sheet, over that of its square
LEAST_SHARE = 0.001  # least share of the picture over which contrast is measured
SPLINE = np.array([1.0, 4.0, 1.0]) / 6  # of a cubic B-spline, at the middles of the squares that it weights
SKY_SHARES = 0.01, 0.99  # limits of the sky's share: (2a) of docs/rendering/shadows.md has no value at 0 and 1
MOST_SIGMAS = 3.0  # deviations beyond this multiple of the contrast in the light are paint, not relief


class Relief(NamedTuple):
    """The ground's relief, in deviations of the logarithm of its brightness from the local mean."""

    contrast: float  # in the real shadow over that in the light, at most 1
    most: float  # largest deviation in the light that is relief
    sky_share: float  # of the light on lit ground, by luminance, which is what the shadow has


def relief_of(tracked: TrackedFrame, proxy: Proxy, lighting: Lighting) -> Relief | None:
    """None if too little of the first light's shadow is seen, if there is none, or if the ground in it is not flatter.

    Contrasts are medians, as marks are rare. They include the picture's noise, as the ground that is drawn does.
    """
    regions = _regions(tracked, proxy, lighting)
    if regions is None:
        return None
    brightness = LINEAR_FROM_SRGB_8BIT[regions.image_bgr] @ REC709_LUMINANCE[::-1]
    sky_share = float(np.array(lighting.sky) @ REC709_LUMINANCE)
    most_left = 0.5 * (1 + sky_share)  # half of what a shadow takes must be gone, or none is there
    if brightness[regions.in_shadow].mean() > most_left * brightness[regions.in_light].mean():
        return None
    square_px = tracked.frame.size[0] / MEANS_ACROSS
    shaded, lit = (_contrast(brightness, where, square_px) for where in (regions.in_shadow, regions.in_light))
    if shaded >= lit:
        return None
    return Relief(shaded / lit, MOST_SIGMAS * lit, float(np.clip(sky_share, *SKY_SHARES)))


class _Regions(NamedTuple):
    """Bare ground in a part of the picture."""

    image_bgr: Image  # (h, w, 3)
    in_shadow: Mask  # (h, w)
    in_light: Mask  # (h, w) around the shadow


def _regions(tracked: TrackedFrame, proxy: Proxy, lighting: Lighting) -> _Regions | None:
    """None where too little of either is seen."""
    size, T_cam_marker = tracked.frame.size, tracked.pose.T_cam_marker
    body = proxy.points_marker()
    cast = cast_by_point(body, lighting.lights[0].homogeneous)
    ground = np.column_stack([cast, np.zeros(len(cast))])
    if min((points @ T_cam_marker[2, :3] + T_cam_marker[2, 3]).min() for points in (ground, body)) <= 1e-3:
        return None
    outline, body_px = (project_distorted(tracked.camera, T_cam_marker, points) for points in (ground, body))
    near, far = round(OUTLINE_ERROR * size[0]), round(AROUND * size[0])
    left, top = np.clip(outline.min(axis=0) - far, 0, size).astype(int)
    right, bottom = np.clip(outline.max(axis=0) + far + 1, 0, size).astype(int)
    image = tracked.frame.image_bgr[top:bottom, left:right]
    if min(image.shape[:2]) <= 2 * near:
        return None
    shadow, other = (_hull(pixels - (left, top), image) for pixels in (outline, body_px))
    other = _grown(other, near)
    if tracked.pose.body is None:
        middle = tracked.pose.corners_px.mean(axis=0)
        other |= _hull(middle + SHEET * (tracked.pose.corners_px - middle) - (left, top), image)
    in_shadow = ~_grown(~shadow, near) & ~other
    in_light = _grown(shadow, far) & ~_grown(shadow, near) & ~other
    seen_px = min(in_shadow.sum(), in_light.sum())
    return _Regions(image, in_shadow, in_light) if seen_px >= LEAST_SHARE * size[0] * size[1] else None


def _contrast(brightness: Float, where: Mask, square_px: float) -> float:
    """Standard deviation of the logarithm about its local mean, which is a cubic B-spline of means over squares.

    Estimated by the median, within the mask `where` (h, w).
    """
    logarithm = np.log(brightness + max(FLOOR * float(brightness[where].mean()), DARKEST))
    sums, counts = (
        _smoothed(values, square_px) for values in (np.where(where, logarithm, 0.0), where.astype(np.float64))
    )
    return SIGMA_OVER_MAD * float(np.median(np.abs(logarithm[where] - sums[where] / counts[where])))


def _smoothed(values: Float, square_px: float) -> Float:
    """(h, w) the B-spline at the middles of its squares, interpolated between them."""
    height, width = values.shape
    squares = max(1, round(width / square_px)), max(1, round(height / square_px))
    means = cv2.resize(values, squares, interpolation=cv2.INTER_AREA)
    at_middles = cv2.sepFilter2D(means, -1, SPLINE, SPLINE, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(cv2.resize(at_middles, (width, height), interpolation=cv2.INTER_LINEAR))


def _hull(pixels: Float, image: Image) -> Mask:
    """(h, w) what the convex hull of pixels (n, 2) covers."""
    mask = np.zeros(image.shape[:2], np.uint8)
    cv2.fillConvexPoly(mask, cv2.convexHull(np.round(pixels).astype(np.int32)), 1)
    return mask.astype(bool)


def _grown(mask: Mask, by_px: int) -> Mask:
    kernel = np.ones((2 * by_px + 1, 2 * by_px + 1), np.uint8)
    return np.asarray(cv2.dilate(mask.astype(np.uint8), kernel, borderValue=0).astype(bool))
