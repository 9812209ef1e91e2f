"""Paper shown in the colour of the ground that it lies on, by the ratio of their linear light."""

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import FRACTION_BITS, Float, Image, Mask, fixed_point
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.light.pixels.areas import grown, majority
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.near_plane import before_camera
from ashe_live.light.pixels.page import PageAround
from ashe_live.light.pixels.page_lines import FARTHEST, is_coloured
from ashe_live.light.pixels.sheet import ADDED, USUAL_SHEET, MarkerPicture, Sheet

STANDS_PX = 5  # across a neighbourhood whose majority decides between noise and what stands on the page
# Where the colour this near to a page's border differs by so much from the lit ground's, in log-opponent distance,
# something may cross the border so near.
BESIDE_PX, OTHER, CROSSED_PX = 3, 0.6, 8
PAINTED_PX = 2  # distance from a page's border of the pixels that it is painted over with


def page_shown_as_ground(page: PageAround, picture: MarkerPicture) -> tuple[Image, Mask]:
    """The picture (h, w, 3) as if the page had the colour of the ground that it lies on; and where
    something crosses the page's border, (h, w), which is painted over there with what lies on either side of it.

    What stands on the page keeps its colour, as far as that is not paper's. Beside the marker it stays paper, by which
    the exposure is judged.
    """
    larger = Sheet(*(end + ADDED for end in page.ends))
    smaller = Sheet(*(end - ADDED if seen else end + ADDED for end, seen in zip(page.ends, page.is_seen, strict=True)))
    whole, marker, outer, inner = (
        outline_of(sheet, picture) for sheet in (Sheet(*page.ends), USUAL_SHEET, larger, smaller)
    )
    image_bgr = picture.image_bgr
    inside, border = (np.zeros(image_bgr.shape[:2], np.uint8) for _ in range(2))
    for mask, outline, value in ((inside, whole, 1), (inside, marker, 0), (border, outer, 1), (border, inner, 0)):
        cv2.fillConvexPoly(mask, outline, value, shift=FRACTION_BITS)
    is_paper = (inside > 0) & ~majority(is_coloured(log_opponent(image_bgr), np.array(page.ground.paper)), STANDS_PX)
    shown = image_bgr.copy()
    linear = LINEAR_FROM_SRGB_8BIT[image_bgr[is_paper]] * page.ground.over_paper_at(_places(is_paper, picture))[:, ::-1]
    shown[is_paper] = np.round(255 * srgb_from_linear(np.minimum(linear, 1)))
    beside, near = grown(border > 0, BESIDE_PX) & (border == 0), grown(border > 0, BESIDE_PX + STANDS_PX)
    is_other = np.zeros(near.shape, np.bool_)
    away = log_opponent(shown)[near] - page.ground.lit_at(_places(near, picture))
    is_other[near] = np.linalg.norm(away, axis=1) > OTHER
    crossed = (border > 0) & grown(majority(is_other, STANDS_PX) & beside, CROSSED_PX)
    # What is no ground beside it is rounded to whole pixels by itself.
    return painted_over(shown, crossed, PAINTED_PX), grown(crossed, 1)


def _places(pixels: Mask, picture: MarkerPicture) -> Float:
    """(n, 2) where on the marker's plane the chosen pixels (h, w) lie, in its sides from its centre, within a page."""
    rows, columns = np.nonzero(pixels)
    there = raycast_to_plane(picture.camera, picture.T_cam_marker, np.column_stack([columns, rows]))[:, :2]
    return np.clip(np.nan_to_num(there / picture.side_m), -FARTHEST, FARTHEST)


def in_ground_colour(image_bgr: Image, ground_over_paper: Float) -> Image:
    """A picture of paper as one of ground, which has so many times the paper's linear RGB (3,)."""
    linear = LINEAR_FROM_SRGB_8BIT[:, None] * ground_over_paper[::-1]
    table = np.round(255 * srgb_from_linear(np.minimum(linear, 1))).astype(np.uint8)
    return np.asarray(cv2.LUT(image_bgr, table[:, None]), dtype=np.uint8)


def painted_over(image_bgr: Image, hidden: Mask, from_px: int) -> Image:
    """The picture where what is `hidden`, (h, w), continues what lies around it, as far as `from_px` away."""
    return np.asarray(cv2.inpaint(image_bgr, hidden.astype(np.uint8), from_px, cv2.INPAINT_TELEA), dtype=np.uint8)


def outline_of(sheet: Sheet, picture: MarkerPicture) -> NDArray[np.int32]:
    """(m, 2) in 2 ** -FRACTION_BITS pixels: the outline of what of a sheet lies before the camera; empty for nothing.

    A page whose end is out of the picture may reach behind the camera, as where it ends is not known.
    """
    corners = sheet.corners(picture.side_m)
    points = before_camera(corners, picture.T_cam_marker)
    outline = project(picture.camera, picture.T_cam_marker, points).clip(-1e4, 1e4)
    if len(points) and not np.array_equal(points, corners):  # some are where lines meet the near plane, in any order
        outline = cv2.convexHull(outline.astype(np.float32))[:, 0]
    return fixed_point(outline)
