"""Makes up the ground that the marker's sheet hides, from the ground around it in the marker's plane.

The real object's shadow is divided out of the ground at first and multiplied in at the end, so that it continues where
it crosses the sheet.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.square import side_lengths_px
from ashe_live.core.types import TrackedFrame
from ashe_live.render.cover.hidden_by_body import half_of_square, hidden_and_shaded
from ashe_live.render.cover.inpainting.filling import BESIDE_SIDES, BLEED_SIDES, filled, with_rim
from ashe_live.render.cover.inpainting.masked import distances_from
from ashe_live.render.cover.over_sheet import SheetAsMade, sheet_as_made
from ashe_live.render.cover.rectified import rectified
from ashe_live.render.cover.sheet import sheet_of

HALF_SIDES = 2.75  # half of the side of the square of ground that is examined, in sides of the marker
MOST_SIDE_PX, LEAST_SIDE_PX = 256.0, 24.0  # limits of the marker's side in the rectified picture
DRAFT_SIDE_PX = 64.0  # the upper limit for a draft: below it the time that one takes hardly falls
FINER = 1.5  # its pixels for one of the video: it is interpolated twice, and fine relief would be lost
COARSER = 1.6  # factor on the size of patches for a body, which hides several times as much ground as a sheet
FEATHER_PX = 2.0  # width of the band beyond the sheet in which the cover's alpha falls to 0
LEAST_SHADE = 0.02  # least factor of a shadow by which ground is divided
MOST_AROUND = 300  # largest number of points by which exposures are compared


@dataclass(frozen=True, slots=True, eq=False)
class GroundCover:
    """A picture of the plane; straight alpha, 0 where the video is to be seen."""

    image_rgba: Image  # (n, n, 4) uint8 sRGB, first row at the largest y
    half_m: float  # it spans -half_m to half_m of the marker frame in x and y
    extent_m: tuple[float, float, float, float]  # least x and y, largest x and y of what is covered
    around: Float  # (k, 2) metres: visible ground beside the sheet, by which exposures are compared
    around_rgb: Float  # (k, 3) linear, in the picture that it was made from
    sheet: SheetAsMade | None  # by which what comes over it is noticed; None for a body
    is_draft: bool  # coarser than the frame that it was made from shows the ground


def ground_cover(tracked: TrackedFrame, illumination: Illumination, is_draft: bool = False) -> GroundCover | None:
    """The cover of the sheet in a frame with a marker; None where too little ground is seen to make one.

    Of a body that the marker is on, as the paper cube: of all that it hides, and of its shadows. is_draft: if that
    saves time, a coarse one, in half a second where that of a phone's photo takes six.
    """
    side_m, body = tracked.pose.side_m, tracked.pose.body
    fine_px = float(np.clip(FINER * side_lengths_px(tracked.pose.corners_px).max(), LEAST_SIDE_PX, MOST_SIDE_PX))
    side_px = min(fine_px, DRAFT_SIDE_PX) if is_draft else fine_px
    half_m = HALF_SIDES * side_m if body is None else half_of_square(tracked.pose, body, illumination)
    plane = rectified(tracked, illumination, half_m, round(2 * half_m / side_m * side_px))
    lit = np.asarray(plane.linear / np.maximum(plane.shade, LEAST_SHADE), np.float32)
    # What is covered, the hole in it that has to be made up, and the ground that may be copied there.
    known, shade = plane.is_seen & ~plane.border, plane.shade
    if body is None:
        sheet = sheet_of(lit, known, side_px)
        hole, copied = sheet.mask, known & sheet.surroundings
        covered = with_rim(hole, side_px)
    else:
        hole, covered = hidden_and_shaded(tracked.pose, body, illumination, half_m, len(lit))
        hole |= plane.border | (covered & ~plane.is_seen)
        covered |= hole
        copied, shade = known & ~hole, np.ones_like(shade)  # its shadows go with it
    ground = filled(lit, hole, copied, side_px if body is None else COARSER * side_px)
    if ground is None and body is None and (copied != known).any():
        # The real object hides the page, and other ground is better than the marker.
        ground = filled(lit, hole, known, side_px)
    far_px = distances_from(covered)
    around = _beside(far_px, plane.is_seen, side_px)
    if ground is None or around is None:
        return None

    rows, columns = around
    alpha = np.clip(1 - far_px / FEATHER_PX, 0, 1)
    rgb = srgb_from_linear(np.clip(ground * shade, 0, 1))
    size, extent_m = len(hole), _extent(alpha > 0, half_m)
    return GroundCover(
        image_rgba=np.round(np.dstack([rgb, alpha]) * 255).astype(np.uint8),
        half_m=half_m,
        extent_m=extent_m,
        around=np.column_stack([columns + 0.5 - size / 2, size / 2 - rows - 0.5]) * (2 * half_m / size),
        around_rgb=plane.linear[rows, columns].astype(np.float64),
        sheet=sheet_as_made(plane, illumination, half_m, extent_m, side_m) if body is None else None,
        is_draft=side_px < fine_px,
    )


def _beside(far_px: Float32, is_seen: Mask, side_px: float) -> tuple[NDArray[np.intp], NDArray[np.intp]] | None:
    """Rows and columns of MOST_AROUND places at most of visible ground just beside what is covered; None without any.

    far_px: (n, n) from each pixel to what is covered. side_px: the marker's side.
    """
    least = BLEED_SIDES * side_px
    rows, columns = np.nonzero((far_px > least) & (far_px < least + BESIDE_SIDES * side_px) & is_seen)
    if not len(rows):
        return None
    step = -(-len(rows) // MOST_AROUND)
    return rows[::step], columns[::step]


def _extent(mask: Mask, half_m: float) -> tuple[float, float, float, float]:
    """Least x and y, largest x and y, metres, of what is in a mask (n, n) of the square."""
    left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
    texel = 2 * half_m / len(mask)
    return (
        left * texel - half_m,
        half_m - (top + height) * texel,
        (left + width) * texel - half_m,
        half_m - top * texel,
    )
