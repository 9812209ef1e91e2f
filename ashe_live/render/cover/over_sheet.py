"""What has come over the marker's covered sheet since its cover was made: a hand before it, or another shadow on it.

The sheet is compared with itself, as the frame of the cover shows it. What has another hue than a shadow gives it is a
thing before the sheet; what is darker, or lit again where the real object's shadow was, is in another light.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE
from ashe_live.core.light import Illumination
from ashe_live.core.transforms import image_from_plane
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.cover.rectified import LEAST_RATIO, Rectified
from ashe_live.render.cover.sheet import LEAST_HALF_SIDES
from ashe_live.render.lights.lighting import measured_ratio

TEXELS_A_SIDE = 48  # of the marker, in what is compared
BLACKEST = 0.01  # linear light that is added before logarithms are taken: black ink is not told from noise below it
USUAL_RATIO = 0.35  # of the light that a shadow leaves, where no light is known
DEEPEST = 1.3  # times the logarithm of that ratio: what is darker is darker than a shadow
SHIFT_TEXELS = 1  # by which the print shifts against the pose, and while the sheet curls
# Least difference of the channels' logarithms of a thing that is not paper or ink; of a dark one, as ink mirrors the
# sky, and noise is coloured; and largest one of paper and ink.
HUE, DARK_HUE, NEUTRAL = 0.3, 0.6, 0.2
PLAIN = 0.25  # largest difference of logarithms between the brightest and the darkest of a plain place
DARK_SHARE = 0.15  # of paper's brightness: what is below is dark
LIT_SHARE = 0.25  # of paper, its brightest: the rest may be hidden or in shadow
PAPER_SHARE = 0.3  # of paper's brightness: what is below is ink
# Logarithms of light between which a change becomes a shadow: curled and glossy paper changes by less as the camera
# moves.
SHADED = 0.2, 0.4
OPENED_TEXELS, CLOSED_TEXELS = 3, 5  # widths of the thinnest thing that is noticed, and of the gaps that are closed
LEAST_AREA_SIDES = 0.01  # squared sides of the marker: the smallest thing that is noticed
LOG_OF_8BIT: Float32 = np.log(LINEAR_FROM_SRGB_8BIT + BLACKEST).astype(np.float32)
# Mean logarithm of paper from which on a camera's tone curve may compress it, so that it follows the exposure no more.
COMPRESSED = float(LOG_OF_8BIT[200])
BRIGHTNESS: Float32 = REC709_LUMINANCE.astype(np.float32)
# Widths within which the depth of a shadow on ink is sought on paper, and the light at an edge of the print beside it.
FAR_TEXELS, NEAR_TEXELS = 33, 5


@dataclass(frozen=True, slots=True, eq=False)
class SheetAsMade:
    """The sheet in the frame that its cover was made from; first row at the largest y."""

    bounds_m: tuple[float, float, float, float]  # least x and y, largest x and y
    places: Float32  # (h, w, 2) metres, marker frame
    least: Float32  # (h, w, 3) logarithm of linear RGB, the least and the most within SHIFT_TEXELS
    most: Float32
    is_coloured: Mask  # (h, w) with something of another hue than paper and ink within SHIFT_TEXELS: ground, or print
    is_plain: Mask  # (h, w) of one brightness within SHIFT_TEXELS, so that light is not mistaken for a shifted edge
    is_paper: Mask  # (h, w) bright, as paper is
    is_white: Mask  # (h, w) paper for sure: within the square and its margin
    relit: Float32  # (h, w) logarithm by which the place would be brighter without the real object's shadow
    shadow: Float  # (3,) logarithm of the light that a shadow leaves


def sheet_as_made(
    plane: Rectified, illumination: Illumination, half_m: float, extent_m: tuple[float, ...], side_m: float
) -> SheetAsMade:
    """The part of a rectified plane, which spans -half_m to half_m in x and y, that lies within `extent_m`: least x and
    y, largest x and y, metres, marker frame. `side_m`: the side of the marker.
    """
    bounds_m, linear, shade = _part(plane, half_m, extent_m, side_m)
    logs = np.log(np.maximum(linear, 0) + BLACKEST).astype(np.float32)
    kernel = np.ones((2 * SHIFT_TEXELS + 1,) * 2)
    least, most = cv2.erode(logs, kernel), cv2.dilate(logs, kernel)
    relit = -np.log(np.maximum(shade, LEAST_RATIO)).mean(axis=2).astype(np.float32)
    places = _places(bounds_m, (linear.shape[1], linear.shape[0]))
    is_own = np.abs(places).max(axis=2) < LEAST_HALF_SIDES * side_m
    brightness = logs @ BRIGHTNESS + relit
    is_paper = brightness > np.quantile(brightness[is_own], 0.9) + np.log(PAPER_SHARE)
    is_plain = np.asarray((most - least).max(axis=2) < PLAIN)
    is_white = np.asarray(is_own & is_paper & is_plain)
    shadow = _log_ratio_of_shadow(illumination)
    hue = _hue(logs - _paper(logs, is_white), shadow) if is_white.any() else np.zeros_like(brightness)
    return SheetAsMade(
        bounds_m,
        places,
        least=np.asarray(least, np.float32),
        most=np.asarray(most, np.float32),
        is_coloured=np.asarray(cv2.dilate(hue, kernel) > NEUTRAL),
        is_plain=is_plain,
        is_paper=np.asarray(is_paper),
        is_white=is_white,
        relit=np.asarray(relit, np.float32),
        shadow=shadow,
    )


def _part(
    plane: Rectified, half_m: float, extent_m: tuple[float, ...], side_m: float
) -> tuple[tuple[float, float, float, float], Float32, Float32]:
    """The bounds (m) of the plane's texels that lie within `extent_m`, and their light and shade (h, w, 3).

    Both at TEXELS_A_SIDE texels for the marker's side.
    """
    count = len(plane.linear)
    texel_m = 2 * half_m / count
    left, bottom, right, top = (round(each / texel_m + count / 2) for each in extent_m)
    part = slice(count - top, count - bottom), slice(left, right)
    edges = [(each - count / 2) * texel_m for each in (left, bottom, right, top)]
    across, up = (max(8, round(width * texel_m / side_m * TEXELS_A_SIDE)) for width in (right - left, top - bottom))
    linear, shade = (
        np.asarray(cv2.resize(each[part], (across, up), interpolation=cv2.INTER_AREA), np.float32)
        for each in (plane.linear, plane.shade)
    )
    return (edges[0], edges[1], edges[2], edges[3]), linear, shade


def _log_ratio_of_shadow(illumination: Illumination) -> Float:
    """(3,) logarithm of the light that the shadow of the strongest measured light leaves, or a usual one."""
    ratios = [ratio for light in illumination.lights if (ratio := measured_ratio(light)) is not None]
    return np.asarray(np.log(np.clip(ratios[0], LEAST_RATIO, 0.9) if ratios else np.full(3, USUAL_RATIO)))


def over_sheet(tracked: TrackedFrame, sheet: SheetAsMade, gain: Float, slope: Float) -> Float32 | None:
    """(h, w, 2) the share of the sheet that a thing hides now, 0 to 1, and the natural logarithm of the light on it
    over that when its cover was made; None where nothing has changed, or part of the sheet is behind the camera.

    gain: (3,) exposure over that of the cover's frame, linear RGB; slope: (2,) 1/m, of its logarithm over the plane.
    """
    now = _seen(tracked, sheet)
    if now is None:
        return None
    exposure = np.log(gain).astype(np.float32) + (sheet.places @ slope.astype(np.float32))[..., None]
    least, most = sheet.least + exposure, sheet.most + exposure
    if sheet.is_white.any() and (paper := _paper(now, sheet.is_white)) @ BRIGHTNESS > COMPRESSED:
        least = np.minimum(least, paper)
    change = now - np.clip(now, least, most)
    if np.count_nonzero(np.abs(change) > SHADED[0]) < LEAST_AREA_SIDES * TEXELS_A_SIDE**2:
        return None
    hides = _things(now, change, sheet)
    light = _light((change @ BRIGHTNESS).astype(np.float32), hides, sheet)
    if not hides.any() and not light.any():
        return None
    # From its border inwards, as texels there are mixed with paper, which would show as a white rim.
    share = np.clip(2 * cv2.GaussianBlur(hides.astype(np.float32), (5, 5), 0) - 1, 0, 1)
    return np.asarray(np.dstack([share, light]), np.float32)


def _light(change: Float32, hides: Mask, sheet: SheetAsMade) -> Float32:
    """(h, w) logarithm of the light over that before, by the change (h, w) of the logarithm of brightness.

    Ink shows where a shadow lies, but mirrors light that no shadow takes: how deep it is, paper near by shows.
    """
    on_paper = np.clip(change, DEEPEST * sheet.shadow.min(), sheet.relit)
    on_paper *= np.clip((np.abs(on_paper) - SHADED[0]) / (SHADED[1] - SHADED[0]), 0, 1)
    is_clear = sheet.is_plain & ~hides
    is_other = _without_specks(is_clear & ((sheet.is_paper & (on_paper != 0)) | (on_paper > 0)))
    if not is_other.any():
        return np.zeros_like(change)
    is_shaded = is_other & (on_paper < 0)
    depth = _around(on_paper, is_shaded, FAR_TEXELS)
    is_dark = cv2.medianBlur((change < -SHADED[0]).astype(np.uint8), 3) > 0
    on_ink = np.where(is_dark, depth, np.where(on_paper > 0, sheet.relit, 0))
    light = np.where(sheet.is_paper, np.where(is_other | ~sheet.is_plain, on_paper, 0), on_ink)
    return np.where(is_clear, light, _around(light, is_clear, NEAR_TEXELS))


def _around(values: Float32, is_known: Mask, width: int) -> Float32:
    """(h, w) mean of the known values within a square of `width` texels; 0 where none is."""
    known = is_known.astype(np.float32)
    return np.asarray(cv2.blur(values * known, (width, width)) / np.maximum(cv2.blur(known, (width, width)), 1e-6))


def _things(now: Float32, change: Float32, sheet: SheetAsMade) -> Mask:
    """(h, w) what is of another hue than paper in light or shadow, ink, and their mixtures, and was not so before.

    Ink and paper have one hue, so that nothing depends on where exactly the one ends; paper's is that of now, as a
    coloured ground tells little of the white balance, and overexposed paper follows no exposure.
    """
    if not sheet.is_white.any():
        return np.zeros(sheet.is_white.shape, np.bool_)
    from_paper = now - _paper(now, sheet.is_white)
    is_dark = from_paper @ BRIGHTNESS < np.log(DARK_SHARE)
    is_other = _hue(from_paper, sheet.shadow) > np.where(is_dark, DARK_HUE, HUE)
    # What was coloured is the same if its shadow has gone.
    is_other &= ~sheet.is_coloured | (_hue(change, sheet.shadow, -DEEPEST) > HUE)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (CLOSED_TEXELS, CLOSED_TEXELS))
    return np.asarray(cv2.morphologyEx(_without_specks(is_other).astype(np.uint8), cv2.MORPH_CLOSE, disc) > 0)


def _without_specks(mask: Mask) -> Mask:
    """(h, w) without what is narrow; nothing where little is left."""
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, np.ones((OPENED_TEXELS,) * 2)) > 0
    return opened if np.count_nonzero(opened) >= LEAST_AREA_SIDES * TEXELS_A_SIDE**2 else np.zeros_like(opened)


def _paper(logs: Float32, is_white: Mask) -> Float32:
    """(3,) logarithm of lit paper: of the brightest of what is paper, as things and shadows before it are darker."""
    white = logs[is_white]
    brightness = white @ BRIGHTNESS
    return np.asarray(np.median(white[brightness >= np.quantile(brightness, 1 - LIT_SHARE)], axis=0), np.float32)


def _hue(from_paper: Float32, shadow: Float, least: float = 0.0) -> Float32:
    """(h, w) largest difference between the channels (h, w, 3) beyond that of a shadow of any depth.

    least: of that depth, in shadows; below 0, a shadow may have gone.
    """
    left = from_paper - from_paper.mean(axis=2, keepdims=True)
    tint = (shadow - shadow.mean()).astype(np.float32)
    if tint.any():
        left -= np.clip(left @ (tint / (tint @ tint)), least, DEEPEST)[..., None] * tint
    return np.asarray(left.max(axis=2) - left.min(axis=2))


def _places(bounds_m: tuple[float, float, float, float], size: tuple[int, int]) -> Float32:
    """(h, w, 2) metres, marker frame."""
    (left, bottom, right, top), (width, height) = bounds_m, size
    x = left + (np.arange(width) + 0.5) * (right - left) / width
    y = top - (np.arange(height) + 0.5) * (top - bottom) / height
    return np.dstack(np.meshgrid(x, y)).astype(np.float32)


def _seen(tracked: TrackedFrame, sheet: SheetAsMade) -> Float32 | None:
    """(h, w, 3) logarithm of linear RGB, as exposed; None where part of the sheet is behind the camera."""
    T_cam_marker, image = tracked.pose.T_cam_marker, tracked.frame.image_bgr
    height, width = sheet.relit.shape
    left, bottom, right, top = sheet.bounds_m
    corners = np.array([(left, bottom), (left, top), (right, bottom), (right, top)])
    if (corners @ T_cam_marker[2, :2] + T_cam_marker[2, 3] <= 1e-3).any():
        return None
    if tracked.camera.is_distorted:
        places = sheet.places.reshape(-1, 2)
        at = project_distorted(tracked.camera, T_cam_marker, np.column_stack([places, np.zeros(len(places))]))
        at = at.reshape(height, width, 2).astype(np.float32)
        seen = cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    else:
        step = np.array([(right - left) / width, (bottom - top) / height])
        plane_from_texel = np.array([[step[0], 0, left + step[0] / 2], [0, step[1], top + step[1] / 2], [0, 0, 1]])
        H = image_from_plane(tracked.camera, T_cam_marker) @ plane_from_texel
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        seen = cv2.warpPerspective(image, H, (width, height), flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(LOG_OF_8BIT[seen[..., ::-1]], np.float32)
