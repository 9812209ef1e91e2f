"""The glint: the mirror image of a light in glossy ground, which shows the light's direction without any shadow.

A polished table or a glazed tile reflects a sun or a lamp where the plane, as a mirror, turns the ray from the camera
towards it. Its surface blurs the image, so that a glint is brighter than any lit ground and fades on all sides, whereas
objects and prints have edges.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.ground.lit_ground import LitGround, as_taken
from ashe_live.light.ground.sheen import slope_of
from ashe_live.light.pixels.areas import areas_by_size, grown, shrunk
from ashe_live.light.pixels.view import View

# Log brightness above the ground's brightest common colour, of a glint's peak and of its halo, at least; and how much
# darker than the peak its core may be.
LEAST_PEAK, HALO, CORE = 0.7, 0.1, 0.25
COMMON = 0.02  # least weight of a colour of the palette that counts
BLUR_PX = 2.0  # of the search for the peak: a speck is none
LEAST_PX = 25  # of its core, and of its halo: smaller ones are specks
# Fall of log brightness per pixel, as a fraction of the peak's height, at most of the points half-way down it.
# An edge falls by 0.2 and more; glints in generated pictures (which are wider) by 0.03 to 0.1.
STEEPEST, MOST = 0.12, 80
SLOPE_BLUR_PX = 1.0  # of brightness, before its slope is taken


@dataclass(frozen=True, slots=True, eq=False)
class Glint:
    """A light's mirror image in the ground."""

    halo: Mask  # (h, w) of the view: ground that is brightened by it
    to_light_marker: Float  # (3,) unit, marker frame, as seen from the ground there
    place_marker: Float  # (2,) metres, where on the plane that is


def glint_in(view: View, ground: LitGround) -> Glint | None:
    """The glint in `view`, which `ground` was fitted to; None if there is none."""
    view, ground = as_taken(view, ground)
    brightness = ground.colours[..., 0] - _brightest(ground)
    smooth = np.where(view.is_ground, cv2.GaussianBlur(brightness, (0, 0), BLUR_PX), -math.inf)
    peak = float(smooth.max())
    if not peak > LEAST_PEAK:
        return None
    cores = areas_by_size(smooth > peak - CORE, LEAST_PX)
    if not cores:
        return None
    (halo,) = (area for area in areas_by_size(smooth > HALO, LEAST_PX) if area[cores[0]].any())
    upper = halo & (smooth > peak / 2)
    half_way = grown(upper, 1) & ~shrunk(upper, 1) & view.is_ground
    slope = slope_of(np.asarray(cv2.GaussianBlur(brightness, (0, 0), SLOPE_BLUR_PX), dtype=np.float32))
    if float(np.percentile(slope[half_way], MOST)) > STEEPEST * peak:
        return None
    rows, columns = np.nonzero(cores[0])
    return Glint(halo, *_mirrored(view, columns.mean(), rows.mean()))


def _brightest(ground: LitGround) -> float:
    """The log brightness of the brightest common colour of the lit ground."""
    is_common = ground.palette.weights >= min(COMMON, float(ground.palette.weights.max()))
    return float(ground.palette.centres[is_common, 0].max())


def _mirrored(view: View, x_px: float, y_px: float) -> tuple[Float, Float]:
    """(3,) the ray through a pixel as the ground's plane reflects it, unit, marker frame; (2,) where it does so."""
    turned = view.T_cam_marker[:3, :3].T
    ray = turned @ np.linalg.solve(view.camera.K, np.array([x_px, y_px, 1.0]))
    eye = -turned @ view.T_cam_marker[:3, 3]
    return np.asarray(ray * (1, 1, -1) / np.linalg.norm(ray)), np.asarray(eye[:2] - ray[:2] * eye[2] / ray[2])
