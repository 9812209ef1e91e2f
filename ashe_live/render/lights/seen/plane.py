"""The marker's plane around a shadow, rectified from a picture."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.transforms import camera_centre
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted, rays_of_pixels

SHEET = 2.0  # assumed side of the marker's sheet, over that of its square, on which nothing is found
OBJECT_PX = 3  # around the body in the picture, where the object itself may be


@dataclass(frozen=True, slots=True, eq=False)
class PlaneInPicture:
    """A part of the marker's plane as a picture shows it."""

    bounds: Float  # (4,) lower x, y and upper x, y, metres
    texel_m: float
    size: float  # the root of the area of the body's shadow as far as it is seen, texels
    pixels: NDArray[np.float32]  # (h, w, 2) where its texels are in the picture
    linear_rgb: NDArray[np.float32]  # (h, w, 3)

    @staticmethod
    def around(seen_in: TrackedFrame, hull: Float, margin: float, most_texels: int) -> "PlaneInPicture | None":
        """Around what is seen of a convex polygon (n, 2), metres; None where that is too little.

        `margin`: of the ground around it, over the root of its area. `most_texels`: a side has, else as many as pixels.
        """
        camera, T_cam_marker = seen_in.camera, seen_in.pose.T_cam_marker
        corners = np.column_stack([hull, np.zeros(len(hull))])
        if len(hull) < 3 or (corners @ T_cam_marker[2, :3] + T_cam_marker[2, 3]).min() <= 1e-3:
            return None
        width, height = seen_in.frame.size
        picture = np.array([(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)], np.float32)
        outline = cv2.convexHull(project_distorted(camera, T_cam_marker, corners).astype(np.float32))
        area_px, visible = cv2.intersectConvexConvex(outline, picture)
        if visible is None or area_px < 25:
            return None
        on_plane = _ground_at(seen_in, visible.reshape(-1, 2).astype(np.float64))
        area_m2 = abs(cv2.contourArea(on_plane.astype(np.float32)))
        beyond = margin * np.sqrt(area_m2)
        lower, upper = on_plane.min(axis=0) - beyond, on_plane.max(axis=0) + beyond
        texel_m = max(np.sqrt(area_m2 / area_px), (upper - lower).max() / most_texels)
        count = np.maximum(np.ceil((upper - lower) / texel_m), 2).astype(int)
        upper = lower + count * texel_m
        axes = (low + (np.arange(n) + 0.5) * texel_m for low, n in zip(lower, count, strict=True))
        texels = np.stack([*np.meshgrid(*axes), np.zeros(count[::-1])], axis=2).reshape(-1, 3)
        in_front = texels @ T_cam_marker[2, :3] + T_cam_marker[2, 3] > 1e-3
        texels = np.where(in_front[:, None], texels, corners[0])
        at = project_distorted(camera, T_cam_marker, texels)
        at = np.where(in_front[:, None], at, -1e4).reshape(*count[::-1], 2)
        pixels = np.asarray(at, np.float32)
        blur_px = 0.5 * texel_m / np.sqrt(area_m2 / area_px)
        image = seen_in.frame.image_bgr
        blurred = cv2.GaussianBlur(image, (0, 0), blur_px) if blur_px > 0.75 else image
        x, y = pixels[..., 0], pixels[..., 1]
        colours = cv2.remap(blurred, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        linear = np.asarray(LINEAR_FROM_SRGB_8BIT[colours[..., ::-1]], np.float32)
        size = float(np.sqrt(area_m2) / texel_m)
        return PlaneInPicture(np.array([*lower, *upper]), float(texel_m), size, pixels, linear)

    def within(self, polygon: Float) -> Mask:
        """(h, w) what a convex polygon (n, 2), metres, covers."""
        mask = np.zeros(self.pixels.shape[:2], np.uint8)
        at = (polygon - self.bounds[:2]) / self.texel_m - 0.5
        cv2.fillConvexPoly(mask, np.round(np.clip(at, -1e4, 1e4)).astype(np.int32), 1)
        return mask.astype(bool)

    def from_other(self, other: "PlaneInPicture", mask: Mask) -> Mask:
        """(h, w) of a mask of another part of the plane, or of the same in other texels."""
        height, width = self.pixels.shape[:2]
        first = (self.bounds[:2] - other.bounds[:2] + 0.5 * self.texel_m) / other.texel_m - 0.5
        to_other = np.column_stack([np.eye(2) * self.texel_m / other.texel_m, first])
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        values = cv2.warpAffine(
            mask.astype(np.float32), to_other, (width, height), flags=flags, borderMode=cv2.BORDER_REPLICATE
        )
        return np.asarray(values > 0.5)

    def hidden(self, seen_in: TrackedFrame, points: Float) -> Mask:
        """(h, w) what the picture does not show, what a body of points (n, 3) hides there, and the marker's sheet."""
        T_cam_marker = seen_in.pose.T_cam_marker
        shown = np.zeros(seen_in.frame.image_bgr.shape[:2], np.uint8)
        shown[1:-1, 1:-1] = 1
        corners = seen_in.pose.corners_px
        sheet = corners.mean(axis=0) + SHEET * (corners - corners.mean(axis=0))
        for outline in (project_distorted(seen_in.camera, T_cam_marker, points), sheet):
            cv2.fillConvexPoly(shown, cv2.convexHull(np.round(np.clip(outline, -1e4, 1e4)).astype(np.int32)), 0)
        kernel = np.ones((2 * OBJECT_PX + 1, 2 * OBJECT_PX + 1), np.uint8)
        shown = np.asarray(cv2.erode(shown, kernel), np.uint8)
        at = self.pixels
        return np.asarray(cv2.remap(shown, at[..., 0], at[..., 1], cv2.INTER_NEAREST, borderValue=0) == 0)


def _ground_at(seen_in: TrackedFrame, pixels: Float) -> Float:
    """(n, 2) metres, where the rays of pixels (n, 2) meet the marker's plane."""
    T_cam_marker = seen_in.pose.T_cam_marker
    rays, eye = rays_of_pixels(seen_in.camera, T_cam_marker, pixels), camera_centre(T_cam_marker)
    return np.asarray((eye - rays * (eye[2] / rays[:, 2:]))[:, :2])
