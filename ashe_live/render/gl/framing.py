"""The video's viewport in the framebuffer, and the projection of the marker frame into it."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, box_corners
from ashe_live.core.camera import Camera, Size
from ashe_live.core.transforms import T_gl_cam, camera_centre, gl_projection, transform_points
from ashe_live.models.placement import PlacedModel, Placement

Rectangle = tuple[int, int, int, int]  # left, bottom, width, height in pixels of the framebuffer
EMPTY: Rectangle = (0, 0, 0, 0)

# A depth buffer of 24 bits resolves a thousandth of the nearest distance well beyond this ratio.
MAX_FAR_OVER_NEAR = 1000.0


@dataclass(frozen=True, slots=True, eq=False)
class Framing:
    """How the marker frame maps to the framebuffer, for one pose."""

    viewport: Rectangle  # where the video is
    region: Rectangle  # the part of it that the framed points span
    clip_from_marker: Float  # (4, 4)
    eye_marker: Float  # (3,) metres, the camera's centre in the marker frame

    @property
    def ground_from_pixel(self) -> Float:
        """(3, 3) homography from the framebuffer's pixels, middles at halves, to the plane z = 0; metres, marker frame.

        Its third coordinate is positive in front of the camera. The camera must not be in that plane.
        """
        left, bottom, width, height = self.viewport
        x, y, _, w = self.clip_from_marker[:, [0, 1, 3]]
        pixel_from_ground = [width / 2 * (x + w) + left * w, height / 2 * (y + w) + bottom * w, w]
        return np.asarray(np.linalg.inv(np.array(pixel_from_ground)))


def letterbox(video: Size, framebuffer: Size) -> Rectangle:
    """The largest centred rectangle of the video's aspect ratio."""
    scale = min(framebuffer[0] / video[0], framebuffer[1] / video[1])
    width, height = (min(limit, max(1, round(side * scale))) for side, limit in zip(video, framebuffer, strict=True))
    return (framebuffer[0] - width) // 2, (framebuffer[1] - height) // 2, width, height


def framing(camera: Camera, T_cam_marker: Float, points_marker: Float, viewport: Rectangle) -> Framing | None:
    """The framing whose near and far planes enclose `points_marker` (n, 3); None when the camera sees none of them."""
    depths = transform_points(T_cam_marker, points_marker)[:, 2]
    far = 1.1 * float(depths.max())
    if far <= 0:
        return None
    near = max(0.9 * float(depths.min()), far / MAX_FAR_OVER_NEAR)
    clip_from_marker = gl_projection(camera, near, far) @ T_gl_cam @ T_cam_marker
    region = viewport
    if depths.min() >= near:
        region = _spanned(clip_from_marker, points_marker, viewport)
    if min(region[2:]) <= 0:
        return None
    return Framing(viewport, region, clip_from_marker, camera_centre(T_cam_marker))


def corners_of(placed: PlacedModel, placement: Placement) -> Float:
    """(8, 3) of the box around a model where it stands, metres, marker frame."""
    return transform_points(placement.marker_from_placed, box_corners(placed.bounds))


def grown(rectangle: Rectangle, margin: int, size: Size) -> Rectangle:
    """The rectangle grown by `margin` pixels on each side, within a framebuffer of `size`; an empty one stays empty."""
    left, bottom, width, height = rectangle
    if min(width, height) <= 0:
        return rectangle
    x0, y0 = max(0, left - margin), max(0, bottom - margin)
    x1, y1 = min(size[0], left + width + margin), min(size[1], bottom + height + margin)
    return x0, y0, x1 - x0, y1 - y0


def corner_pixels(rectangle: Rectangle) -> dict[str, tuple[int, int]]:
    """The rectangle's lower left pixel `first` and its upper right one `last`, as shaders that keep within it ask."""
    left, bottom, width, height = rectangle
    return {"first": (left, bottom), "last": (left + width - 1, bottom + height - 1)}


def common(some: Rectangle, other: Rectangle) -> Rectangle:
    """The intersection of two rectangles; its width or height is 0 if it is empty."""
    left, bottom = max(some[0], other[0]), max(some[1], other[1])
    right, top = min(some[0] + some[2], other[0] + other[2]), min(some[1] + some[3], other[1] + other[3])
    return left, bottom, max(0, right - left), max(0, top - bottom)


def disjoint(some: Rectangle, other: Rectangle) -> list[Rectangle]:
    """Rectangles that hold both and share no pixel: the two, or, if they overlap, the one that spans both.

    `other` is left out if it is empty.
    """
    if min(other[2:]) <= 0:
        return [some]
    if min(common(some, other)[2:]) <= 0:
        return [some, other]
    left, bottom = min(some[0], other[0]), min(some[1], other[1])
    right, top = max(some[0] + some[2], other[0] + other[2]), max(some[1] + some[3], other[1] + other[3])
    return [(left, bottom, right - left, top - bottom)]


def _spanned(clip_from_marker: Float, points: Float, viewport: Rectangle) -> Rectangle:
    """The pixels of `viewport` that the hull of points in front of the camera can touch; empty outside it."""
    clip = np.column_stack([points, np.ones(len(points))]) @ clip_from_marker.T
    left, bottom, width, height = viewport
    pixels = (clip[:, :2] / clip[:, 3:] + 1) / 2 * (width, height)
    lower = np.clip(np.floor(pixels.min(axis=0)) - 1, 0, (width, height))
    upper = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, (width, height))
    (x0, y0), (x1, y1) = lower, upper
    return left + math.floor(x0), bottom + math.floor(y0), math.floor(x1 - x0), math.floor(y1 - y0)
