"""The ground that the marker's sheet hides, made up from the ground around it in the marker's plane.

Patches of the sheet's place are filled from the outside inwards by those patches of visible ground that continue what
is known already (Criminisi, Perez, Toyama, "Region filling and object removal by exemplar-based image inpainting", IEEE
Trans. Image Processing 2004). What difference is left at the border is spread over the inside as smoothly as can be
(Perez, Gangnet, Blake, "Poisson image editing", SIGGRAPH 2003). All of it works on ground without the real object's
shadow, which is put back at the end, so that the shadow continues where it crosses the sheet.
"""

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.square import side_lengths_px
from ashe_live.core.transforms import project
from ashe_live.core.types import Illumination, TrackedFrame
from ashe_live.render.cover.sheet import sheet_mask

HALF_SIDES = 2.75  # of the square of the plane that is looked at, in sides of the marker
MOST_SIDE_PX, LEAST_SIDE_PX = 128.0, 24.0  # of the marker in the rectified picture
COARSE_SIDE_PX = 26.0  # of the marker where patches are looked for
PATCH = 15  # coarse pixels a side
STEP = 7
SHADOW_BORDER_PX = 3  # coarse; ground that close to the real shadow's border is no source
FEATHER_PX = 2.0  # beyond the sheet, over which the cover ends
# Beside the sheet, in its sides: ground that the picture's coarse colours and sharpening have not mixed with paper.
BLEED_SIDES, BESIDE_SIDES = 0.06, 0.16
AROUND_SIDES = 0.5  # of the sheet: ground that tells which colours ground has
# Beyond the range of those: of the brightest, and of a channel's share in a colour, both of roots of linear RGB.
UNLIKE, UNLIKE_HUE = 0.12, 0.03
MOST_AROUND = 600  # points by which exposures are compared
FIELD = 128  # cells a side in which the difference at the border is spread
SMOOTH_ROUNDS = 100


@dataclass(frozen=True, slots=True, eq=False)
class GroundCover:
    """A picture of the plane; straight alpha, 0 where the video is to be seen."""

    image_rgba: Image  # (n, n, 4) uint8 sRGB, first row at the largest y
    half_m: float  # it spans -half_m to half_m of the marker frame in x and y
    extent_m: tuple[float, float, float, float]  # least x and y, largest x and y of what is covered
    around: Float  # (k, 2) metres: visible ground beside the sheet, by which exposures are compared
    around_rgb: Float  # (k, 3) linear, in the picture that it was made from


class _Plane(NamedTuple):
    """A square of the marker's plane, rectified."""

    linear: Float32  # (n, n, 3) RGB
    is_seen: Mask  # (n, n) in the picture, and not behind the real object
    shade: Float32  # (n, n, 3) fraction of the light that the real object's shadow leaves
    border: Mask  # (n, n) too near to that shadow's border to tell


def ground_cover(tracked: TrackedFrame, illumination: Illumination) -> GroundCover | None:
    """The cover of the sheet in a frame with a marker; None where too little ground is seen to make one."""
    assert tracked.marker is not None
    if tracked.marker.body is not None:
        return None  # what stands there is no sheet
    side_m = tracked.marker.side_m
    side_px = float(np.clip(side_lengths_px(tracked.marker.corners_px).max(), LEAST_SIDE_PX, MOST_SIDE_PX))
    half_m = HALF_SIDES * side_m
    plane = _rectified(tracked, illumination, half_m, round(2 * HALF_SIDES * side_px))
    lit = np.asarray(plane.linear / np.maximum(plane.shade, 0.02), np.float32)
    hole = sheet_mask(lit, plane.is_seen & ~plane.border, side_px)
    filled = _filled(lit, hole, plane.is_seen & ~plane.border, side_px)
    if filled is None:
        return None
    far = cv2.distanceTransform((~hole).astype(np.uint8), cv2.DIST_L2, 5)
    rows, columns = np.nonzero((far > BLEED_SIDES * side_px) & (far < BESIDE_SIDES * side_px) & plane.is_seen)
    if not len(rows):
        return None
    rows, columns = (each[:: max(1, len(rows) // MOST_AROUND)] for each in (rows, columns))
    alpha = np.clip(1 - far / FEATHER_PX, 0, 1)
    rgb = srgb_from_linear(np.clip(filled * plane.shade, 0, 1))
    size = len(hole)
    return GroundCover(
        np.round(np.dstack([rgb, alpha]) * 255).astype(np.uint8),
        half_m,
        _extent(alpha > 0, half_m),
        np.column_stack([columns + 0.5 - size / 2, size / 2 - rows - 0.5]) * (2 * half_m / size),
        plane.linear[rows, columns].astype(np.float64),
    )


def _extent(mask: Mask, half_m: float) -> tuple[float, float, float, float]:
    left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
    texel = 2 * half_m / len(mask)
    return (
        left * texel - half_m,
        half_m - (top + height) * texel,
        (left + width) * texel - half_m,
        half_m - top * texel,
    )


def _rectified(tracked: TrackedFrame, illumination: Illumination, half_m: float, size: int) -> _Plane:
    assert tracked.marker is not None
    T = tracked.marker.T_cam_marker
    steps = ((np.arange(size) + 0.5) / size * 2 - 1) * half_m
    x, y = np.meshgrid(steps, -steps)
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    ahead = points @ T[2, :3] + T[2, 3] > 1e-3 * half_m
    pixels = np.full((len(points), 2), -10.0)
    pixels[ahead] = project(tracked.camera, T, points[ahead])
    at = pixels.reshape(size, size, 2).astype(np.float32)
    width, height = tracked.frame.size
    is_seen = ((at > 1) & (at < (width - 2, height - 2))).all(axis=2)
    image = cv2.remap(tracked.frame.image_bgr, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
    linear = LINEAR_FROM_SRGB_8BIT[image[..., ::-1]].astype(np.float32)
    shade = np.ones((size, size, 3), np.float32)
    border = np.zeros((size, size), bool)
    proxy = illumination.real_object
    if proxy is not None:
        body = proxy.surface()[0]
        if (body @ T[2, :3] + T[2, 3]).min() > 0:
            outline = cv2.convexHull(project(tracked.camera, T, body).astype(np.float32))
            hides = np.zeros((height, width), np.uint8)
            cv2.fillConvexPoly(hides, np.round(outline).astype(np.int32), 1)
            grown = cv2.dilate(hides, np.ones((5, 5)))
            is_seen &= cv2.remap(grown, at[..., 0], at[..., 1], cv2.INTER_NEAREST) == 0
        reach = SHADOW_BORDER_PX * size / (2 * HALF_SIDES * COARSE_SIDE_PX)
        for light in illumination.lights:
            ratio, way = light.shadow_rgb_ratio, light.homogeneous
            if ratio is None or way[2] <= 0:
                continue
            # As ashe_live/light/shape/light_points.py has it, for suns and lamps.
            scale = way[2] - way[3] * body[:, 2]
            if scale.min() <= 0:
                continue
            cast = (way[2] * body[:, :2] - body[:, 2:] * way[:2]) / scale[:, None]
            cells = np.column_stack([cast[:, 0], -cast[:, 1]]) / half_m * size / 2 + size / 2 - 0.5
            outline = cv2.convexHull(np.clip(cells, -4 * size, 5 * size).astype(np.float32))
            dark = np.zeros((size, size), np.uint8)
            cv2.fillConvexPoly(dark, np.round(outline * 16).astype(np.int32), 255, cv2.LINE_AA, 4)
            soft = (cv2.GaussianBlur(dark, (0, 0), 0.8) / 255.0)[..., None]
            shade *= (1 - soft * (1 - np.clip(ratio, 0.02, 1))).astype(np.float32)
            border |= cv2.morphologyEx(dark, cv2.MORPH_GRADIENT, np.ones((3, 3))) > 0
        border = cv2.dilate(border.astype(np.uint8), np.ones((2 * round(reach) + 1,) * 2)) > 0
    return _Plane(linear, np.asarray(is_seen), shade, np.asarray(border))


def _filled(lit: Float32, hole: Mask, is_source: Mask, side_px: float) -> Float32 | None:
    """(n, n, 3) `lit` with the hole filled; None where no patch of ground is seen whole."""
    size = max(PATCH + 2, round(len(hole) * COARSE_SIDE_PX / side_px))
    # Roots: dark and bright patches are compared alike.
    roots = np.sqrt(np.clip(lit, 0, 4)).astype(np.float32)
    coarse = np.asarray(cv2.resize(roots, (size, size), interpolation=cv2.INTER_AREA), np.float32)
    bleeds = cv2.distanceTransform((~hole).astype(np.uint8), cv2.DIST_L2, 5) < BLEED_SIDES * side_px
    unknown = cv2.resize(bleeds.astype(np.float32), (size, size), interpolation=cv2.INTER_AREA) > 0.02
    whole = cv2.resize((is_source & ~bleeds).astype(np.float32), (size, size), interpolation=cv2.INTER_AREA) > 0.98
    whole &= _like_the_ground_around(coarse, whole, unknown)
    sources = cv2.erode(whole.astype(np.uint8), np.ones((PATCH, PATCH)), borderValue=0) > 0
    if not sources.any() or not unknown.any():
        return None
    pasted, weight = np.zeros_like(roots), np.zeros(hole.shape, np.float32)
    scale = len(hole) / size
    trusted = (is_source & ~bleeds).astype(np.float32)
    for place, source in _patches(coarse, unknown, whole, sources):
        _paste(pasted, weight, roots, trusted, place, source, scale)
    filled = np.where(hole[..., None] & (weight[..., None] > 0), pasted / np.maximum(weight, 1e-9)[..., None], roots)
    return np.square(filled + _spread_difference(roots, pasted, weight, hole, is_source, side_px))


def _like_the_ground_around(coarse: Float32, known: Mask, unknown: Mask) -> Mask:
    """(m, m) whose colour occurs beside the unknown part: not objects, whether an estimate knows of them or not.

    coarse: (m, m, 3) roots of linear RGB.
    """
    away = cv2.distanceTransform((~unknown).astype(np.uint8), cv2.DIST_L2, 5)
    beside = known & (away < AROUND_SIDES * COARSE_SIDE_PX)
    if not beside.any():
        return known
    smooth = cv2.GaussianBlur(coarse, (0, 0), 1.0)
    low, high = np.percentile(smooth[beside], (2, 98), axis=0)
    margin = UNLIKE * float(high.mean())
    alike = ((smooth > low - margin) & (smooth < high + margin)).all(axis=2)
    # Hues, too: a grey object may be as bright as the ground.
    hues = smooth / np.maximum(smooth.sum(axis=2, keepdims=True), 1e-3)
    low, high = np.percentile(hues[beside], (2, 98), axis=0)
    return np.asarray(alike & ((hues > low - UNLIKE_HUE) & (hues < high + UNLIKE_HUE)).all(axis=2))


def _patches(coarse: Float32, unknown: Mask, known: Mask, sources: Mask) -> list[tuple[Float, Float]]:
    """Middles (row, column) of coarse patches to fill and of those to copy, in the order of filling."""
    reach = PATCH // 2
    picture, known, left = coarse.copy(), known.copy(), unknown.copy()
    found: list[tuple[Float, Float]] = []
    size = len(unknown)
    places = [
        (row, column)
        for row in range(reach, size - reach, STEP)
        for column in range(reach, size - reach, STEP)
        if unknown[row - reach : row + reach + 1, column - reach : column + reach + 1].any()
    ]
    while places and left.any():

        def confidence(place: tuple[int, int]) -> float:
            row, column = place
            return float(known[row - reach : row + reach + 1, column - reach : column + reach + 1].mean())

        place = max(places, key=confidence)
        places.remove(place)
        row, column = place
        window = (slice(row - reach, row + reach + 1), slice(column - reach, column + reach + 1))
        mask = known[window]
        if mask.any():
            masked = np.repeat(mask[..., None].astype(np.float32), 3, axis=2)
            misfit = cv2.matchTemplate(picture, picture[window], cv2.TM_SQDIFF, mask=masked)
            misfit = np.where(sources[reach:-reach, reach:-reach], misfit, np.inf)
            at = np.unravel_index(int(np.argmin(misfit)), misfit.shape)
            source = (int(at[0]) + reach, int(at[1]) + reach)
        else:
            rows, columns = np.nonzero(sources)
            source = int(rows[len(rows) // 2]), int(columns[len(rows) // 2])
        copied = coarse[source[0] - reach : source[0] + reach + 1, source[1] - reach : source[1] + reach + 1]
        new = ~mask
        picture[window][new] = copied[new]
        known[window] |= True
        left[window] = False
        found.append((np.array(place, float), np.array(source, float)))
    return found


def _paste(
    pasted: Float32, weight: Float32, roots: Float32, trusted: Float32, place: Float, source: Float, scale: float
) -> None:
    """Adds a patch of the fine picture, moved to where it fits best, with weights that fall off towards its border.

    trusted: (n, n) 1 on visible ground, else 0.
    """
    n, reach, play = len(weight), round(PATCH / 2 * scale), round(scale)
    middle, origin = (np.round((each + 0.5) * scale).astype(int) for each in (place, source))
    low = np.maximum(middle - reach, 0)
    high = np.minimum(middle + reach, n)
    to = (slice(low[0], high[0]), slice(low[1], high[1]))
    begin = np.maximum(origin - (middle - low) - play, 0)
    end = np.minimum(origin + (high - middle) + play, n)
    region = roots[begin[0] : end[0], begin[1] : end[1]]
    size = high - low
    if (np.array(region.shape[:2]) < size).any():
        return
    known = weight[to] > 0
    there = np.where(known[..., None], pasted[to] / np.maximum(weight[to], 1e-9)[..., None], roots[to])
    mask = np.maximum(known.astype(np.float32), trusted[to])
    at = origin - (middle - low) - begin
    if mask.any():
        misfit = cv2.matchTemplate(region, there, cv2.TM_SQDIFF, mask=np.repeat(mask[..., None], 3, axis=2))
        at = np.array(np.unravel_index(int(np.argmin(misfit)), misfit.shape))
    rows, columns = (
        np.cos((np.arange(low[k], high[k]) - middle[k] + 0.5) / reach * (np.pi / 2) * 0.98) ** 4 for k in (0, 1)
    )
    share = np.outer(rows, columns).astype(np.float32)
    pasted[to] += share[..., None] * region[at[0] : at[0] + size[0], at[1] : at[1] + size[1]]
    weight[to] += share


def _spread_difference(
    roots: Float32, pasted: Float32, weight: Float32, hole: Mask, is_source: Mask, side_px: float
) -> Float32:
    """(n, n, 3) what is to be added inside the hole: at its border the difference to the ground beside it, harmonic."""
    size = FIELD
    near = hole.astype(np.uint8)
    beside = cv2.distanceTransform(1 - near, cv2.DIST_L2, 5) / side_px
    ring = (beside > BLEED_SIDES) & (beside < BESIDE_SIDES) & is_source & (weight > 0)
    difference = np.where(ring[..., None], roots - pasted / np.maximum(weight, 1e-9)[..., None], 0).astype(np.float32)
    share = cv2.resize(ring.astype(np.float32), (size, size), interpolation=cv2.INTER_AREA)
    sums = cv2.resize(difference, (size, size), interpolation=cv2.INTER_AREA)
    fixed = share > 0.05
    value = np.where(fixed[..., None], sums / np.maximum(share, 1e-6)[..., None], 0).astype(np.float32)
    trusted = fixed.astype(np.float32)
    # From coarse to fine: a start by ever wider means, then Laplace's equation relaxed.
    start, seen = value * trusted[..., None], trusted.copy()
    for sigma in (1, 2, 4, 8, 16, 32):
        wide = cv2.GaussianBlur(value * trusted[..., None], (0, 0), sigma)
        much = cv2.GaussianBlur(trusted, (0, 0), sigma)
        fills = (seen == 0) & (much > 1e-3)
        start[fills] = wide[fills] / much[fills][:, None]
        seen[fills] = 1
    field = start
    for _ in range(SMOOTH_ROUNDS):
        field = np.where(fixed[..., None], value, cv2.blur(field, (3, 3)))
    spread = cv2.resize(field, hole.shape[::-1], interpolation=cv2.INTER_LINEAR)
    return np.where(hole[..., None], spread, 0).astype(np.float32)
