"""The marker's plane in several views: for every pixel of one, how far the others confirm that it lies on the plane.

What lies there (ground, paint, shadows) is seen by every camera where the plane's homography takes it (Hartley and
Zisserman, "Multiple View Geometry", 13.1); what stands on it shears away (plane plus parallax). Plain areas agree
wherever they are, so agreement is rated against what the pixel's neighbourhood would show instead (docs/maths, "The
plane").
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.transforms import camera_centre, project
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.lit_ground import with_on_plane
from ashe_live.light.pixels.areas import shrunk, smoothed
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View, plane_homography

# Standard deviation of an 8-bit sRGB value: sensor noise and JPEG, after the smoothing of the colours.
NOISE_SRGB = 1.5 / 255
MISPLACED_PX = 0.5  # standard deviation of a pixel's place in another view: pose, lens, and differences in sharpness
LEAST_NOISE = 0.02  # of log-opponent colours: differences in sharpness and tone between two pictures
# Prior probabilities that another view shows something else at a point of the plane: an object before it, or a glint.
HIDDEN, GLINT = 0.1, 0.01
MOST_SHEARED = 0.9  # share of an object that shears at most: its foot does not
SPREAD_OF_ANYTHING = np.array([0.6, 0.3, 0.3], np.float32)  # standard deviations of the colours of anything else
# Where neighbours are compared, as multiples of the shear of a point TALL; the difference, in standard deviations, up
# to which they match; and the most that is put down to accident.
SHEARS, MATCH, MOST_BY_ACCIDENT = (0.4, 1.0, -0.4, -1.0), 2.0, 0.98
TALL = 0.5  # height, in sides of the marker, of the points whose shear counts as that of an object
MOST_SHEAR_PX = 40.0  # farther away, pixels do not count as neighbours
SEEN_SHARE = 0.02  # least fraction of the frame that both views must see of the plane
# Correlation between comparisons, which have the pixels of the reference view in common.
CORRELATION = 0.5
# The smooth difference of two pictures is found at a fraction of their size. FLATNESS is the ridge on its slopes, a
# share of the pixels. Gloss moves with the eye: what remains of it is taken out over a share of the frame's width.
REDUCED, EXPOSURE_ROUNDS, EXPOSURE_SCALE, FLATNESS = 4, 4, 0.08, 0.02
GLOSS_SHARE, GLOSS_SCALE, LEAST_WEIGHT = 1 / 16, 0.15, 0.05

# Number of views that the plane is compared with, for the first view and for another: more add hardly any evidence.
COMPARED_WITH_FIRST, COMPARED_WITH_ANOTHER = 4, 1


@dataclass(frozen=True, slots=True, eq=False)
class OnPlane:
    """What one other view shows on the plane, brought to the place and exposure of the reference view."""

    colours: Float32  # (h, w, 3) log-opponent
    seen: Mask  # (h, w) where the other view shows the plane
    residual: Float32  # (h, w, 3) the reference's colours less these
    variance: Float32  # (h, w, 3) expected of the residual where both show the same point of the plane
    shear_px: Float  # (2,) in the reference view, of a point TALL above the marker's centre


def with_plane(views: Sequence[SceneView]) -> list[SceneView]:
    """The views with the others' evidence on which of their pixels lie on the plane."""
    found, colours = [], [log_opponent(view.coarse.image_bgr) for view in views]
    for number, view in enumerate(views):
        others = [i for i in range(len(views)) if i != number]
        others = others[: COMPARED_WITH_ANOTHER if number else COMPARED_WITH_FIRST]
        seen = [on_plane(view.coarse, colours[number], views[i].coarse, colours[i]) for i in others]
        ratio = log_likelihood_ratio([each for each in seen if each is not None], view.coarse.is_ground.shape)
        found.append(replace(view, ground=with_on_plane(view.ground, ratio)))
    return found


def without_plane(view: SceneView) -> SceneView:
    """The view without the others' evidence on which of its pixels lie on the plane."""
    return replace(view, ground=replace(view.ground, on_plane=None))


def where_in(mask: Mask, of: View, to: View) -> Mask:
    """(h, w) of `to`: the pixels whose points of the marker's plane the other view has in its `mask` (h, w)."""
    H = plane_homography(to, of)
    flags = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    found = cv2.warpPerspective(mask.astype(np.uint8), H, to.size, flags=flags) > 0
    # Pixels whose rays meet the plane behind the other camera are mapped with a negative third coordinate.
    width, height = to.size
    depth = H[2, 0] * np.arange(width) + (H[2, 1] * np.arange(height) + H[2, 2])[:, None]
    return np.asarray(found & (depth * np.sign(H[2] @ _marker_px(to)) > 0))


def on_plane(reference: View, colours: Float32, other: View, other_colours: Float32) -> OnPlane | None:
    """What `other` shows on the plane, at the pixels of `reference`; None where both see too little of the plane.

    colours, other_colours: (h, w, 3) log-opponent, of each view.
    """
    H = plane_homography(reference, other)
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    theirs = np.asarray(cv2.warpPerspective(other_colours, H, reference.size, flags=flags), dtype=np.float32)
    seen = reference.is_ground & where_in(shrunk(other.is_ground, 1), other, reference)
    if np.count_nonzero(seen) < SEEN_SHARE * seen.size:
        return None
    residual = colours - theirs
    exposure = _exposure(residual, seen)
    if exposure is None:
        return None
    theirs, residual = theirs + exposure, residual - exposure
    variance = _variance(colours, theirs)
    # Noise as strong as on what agrees, at least as expected: half of a normal variable's squares are below 0.455.
    excess = np.median((residual**2 / variance)[seen], axis=0) / 0.455
    variance *= np.maximum(excess, 1).astype(np.float32)
    return OnPlane(theirs, seen, residual, variance, _shear_px(reference, other))


def log_likelihood_ratio(several: Sequence[OnPlane], shape: tuple[int, ...]) -> Float32:
    """(h, w) log odds, by the views, that a pixel lies on the plane rather than above it; 0 without evidence.

    A view that shows something else at a point of the plane counts against it only so far, as an object before it may
    be the cause.
    """
    total, count = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    for one in several:
        total += _log_odds(one)
        count += one.seen
    return smoothed(total / (1 + np.float32(CORRELATION) * np.maximum(count - 1, 0)))


def _log_odds(one: OnPlane) -> Float32:
    """(h, w) log odds by one view: that it shows the same point of the plane, or something else of the neighbourhood.

    Of what stands on the plane, points whose shear is below a pixel show the same as if they lay on it; and the same
    share of the plane, HIDDEN of it at most, disappears behind what stands on it in the other view. A sheared point
    shows the same by accident with the probability that its neighbours along the shear do.
    """
    shear_px = float(np.linalg.norm(one.shear_px))
    sheared = min(max(1 - 1 / max(shear_px, 1e-6), 0.0), MOST_SHEARED)
    if sheared == 0:
        return np.zeros(one.seen.shape, np.float32)
    hidden = HIDDEN * sheared + GLINT
    # Channels come first: sums over them are then several times faster.
    variance, residual, theirs = (
        np.ascontiguousarray(np.moveaxis(each, 2, 0)) for each in (one.variance, one.residual, one.colours)
    )
    scale = 1 / np.sqrt(variance)
    theirs *= scale
    ours = np.asarray(theirs + residual * scale, dtype=np.float32)
    by_accident = np.minimum(_alike_along_shear(ours, theirs, one.seen, one.shear_px), np.float32(MOST_BY_ACCIDENT))
    same = 1 - sheared * (1 - by_accident)
    else_ = sheared * (1 - by_accident)
    anything = variance + (SPREAD_OF_ANYTHING**2)[:, None, None]
    exponent = (residual**2 * (1 / anything - 1 / variance)).sum(axis=0) + np.log((anything / variance).prod(axis=0))
    odds = np.exp(np.clip(0.5 * exponent, -20, 20))
    ratio = np.log(((1 - hidden) * odds + hidden) / (same * odds + else_))
    return np.where(one.seen, ratio, 0).astype(np.float32)


def _alike_along_shear(ours: Float32, theirs: Float32, seen: Mask, shear_px: Float) -> Float32:
    """(h, w) similarity of each pixel to those of the other view at SHEARS times the shear: 0 to 1, the mean of these.

    ours, theirs: (3, h, w) colours in standard deviations. Only neighbours on what both views show, `seen` (h, w),
    count; where there are none, it is 1.
    """
    height, width = seen.shape
    alike, count = np.zeros(seen.shape, np.float32), np.zeros(seen.shape, np.float32)
    for share in SHEARS:
        across, down = np.round(share * shear_px).astype(int)
        (rows, rows_there), (columns, columns_there) = _overlap(height, down), _overlap(width, across)
        here, there = np.s_[rows, columns], np.s_[rows_there, columns_there]
        away = ((ours[:, *here] - theirs[:, *there]) ** 2).sum(axis=0)
        alike[here] += np.exp(away * np.float32(-0.5 / MATCH**2)) * seen[there]
        count[here] += seen[there]
    return np.divide(alike, count, out=np.ones_like(alike), where=count > 0)


def _overlap(length: int, offset: int) -> tuple[slice, slice]:
    """The places along an axis whose neighbours at an offset are on it, too; and the places of these neighbours."""
    low = min(max(-offset, 0), length)
    high = max(length - max(offset, 0), low)
    return slice(low, high), slice(low + offset, high + offset)


def _exposure(residual: Float32, seen: Mask) -> Float32 | None:
    """(h, w, 3) the smooth difference of two pictures of the plane: exposure, white balance, vignetting, gloss.

    A robust quadratic in the image's coordinates, then what remains, by a normalised convolution with robust weights.
    None where only strips are `seen` that are too narrow for the reduced picture.
    """
    height, width = seen.shape
    small = max(1, width // REDUCED), max(1, height // REDUCED)
    values = cv2.resize(residual, small, interpolation=cv2.INTER_NEAREST)
    inside = cv2.resize(seen.astype(np.float32), small, interpolation=cv2.INTER_NEAREST)
    v, u = np.meshgrid(np.linspace(-1, 1, small[1]), np.linspace(-1, 1, small[0]), indexing="ij")
    bases = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=2).reshape(-1, 6)
    flat, shown = values.reshape(-1, 3).astype(np.float64), inside.ravel() > 0
    if not shown.any():
        return None
    field = np.zeros((6, 3))
    field[0] = np.median(flat[shown], axis=0)
    prior = np.diag([0.0, 1, 1, 1, 1, 1]) * FLATNESS * np.count_nonzero(shown)
    for _ in range(EXPOSURE_ROUNDS):
        away = ((flat - bases @ field) ** 2).sum(axis=1)
        weighted = bases * (shown / (1 + away / EXPOSURE_SCALE**2))[:, None]
        field = np.linalg.solve(weighted.T @ bases + prior, weighted.T @ flat)
    slow = (bases @ field).reshape(values.shape).astype(np.float32)
    smooth = np.zeros_like(values)
    for _ in range(EXPOSURE_ROUNDS):
        remains = ((values - slow - smooth) ** 2).sum(axis=2)
        weight = (inside / (1 + remains / GLOSS_SCALE**2) ** 2)[..., None]
        both = np.concatenate([(values - slow) * weight, weight], axis=2)
        sums = cv2.GaussianBlur(both, (0, 0), GLOSS_SHARE * small[0])
        smooth = sums[..., :3] / (sums[..., 3:] + LEAST_WEIGHT)
    return np.asarray(cv2.resize(slow + smooth, (width, height), interpolation=cv2.INTER_LINEAR), dtype=np.float32)


def _variance(ours: Float32, theirs: Float32) -> Float32:
    """(h, w, 3) expected of the difference of two pictures of the same point: noise, and misplacement at edges."""
    # For log light, an sRGB value v has the slope 2.2 / v, and brightness l is about 2.2 ln v.
    value = np.exp(np.minimum(ours[..., :1], 0) / 2.2)
    noise = 2 * (2.2 * NOISE_SRGB / np.maximum(value, 0.03)) ** 2 + LEAST_NOISE**2
    slope = _slope_squared(ours) + _slope_squared(theirs)
    return np.asarray(noise + 0.5 * MISPLACED_PX**2 * slope, dtype=np.float32)


def _slope_squared(picture: Float32) -> Float32:
    """(h, w, 3) squared gradient per pixel."""
    across, down = (cv2.Sobel(picture, cv2.CV_32F, *order, ksize=3, scale=1 / 8) for order in ((1, 0), (0, 1)))
    return np.asarray(across**2 + down**2, dtype=np.float32)


def _shear_px(reference: View, other: View) -> Float:
    """(2,) pixels in the reference view from a point TALL above the marker to where `other` sees it on the plane."""
    height = TALL * reference.side_m
    eye = camera_centre(other.T_cam_marker)
    point = np.array([0.0, 0.0, height])
    if eye[2] <= height:
        return np.zeros(2)
    behind = np.append((eye + (point - eye) * eye[2] / (eye[2] - height))[:2], 0.0)
    seen, cast = project(reference.camera, reference.T_cam_marker, np.array([point, behind]))
    shear = cast - seen
    # A point that one of the cameras cannot see has no image.
    return np.clip(shear, -MOST_SHEAR_PX, MOST_SHEAR_PX) if np.isfinite(shear).all() else np.zeros(2)


def _marker_px(view: View) -> Float:
    """(3,) homogeneous pixel of the marker's centre."""
    centre = view.camera.K @ view.T_cam_marker[:3, 3]
    return np.asarray(centre / centre[2])
