"""An estimate step by step, as pictures for a person: what the estimator took for what, and how well it explains that.

Nothing here is needed to estimate; what an estimate does not carry is computed once more by the estimator's stages.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from PIL import Image as PillowImage
from PIL import ImageDraw, ImageFont

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angles_from_direction, direction_from_angles, tangent_basis
from ashe_live.core.types import DirectionalLight, LightEstimate, TrackedFrame
from ashe_live.light.ground.lit_ground import GroundSteps, LitGround, fit_lit_ground
from ashe_live.light.pixels.log_colour import linear_rgb, log_opponent
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.predicted import outline, predicted, shadow_outline

# Told apart also by the colour-blind: Okabe and Ito's sky blue, orange, vermilion and bluish green, and with those
# a light yellow, as theirs is too near their orange.
OBJECT_BGR = (233, 180, 86)
SHADOW_BGR = (0, 159, 230)
UNEXPLAINED_BGR, UNSEEN_BGR = (0, 94, 213), (115, 158, 0)
LIGHT_BGR = (180, 248, 255)
PAPER_BGR, INK_BGR, FAINT_BGR = (28, 24, 22), (235, 235, 235), (150, 146, 140)
TINT = 0.6
COARSE_WIDTH_PX = 320
SURPRISING = 12.0  # squared Mahalanobis distance from the lit ground's colours
REACH_SHARE = 0.08  # of the picture's width: from how far around unlit areas are painted over
LEAST_LABELLED_PX = 100  # side of a rose with room for azimuths; twice that has room for elevations
SUBPIXEL_BITS = 4
# Squared radii, in sigmas, of the ellipses that hold a 2D normal distribution's sample with probability 0.68 and 0.95.
ELLIPSES = (-2 * math.log(1 - 0.68), -2 * math.log(1 - 0.95))


@dataclass(frozen=True, slots=True)
class DebugPicture:
    """One step."""

    title: str
    image_bgr: Image  # (h, w, 3)


def debug_pictures(tracked: TrackedFrame, estimate: LightEstimate, width_px: int = 640) -> list[DebugPicture]:
    """The steps of `estimate`, made from `tracked`, in the order in which they are taken; what was not made is missing.

    Raises ValueError when the frame has no marker.
    """
    if tracked.marker is None:
        raise ValueError("a frame without a marker has no marker frame to answer in")
    view = View.of(tracked, width_px)
    photo, camera, T_cam_marker = view.image_bgr, view.camera, view.T_cam_marker
    pictures = [DebugPicture("photo", photo), *_ground_pictures(tracked, estimate)]
    if estimate.object_mask is not None or estimate.shadow_mask is not None:
        pictures.append(DebugPicture("object and shadow", with_masks(photo, estimate)))
        pictures.append(DebugPicture("their outlines and hulls", _with_hulls(photo, estimate)))
    if estimate.caster is not None:
        fitted = with_body(photo, camera, T_cam_marker, estimate.caster, estimate.lights)
        pictures.append(DebugPicture(f"fitted {estimate.caster.family} and its shadow", fitted))
        rest = _with_residual(photo, view, estimate, estimate.caster)
        pictures.append(DebugPicture("red: not explained, green: not seen", rest))
    camera_marker = -T_cam_marker[:3, :3].T @ T_cam_marker[:3, 3]
    rose = light_rose(estimate.lights, min(photo.shape[:2]), camera_marker)
    said = "; ".join(light.said() for light in estimate.lights) or f"none: {estimate.reason}"
    pictures.append(DebugPicture(said, _centred(rose, photo.shape)))
    return pictures


def _ground_pictures(tracked: TrackedFrame, estimate: LightEstimate) -> list[DebugPicture]:
    """The lit ground as the estimator modelled it, which is at the masks' size, and how the picture differs."""
    masks = [mask for mask in (estimate.object_mask, estimate.shadow_mask) if mask is not None]
    view = View.of(tracked, masks[0].shape[1] if masks else COARSE_WIDTH_PX)
    ground = fit_lit_ground(view.image_bgr, view.is_ground, GroundSteps())
    if ground is None:
        return []
    lit = lit_ground_rgb(view.image_bgr, ground, view.is_ground)
    ratio = LINEAR_FROM_SRGB_8BIT[view.image_bgr[:, :, ::-1]] / lit
    return [DebugPicture("lit ground", _encoded(lit)), DebugPicture("ratio to lit ground", _encoded(ratio))]


def lit_ground_rgb(image_bgr: Image, ground: LitGround, is_ground: Mask) -> Float:
    """(h, w, 3) linear RGB: the picture as if nothing stood or fell on the ground, painted over from what is lit."""
    is_lit = (is_ground & (ground.surprise < SURPRISING)).astype(np.float32)[:, :, None]
    reach = (0, 0), REACH_SHARE * image_bgr.shape[1]
    near = cv2.GaussianBlur(np.concatenate([ground.colours * is_lit, is_lit], axis=2), *reach)
    around = near[:, :, :3] / np.maximum(near[:, :, 3:], 1e-6)
    field = log_opponent(image_bgr) - ground.colours
    return np.maximum(linear_rgb(np.where(is_lit > 0, ground.colours, around) + field), 1e-4)


def with_masks(picture_bgr: Image, estimate: LightEstimate) -> Image:
    """The picture, the estimate's masks stretched over it."""
    for mask, colour in ((estimate.shadow_mask, SHADOW_BGR), (estimate.object_mask, OBJECT_BGR)):
        if mask is not None:
            picture_bgr = _tinted(picture_bgr, _enlarged(mask, picture_bgr.shape), colour)
    return picture_bgr


def with_body(
    picture_bgr: Image, camera: Camera, T_cam_marker: Float, body: Proxy, lights: Sequence[DirectionalLight]
) -> Image:
    """The picture with the outlines of a body and of its shadows; `camera` is of its size, without distortion."""
    picture, points = picture_bgr.copy(), body.points_marker()
    for light in lights:
        _draw_outline(picture, shadow_outline(camera, T_cam_marker, points, light.to_light_marker), SHADOW_BGR)
    _draw_outline(picture, outline(camera, T_cam_marker, points), OBJECT_BGR)
    return picture


def light_rose(lights: Sequence[DirectionalLight], size_px: int, camera_marker: Float | None = None) -> Image:
    """(size, size, 3): the sky from above, zenith in the centre, horizon at the rim, the marker's x right and y up.

    Each light with its ellipses of 68 and 95 %; with `camera_marker` (3,), a triangle shows where one looks from.
    """
    font_px = max(9.0, size_px / 26)
    has_labels = size_px >= LEAST_LABELLED_PX
    radius = size_px / 2 - (2.6 if has_labels else 0.4) * font_px
    sheet = PillowImage.new("RGB", (size_px, size_px), PAPER_BGR[::-1])
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(font_px)
    faint, centre, line = FAINT_BGR[::-1], size_px / 2, max(1, size_px // 240)

    def at(direction: Float) -> tuple[float, float]:
        azimuth, elevation = angles_from_direction(direction)
        length = radius * (1 - elevation / (math.pi / 2))
        return centre + length * math.cos(azimuth), centre - length * math.sin(azimuth)

    for elevation_deg in (0, 30, 60):
        ring = radius * (1 - elevation_deg / 90)
        draw.circle((centre, centre), ring, outline=faint)
        if size_px >= 2 * LEAST_LABELLED_PX:
            draw.text((centre + 2, centre - ring), f"{elevation_deg}°", faint, font, anchor="la")
    for azimuth_deg in range(0, 360, 90):
        rim = direction_from_angles(math.radians(azimuth_deg), 0.0)
        draw.line((centre, centre, *at(rim)), faint)
        if has_labels:
            label = centre + (radius + 1.2 * font_px) * rim[0], centre - (radius + 1.2 * font_px) * rim[1]
            draw.text(label, f"{azimuth_deg}°", faint, font, anchor="mm")
    if camera_marker is not None:
        draw.regular_polygon((*at(camera_marker), 0.6 * font_px), 3, fill=faint)
    for light in lights:
        draw.line((centre, centre, *at(light.to_light_marker)), INK_BGR[::-1], line)
        draw.circle(at(light.to_light_marker), 1.5 * line, fill=INK_BGR[::-1])
        for squared in ELLIPSES if light.covariance_rad2 is not None else ():
            points = [at(direction) for direction in _ellipse(light, squared)]
            draw.line([*points, points[0]], SHADOW_BGR[::-1], line)
    return np.ascontiguousarray(np.asarray(sheet)[:, :, ::-1])


def _centred(picture_bgr: Image, shape: tuple[int, ...]) -> Image:
    """On a sheet of `shape`, so that all steps have one."""
    sheet = np.full(shape, PAPER_BGR, np.uint8)
    height, width = picture_bgr.shape[:2]
    top, left = (shape[0] - height) // 2, (shape[1] - width) // 2
    sheet[top : top + height, left : left + width] = picture_bgr
    return sheet


def _ellipse(light: DirectionalLight, squared_sigmas: float, around: int = 72) -> list[Float]:
    """Directions at that Mahalanobis distance from the light's."""
    assert light.covariance_rad2 is not None
    variances, axes = np.linalg.eigh(light.covariance_rad2)
    angles = np.arange(around) * (2 * math.pi / around)
    offsets = np.column_stack([np.cos(angles), np.sin(angles)]) * np.sqrt(np.maximum(variances, 0) * squared_sigmas)
    directions = []
    for offset in offsets @ axes.T:
        # Not past the nadir, where "farther" would come back up.
        length = min(float(np.hypot(*offset)), math.pi / 2)
        along = offset @ tangent_basis(light.to_light_marker) / max(float(np.hypot(*offset)), 1e-12)
        directions.append(math.cos(length) * light.to_light_marker + math.sin(length) * along)
    return directions


def _with_hulls(picture_bgr: Image, estimate: LightEstimate) -> Image:
    picture = picture_bgr.copy()
    for mask, colour in ((estimate.shadow_mask, SHADOW_BGR), (estimate.object_mask, OBJECT_BGR)):
        if mask is not None and mask.any():
            inside = _enlarged(mask, picture.shape).astype(np.uint8)
            contours, _ = cv2.findContours(inside, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
            cv2.drawContours(picture, contours, -1, colour, 1)
            _draw_outline(picture, cv2.convexHull(np.concatenate(contours))[:, 0].astype(np.float64), colour)
    return picture


def _with_residual(photo: Image, view: View, estimate: LightEstimate, body: Proxy) -> Image:
    """Where masks go beyond the body and its shadows, and where those should be seen and are not."""
    known = predicted(body, [light.to_light_marker for light in estimate.lights], view).whole
    masked = np.zeros(photo.shape[:2], np.bool_)
    for mask in (estimate.object_mask, estimate.shadow_mask):
        if mask is not None:
            masked |= _enlarged(mask, photo.shape)
    return _tinted(_tinted(photo, masked & ~known, UNEXPLAINED_BGR), known & ~masked & view.is_ground, UNSEEN_BGR)


def _draw_outline(picture_bgr: Image, points: Float | None, colour: tuple[int, int, int]) -> None:
    """A closed line, dark at its rim so that it shows on any ground."""
    if points is not None:
        line = max(1, picture_bgr.shape[1] // 320)
        for width, ink in ((line + 2, PAPER_BGR), (line, colour)):
            cv2.polylines(picture_bgr, [_fixed_point(points)], True, ink, width, cv2.LINE_AA, SUBPIXEL_BITS)


def _fixed_point(points: Float) -> np.ndarray[tuple[int, ...], np.dtype[np.int32]]:
    return np.asarray(np.round(points * 2**SUBPIXEL_BITS), dtype=np.int32)


def _tinted(picture_bgr: Image, inside: Mask, colour: tuple[int, int, int]) -> Image:
    blended = cv2.addWeighted(picture_bgr, 1 - TINT, np.full_like(picture_bgr, colour), TINT, 0)
    return np.where(inside[:, :, None], blended, picture_bgr).astype(np.uint8)


def _enlarged(mask: Mask, shape: tuple[int, ...]) -> Mask:
    """`mask` of any size, stretched over a picture of `shape`."""
    size = shape[1], shape[0]
    return cv2.resize(mask.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST).astype(bool)


def _encoded(linear: Float) -> Image:
    """(h, w, 3) sRGB BGR of linear RGB."""
    return np.ascontiguousarray((255 * srgb_from_linear(np.clip(linear, 0, 1)) + 0.5).astype(np.uint8)[:, :, ::-1])
