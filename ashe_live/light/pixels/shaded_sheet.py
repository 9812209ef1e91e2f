"""A marker's sheet that a shadow falls on, shown as the ground that it lies on.

Beside a marker stands what casts a shadow, and often onto the sheet. There the shadow's end would be out of sight, as
the print hides it. But the paper is lit as the ground is: one ratio of linear light parts both, in light as in shadow.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Float32, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.transforms import project
from ashe_live.light.pixels.areas import shrunk
from ashe_live.light.pixels.log_colour import DARKEST
from ashe_live.light.pixels.mixtures import clusters
from ashe_live.light.pixels.sheet import ADDED, MarkerPicture, Sheet
from ashe_live.light.pixels.shown_as_ground import in_ground_colour, outline_of, painted_over

# Paper in a shadow is darker than the rest by at least this, in log brightness, on at least this share of the margin;
# curled paper differs by less. Paper is plain: either level scatters by less than this share of their difference.
LEAST_DEPTH, LEAST_SHARE, MOST_SCATTER = 0.35, 0.05, 0.12
# Lights differ in blue over red; by how much the log of green may differ, beside the mean of all. What hides the paper
# may have any colour.
MOST_GREEN = 0.12
INK = 0.5 + 0.03  # sides of the marker from its centre: the square with its blurred edge
RIM = 0.02  # sides: of the sheet, where paper and ground mix
# What sends at least this share of the light of paper in the shade is no ink, if ink in the light sends less.
LEAST_WHITE = 0.6
BORDER = (0.44, 0.39)  # sides from the centre between which there is ink, but for a blurred edge
ALONG = np.linspace(-0.8, 0.8, 33)  # places along half of a side of the sheet, at which paper and ground are compared
BESIDE = 0.04  # sides: how far from the sheet's end
NEARBY = np.linspace(-2.5, 2.5, 41)  # sides from the centre, in x and y, where the ground's colours are counted
ALIKE, SHADED_ALIKE = 0.2, 0.3  # distances of log colours within which two are alike: in light, and in the shade
# Of the places beside paper in the shade, as many and such a share are as beside lit paper where a shadow crosses the
# end of the sheet: not all, as a shadow's edge may run along it.
FEWEST_SHADED, LEAST_ALIKE = 3, 0.2
LIT_INK = 0.75  # quantile of the border's ink that stands for ink in the light: what is brighter may be white's blur
CERTAIN_PX = 2  # from ink: nearer white is mixed with it
PAINTED_PX = 3  # distance of the pixels that ink, and the sheet's end, are painted over with


def shaded_sheet_as_ground(picture: MarkerPicture, sheet: Sheet) -> tuple[Image, Mask] | None:
    """The picture (h, w, 3) as if the sheet were ground, and where it is, (h, w).

    None where no shadow's edge crosses the paper beside the square, or where ink in the light cannot be told from
    paper in the shadow.
    """
    ends = sheet.ends
    # A shadow's edge along a side may be taken for its end. Beyond the other sides' there is ground on all.
    farthest = np.full(4, ends.max())
    plane = _Plane.around(farthest, picture)
    if plane is None:
        return None
    image, inner, outer = plane.image_bgr, plane.area(ends - 2 * ADDED - RIM), plane.area(farthest)
    paper = _Paper.partly_shaded(plane, inner)
    if paper is None:
        return None
    change = _from_paper_to_ground(plane, ends, farthest, paper)
    if change is None:
        return None
    blank = painted_over(image, inner & ~paper.white, PAINTED_PX)
    shown = np.where(inner[..., None], in_ground_colour(blank, np.exp(change[::-1])), image)
    whole = picture.image_bgr.copy()
    where = np.zeros(whole.shape[:2], np.bool_)
    whole[plane.window], where[plane.window] = painted_over(shown, outer & ~inner, PAINTED_PX), outer
    return whole, where


@dataclass(frozen=True, slots=True, eq=False)
class _Plane:
    """A marker's plane in a picture, and the window around the marker. Places are in its sides, from its centre."""

    picture: MarkerPicture
    window: tuple[slice, slice]  # rows and columns of it, (h, w)

    @staticmethod
    def around(ends: Float, picture: MarkerPicture) -> "_Plane | None":
        """With the window that shows a rectangle; None where that is not before the camera or in view.

        ends: (4,) of that rectangle, right, above, left and below.
        """
        rectangle = Sheet(*(ends + 2 * ADDED)).corners(picture.side_m)
        corners = project(picture.camera, picture.T_cam_marker, rectangle)
        if not np.isfinite(corners).all():
            return None
        size = np.array(picture.image_bgr.shape[1::-1])
        (left, top), (right, bottom) = (
            each.clip(0, size).astype(int) for each in (np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0)))
        )
        if right - left < 2 or bottom - top < 2:
            return None
        return _Plane(picture, (slice(top, bottom), slice(left, right)))

    @property
    def image_bgr(self) -> Image:
        """(h, w, 3) of the window."""
        return np.ascontiguousarray(self.picture.image_bgr[self.window])

    def area(self, ends: Float) -> Mask:
        """(h, w) the rectangle that ends there (4,) right, above, left and below of the centre."""
        rows, columns = self.window
        mask = np.zeros((rows.stop - rows.start, columns.stop - columns.start), np.uint8)
        outline = outline_of(Sheet(*ends), self.picture)
        start = np.array((columns.start, rows.start), np.int32) << FRACTION_BITS
        cv2.fillConvexPoly(mask, outline - start, 1, shift=FRACTION_BITS)
        return mask.view(np.bool_)

    def logs(self, places: Float) -> Float:
        """(n, 3) log linear BGR at places (n, 2); NaN outside of the picture."""
        image, camera = self.picture.image_bgr, self.picture.camera
        points = np.column_stack([self.picture.side_m * places, np.zeros(len(places))])
        pixels = project(camera, self.picture.T_cam_marker, points)
        x, y = np.nan_to_num(pixels, nan=-1).clip(-1, 1e4).astype(np.float32).T
        width, height = camera.size
        seen = (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
        colours = cv2.remap(image, x.copy(), y.copy(), cv2.INTER_LINEAR).reshape(-1, 3)
        return np.where(seen[:, None], np.log(LINEAR_FROM_SRGB_8BIT[colours] + DARKEST), np.nan)


@dataclass(frozen=True, slots=True, eq=False)
class _Paper:
    """A sheet's paper, a part of which lies in a shadow."""

    white: Mask  # (h, w) of the window: what of the sheet surely is no ink
    lit: Float  # (3,) log linear BGR of that in the light
    half_way: float  # log brightness, between that in the shadow and that in the light

    @staticmethod
    def partly_shaded(plane: _Plane, inner: Mask) -> "_Paper | None":
        """Of the sheet's inside (h, w); None where paper has one level, and where lit ink looks like shaded paper."""
        square, black, middle = (plane.area(np.full(4, half)) for half in (INK, *BORDER))
        linear = np.asarray(cv2.LUT(plane.image_bgr, LINEAR_FROM_SRGB_8BIT), dtype=np.float64)
        brightness = np.log(linear @ REC709_LUMINANCE[::-1] + DARKEST).astype(np.float32)
        margin, ink = inner & ~square, brightness[black & ~middle]
        levels = _two_levels(brightness[margin])
        if levels is None or not len(ink):
            return None
        is_lit, shaded, lit = levels
        least = shaded + float(np.log(LEAST_WHITE))
        paper, in_shadow = (np.log(np.median(linear[margin][each], axis=0) + DARKEST) for each in (is_lit, ~is_lit))
        shift = in_shadow - paper
        if np.quantile(ink, LIT_INK) > least or abs(shift[1] - shift.mean()) > MOST_GREEN:
            return None
        white = margin | shrunk(square & (brightness > least), CERTAIN_PX)
        return _Paper(white, paper, 0.5 * (shaded + lit))


def _two_levels(brightness: Float32) -> tuple[Mask, float, float] | None:
    """Which of the paper (m,) lies in the light, and its log brightness in a shadow and there; None where it has no two
    levels.
    """
    if len(brightness) < 2:
        return None
    labels, centres = clusters(brightness[:, None], 2)
    is_lit = labels == int(centres[:, 0].argmax())
    if not LEAST_SHARE < float(is_lit.mean()) < 1 - LEAST_SHARE:
        return None
    levels = [float(np.median(brightness[each])) for each in (~is_lit, is_lit)]
    depth = levels[1] - levels[0]
    scatters = [np.median(np.abs(brightness[each] - at)) for each, at in zip((~is_lit, is_lit), levels, strict=True)]
    return (is_lit, *levels) if depth > LEAST_DEPTH and max(scatters) < MOST_SCATTER * depth else None


def _from_paper_to_ground(plane: _Plane, ends: Float, farthest: Float, paper: _Paper) -> Float | None:
    """(3,) change of log linear BGR from the paper to the ground right beside it.

    Of the changes all around the sheet, which differ where the ground has a pattern, the one that leads from paper in
    the light to the commonest of the colours nearby. Where a shadow crosses the sheet's end, some of the changes beside
    shaded paper are like those in the light; what hides the paper makes others. None where too few are alike.
    """
    within, beyond = (plane.logs(_along(each)) for each in (ends - 2 * ADDED - BESIDE, farthest + BESIDE))
    x, y = (each.ravel() for each in np.meshgrid(NEARBY, NEARBY))
    outside = np.maximum(np.abs(x), np.abs(y)) > farthest[0]
    nearby = plane.logs(np.column_stack([x, y])[outside])
    is_seen = np.isfinite(within).all(axis=1) & np.isfinite(beyond).all(axis=1)
    within, changes, nearby = within[is_seen], (beyond - within)[is_seen], nearby[np.isfinite(nearby).all(axis=1)]
    is_lit = np.log(np.exp(within) @ REC709_LUMINANCE[::-1]) > paper.half_way
    lit, shaded = changes[is_lit], changes[~is_lit]
    if not len(lit):
        return None
    like_lit = np.linalg.norm(shaded[:, None] - lit, axis=2).min(axis=1) < SHADED_ALIKE
    if np.count_nonzero(like_lit) < max(LEAST_ALIKE * len(shaded), FEWEST_SHADED):
        return None
    found = np.linalg.norm((paper.lit + lit)[:, None] - nearby, axis=2) < ALIKE
    commonest = lit[int(found.sum(axis=1).argmax())]
    return np.asarray(lit[np.linalg.norm(lit - commonest, axis=1) < ALIKE].mean(axis=0))


def _along(ends: Float) -> Float:
    """(n, 2) places along a rectangle that ends there (4,) right, above, left and below of the centre."""
    right, above, left, below = ends
    one = np.ones_like(ALONG)
    x, y = 0.5 * (right - left + (right + left) * ALONG), 0.5 * (above - below + (above + below) * ALONG)
    sides = ((right * one, y), (x, above * one), (-left * one, y), (x, -below * one))
    return np.concatenate([np.column_stack(each) for each in sides])
