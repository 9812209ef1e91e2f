"""What a mirror standing on the marker would see, from one picture: the ground as it is, and a plausible sky.

The ground is known wherever the camera sees it. Of the sky only the light that it sends to the ground is known; its
pattern is the picture's own, strongly blurred and wrapped around the hemisphere (Khan, Reinhard, Fleming, Buelthoff,
"Image-based material editing", SIGGRAPH 2006: the eye accepts it), under the CIE's overcast gradient.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.transforms import transform_points
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.lights.cast_shadows import is_inside

LinearPicture = NDArray[np.float32]

# The ground's map reaches to the horizon: half of its radius is this many sides of the marker.
HALF_RADIUS_SIDES = 2.0
FARTHEST = 0.97  # of the map's radius
FEATHER = 0.1  # share of the picture's size along which its ground fades into the mean colour
READ_WIDTH_PX = 320  # the picture is reduced to about that before it is read
PATTERN_SIZE = (12, 9)  # texels of the blurred picture that the sky's pattern is made of
PATTERN_STRENGTH = 0.6  # 0: an even sky
NOWHERE: Float = np.zeros((0, 2))


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Two square maps, first row at -y."""

    ground: LinearPicture  # (s, s, 3) the picture's linear RGB; a point g of the plane is at g / (|g| + half_radius_m)
    half_radius_m: float
    sky: LinearPicture  # (s, s, 3) a factor of the mean sky; a direction d is at (d.x, d.y) / (1 + d.z)


def surroundings_of(
    tracked: TrackedFrame, size: int, ground_rgb: Float | None = None, covered: Float = NOWHERE
) -> Surroundings:
    """What a frame with a marker shows, in maps of `size` texels a side.

    ground_rgb: (3,) linear, the ground's colour where the picture does not show it; None: the mean of what it shows.
    covered: (n, 2) metres, marker frame, corners of a convex part of the ground that counts as not shown.

    Raises ValueError for a frame without a marker.
    """
    if tracked.marker is None:
        raise ValueError("without a marker nobody knows where the ground is")
    linear = _reduced_linear(tracked)
    half_radius_m = HALF_RADIUS_SIDES * tracked.marker.side_m
    return Surroundings(
        _ground(tracked, linear, size, half_radius_m, ground_rgb, covered), half_radius_m, _sky(tracked, linear, size)
    )


def even_surroundings(size: int, ground_rgb: Float) -> Surroundings:
    """Ground of one colour (3,), linear, under an overcast sky: where no picture is known."""
    return Surroundings(np.full((size, size, 3), ground_rgb, np.float32), 1.0, _sky_map(np.ones((size, size, 3))))


def _reduced_linear(tracked: TrackedFrame) -> LinearPicture:
    """(h, w, 3) linear RGB of the frame, about READ_WIDTH_PX wide."""
    image = tracked.frame.image_bgr
    factor = max(1, round(image.shape[1] / READ_WIDTH_PX))
    # In linear light, as it is light that adds up where a pattern is too fine to be seen.
    linear = cv2.LUT(image, LINEAR_FROM_SRGB_8BIT.astype(np.float32))
    reduced = cv2.resize(linear, None, fx=1 / factor, fy=1 / factor, interpolation=cv2.INTER_AREA)
    return np.asarray(reduced[..., ::-1], np.float32)


def _ground(
    tracked: TrackedFrame,
    linear: LinearPicture,
    size: int,
    half_radius_m: float,
    ground_rgb: Float | None,
    covered: Float,
) -> LinearPicture:
    """The ground of `Surroundings`; `ground_rgb` and `covered` as for `surroundings_of`."""
    at = _square(size)
    radius = np.linalg.norm(at, axis=2, keepdims=True)
    near = at * np.minimum(1.0, FARTHEST / np.maximum(radius, 1e-9))
    points = half_radius_m * near / (1 - np.linalg.norm(near, axis=2, keepdims=True))
    points = np.dstack([points, np.zeros((size, size))]).reshape(-1, 3)
    T_cam_marker = tracked.pose.T_cam_marker
    is_ahead = transform_points(T_cam_marker, points)[:, 2] > 1e-6
    pixels = np.full((len(points), 2), -1e6)
    pixels[is_ahead] = project_distorted(tracked.camera, T_cam_marker, points[is_ahead])
    share = ((pixels + 0.5) / tracked.frame.size).reshape(size, size, 2)
    seen = _read(linear, share)
    inside = np.clip(np.minimum(share, 1 - share).min(axis=2, keepdims=True) / FEATHER, 0, 1)
    if len(covered):
        inside = np.where(is_inside(covered, points[:, :2]).reshape(size, size, 1), 0.0, inside)
    mean = (seen * inside).sum(axis=(0, 1)) / max(float(inside.sum()), 1e-9) if ground_rgb is None else ground_rgb
    return np.asarray(seen * inside + mean * (1 - inside), dtype=np.float32)


def _sky(tracked: TrackedFrame, linear: LinearPicture, size: int) -> LinearPicture:
    directions, _ = _hemisphere(size)
    seen_from_camera = directions @ tracked.pose.T_cam_marker[:3, :3].T
    # What lies behind the camera is assumed to look like what lies in front of it.
    x, y, z = np.moveaxis(seen_from_camera, 2, 0)
    wrapped = 0.5 + 0.5 * np.dstack([x, y]) / (1 + np.abs(z))[..., None]
    pattern = np.asarray(cv2.resize(linear, PATTERN_SIZE, interpolation=cv2.INTER_AREA), dtype=np.float32)
    return _sky_map(_read(pattern, wrapped) + 1e-3)


def _sky_map(pattern: NDArray[np.floating]) -> LinearPicture:
    """(s, s, 3) a pattern's colours relative to their mean, under the CIE's overcast gradient."""
    directions, weight = _hemisphere(pattern.shape[0])
    sky = 1 + PATTERN_STRENGTH * (pattern / _mean(pattern, weight) - 1)
    sky *= 1 + 2 * directions[..., 2:]
    return np.asarray(sky / _mean(sky, weight), dtype=np.float32)


def _hemisphere(size: int) -> tuple[Float, Float]:
    """(size, size, 3) unit directions of the sky map's texels, and (size, size, 1) their weights on level ground."""
    at = _square(size)
    square = (at**2).sum(axis=2, keepdims=True)
    directions = np.dstack([2 * at, np.abs(1 - square)]) / (1 + square)
    # The map's areas in solid angle, times the cosine to level ground.
    return directions, np.where(square < 1, directions[..., 2:] * (2 / (1 + square)) ** 2, 0.0)


def _mean(values: NDArray[np.floating], weight: Float) -> Float:
    return np.asarray((values * weight).sum(axis=(0, 1)) / weight.sum())


def _square(size: int) -> Float:
    """(size, size, 2) x and y of a map's texels, in [-1, 1]."""
    steps = (np.arange(size) + 0.5) * (2 / size) - 1
    return np.dstack(np.meshgrid(steps, steps))


def _read(picture: LinearPicture, share: Float) -> LinearPicture:
    """(h, w, 3) at places (h, w, 2) in shares of width and height, (0, 0) the top left corner; beyond it its border."""
    height, width = picture.shape[:2]
    places = (np.clip(share, -1, 2) * (width, height) - 0.5).astype(np.float32)
    read = cv2.remap(picture, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(read, dtype=np.float32)


def blurred_levels(picture: LinearPicture) -> list[LinearPicture]:
    """The map and its halves down to four texels a side, each blurred as Gauss's pyramid does (Burt, Adelson 1983)."""
    levels = [picture]
    for _ in range(level_count(picture.shape[0]) - 1):
        levels.append(np.asarray(cv2.pyrDown(levels[-1]), dtype=np.float32))
    return levels


def level_count(size: int) -> int:
    return max(1, int(math.log2(size)) - 1)
