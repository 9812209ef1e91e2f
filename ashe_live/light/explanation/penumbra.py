"""The light's angular size from its penumbra: a shadow's edge widens with the height of the point that casts it."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Float32, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import along_sides
from ashe_live.core.transforms import undistorted
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.light.edges.shadow_edge import EdgePoints, edge_points
from ashe_live.light.explanation.border_widths import border_widths
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.predicted import Predicted

REACH_PX = 11.0  # on either side of the edge
STEP_PX = 0.5  # between samples of a profile
END_SAMPLES = 6  # at each end of a profile, whose medians are the levels inside and outside
LEAST_DEPTH = 0.6  # least step between these two levels, as a fraction of the shift, in an edge worth measuring
BESIDE_OBJECT_PX = 2  # where edges are not looked for
FEWEST_EDGES = 12  # places with a clear step, for a regression
# The penumbra's variance at the widest edges, over that of the picture's blur, below which the two cannot be separated.
LEAST_VARIANCE_RATIO = 0.5
LEAST_BLUR_PX2 = 0.25  # no picture is sharper
LEAST_SIGMAS = 3.0  # standard errors by which the squared diameter must differ from 0
EDGES_PER_SAMPLE = 6.0  # neighbouring places on an edge are correlated: their number over the effective sample size
# What the edges tell of the diameter, over what they would tell if the blur were known: less is rounding, as where all
# of them are cast from one height and are seen from straight above.
LEAST_INFORMATION = 1e-9
LARGEST_RAD = math.radians(20)  # of a diameter that is stated
ROBUST_ROUNDS, CAUCHY_SIGMAS = 6, 2.0  # of the regression; and the scale of Cauchy's loss in standard deviations
# Of `soft_size`, which measures widths of borders in the whole picture.
DISC_SIGMAS = 2.75  # the width of a disc's penumbra from 10 to 90 %, over its standard deviation
FINE_WIDTH_PX = 480.0  # the picture's width for which the reaches in border_widths.py are stated
LEAST_SPREAD_PX = 4.0  # standard deviation for a light of 1 rad; near the foot it is less, and 5 degrees hardly show
FEWEST_PLACES = 24  # with a border that is wide enough there
MARKER_PLACES = np.linspace(0.15, 0.85, 16)  # of profiles across the marker's sides, as fractions of these
MARKER_REACH = 0.5  # factor on the reach of these profiles, which end on the margin and in the black frame
LEAST_SOFT_RAD = math.radians(2.5)  # cameras' processing widens a bare sun's borders to those of up to 2 degrees
MOST_SPREAD_OUT = 2.2  # third quartile of the sizes at all places over the first


def size_of(explanation: Explanation, light: Light, tracked: TrackedFrame) -> float | None:
    """The angular diameter (rad) of an explanation's only light; None where it cannot be measured."""
    soft = soft_size(explanation.proxy, light.homogeneous, tracked)
    if soft is not None:
        return soft
    lost, seen = explanation.materials.light_lost, explanation.predicted
    return angular_size(explanation.proxy, light.homogeneous, lost, seen, explanation.region.view)


def soft_size(proxy: Proxy, light: Float, tracked: TrackedFrame) -> float | None:
    """The angular diameter (rad) of a light that is clearly softer than a bare sun; None for all others.

    By the widths of the shadow's border in the whole picture, as the estimator's own region is too coarse for them.
    Widths of penumbra and blur add up in squares; the blur's is that of the edges of the marker's black square.
    """
    picture, camera, corners_px = _without_distortion(tracked.frame.image_bgr, tracked.camera, tracked.pose)
    scale = max(1.0, tracked.frame.size[0] / FINE_WIDTH_PX)
    sides, normals = along_sides(corners_px, MARKER_PLACES)
    normals = np.repeat(normals, len(MARKER_PLACES), axis=0)
    blur = border_widths(picture, sides.reshape(-1, 2), normals, MARKER_REACH * scale)
    edge = edge_points(proxy, light, camera, tracked.pose.T_cam_marker, tracked.pose.side_m)
    if not np.isfinite(blur).any() or edge is None:
        return None
    widths = border_widths(picture, edge.points_px, edge.normals_px, scale)
    is_measured = np.isfinite(widths) & (edge.spreads_px > LEAST_SPREAD_PX)
    if is_measured.sum() < FEWEST_PLACES:
        return None
    added = np.sqrt(np.maximum(widths[is_measured] ** 2 - np.nanmedian(blur) ** 2, 0))
    low, size, high = np.percentile(added / (DISC_SIGMAS * edge.spreads_px[is_measured]), (25, 50, 75))
    return float(size) if LEAST_SOFT_RAD < size < LARGEST_RAD and high < MOST_SPREAD_OUT * low else None


def _without_distortion(picture: Image, camera: Camera, marker: MarkerPose) -> tuple[Image, Camera, Float]:
    """The picture (h, w, 3), its camera, and the marker's corners (4, 2) in it, as a pinhole camera has them."""
    if not camera.is_distorted:
        return picture, camera, marker.corners_px
    straight = cv2.undistort(np.asarray(picture), camera.K, camera.dist)
    return np.asarray(straight, np.uint8), camera.without_distortion(), undistorted(camera, marker.corners_px)


def angular_size(proxy: Proxy, light: Float, light_lost: Float32, masks: Predicted, view: View) -> float | None:
    """The light's angular diameter (rad); None where its penumbra cannot be separated from the picture's own blur.

    light: (4,) homogeneous point, marker frame; the diameter of a lamp is that seen from the marker's centre.
    light_lost: (h, w) share of the light that the shadow takes which each pixel of `view` lacks. A disc of diameter d
    blurs the edge cast from height z with the standard deviation z |J'n| d / 4 across the edge (n its normal on the
    ground, J the derivative of the displacement s by the direction); the picture's blur adds a constant variance
    (docs/maths, "Penumbra").
    """
    edge = edge_points(proxy, light, view.camera, view.T_cam_marker, view.side_m)
    if edge is None:
        return None
    clear = view.is_ground & ~grown(masks.body, BESIDE_OBJECT_PX)
    kept, variances = _variances(light_lost, clear, edge)
    spreads = edge.spreads_px[kept]
    if len(spreads) < FEWEST_EDGES:
        return None
    line = _widening(spreads, variances)
    if line is None or line.squared <= LEAST_SIGMAS * line.error:
        return None
    if line.squared * np.percentile(spreads, 90) ** 2 < LEAST_VARIANCE_RATIO * max(line.blur, LEAST_BLUR_PX2):
        return None
    size = math.sqrt(line.squared)
    return size if size < LARGEST_RAD else None


@dataclass(frozen=True, slots=True)
class _Widening:
    """How the variance of a shadow's edge grows with the squared spread of a light of 1 rad: along a line."""

    blur: float  # px^2, where no light has a size: the variance of the picture's own blur
    squared: float  # rad^2, the slope: the light's squared diameter
    error: float  # rad^2, standard error of that


def _widening(spreads: Float, variances: Float) -> _Widening | None:
    """The line through variances (n,) over squared spreads (n,), px^2, by reweighted least squares with Cauchy's loss.

    None where the spreads are too much alike for a slope.
    """
    design = np.column_stack([np.ones(len(spreads)), spreads**2])
    weights = np.ones(len(spreads))
    blur, squared, scale = 0.0, 0.0, 1.0
    for _ in range(ROBUST_ROUNDS):
        (blur, squared), *_ = np.linalg.lstsq(design * weights[:, None], variances * weights, rcond=None)
        rest = variances - design @ np.array([blur, squared])
        scale = SIGMA_OVER_MAD * float(np.median(np.abs(rest))) + 1e-3
        weights = 1 / np.sqrt(1 + (rest / (CAUCHY_SIGMAS * scale)) ** 2)
    (of_blur, mixed), (_, of_squared) = (design * weights[:, None]).T @ (design * weights[:, None])
    information = of_squared - mixed**2 / of_blur  # on the squared diameter, whatever the blur
    if information < LEAST_INFORMATION * of_squared:
        return None
    return _Widening(float(blur), float(squared), scale * math.sqrt(EDGES_PER_SAMPLE / information))


def _variances(light_lost: Float32, clear: Mask, edge: EdgePoints) -> tuple[Mask, Float]:
    """(n,) the points with a clear step from shadow to light along their normals; (k,) the variances there, px^2."""
    height, width = light_lost.shape
    offsets = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
    lines = edge.points_px[:, None] + offsets[:, None] * edge.normals_px[:, None]
    column, row = np.moveaxis(np.rint(np.clip(lines, -1e6, 1e6)).astype(int), 2, 0)
    inside = (column >= 1) & (row >= 1) & (column <= width - 2) & (row <= height - 2)
    kept = (inside & clear[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)]).all(axis=1)
    if not kept.any():
        return kept, np.empty(0)
    x, y = np.moveaxis(lines[kept].astype(np.float32), 2, 0)
    profiles = cv2.remap(light_lost, x, y, cv2.INTER_LINEAR)
    dark, lit = (np.median(end, axis=1) for end in (profiles[:, :END_SAMPLES], profiles[:, -END_SAMPLES:]))
    deep = dark - lit >= LEAST_DEPTH
    kept[kept] = deep
    falling = np.clip((profiles[deep] - lit[deep, None]) / (dark - lit)[deep, None], 0, 1)
    lost = np.maximum(-np.diff(falling, axis=1), 0.0)
    lost /= np.maximum(lost.sum(axis=1, keepdims=True), 1e-9)
    middles = 0.5 * (offsets[1:] + offsets[:-1])
    return kept, (lost * (middles - (lost @ middles)[:, None]) ** 2).sum(axis=1)
