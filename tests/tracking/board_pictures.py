"""Pictures of flat prints through any lens, painted ray by ray: independent of OpenCV's projection of the corners."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid

GROUND = 110
SUPERSAMPLING = 2


@dataclass(frozen=True)
class Lens:
    """A camera and the ray of each of its (supersampled) pixels."""

    camera: Camera
    rays: Float32  # (h, w, 2) x/z and y/z

    @classmethod
    def of(cls, camera: Camera) -> "Lens":
        width, height = camera.size
        fine = camera.resized((width * SUPERSAMPLING, height * SUPERSAMPLING))
        columns, rows = np.meshgrid(np.arange(fine.size[0]), np.arange(fine.size[1]))
        pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(np.float64)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 60, 1e-10)
        rays = cv2.undistortPoints(pixels[:, None], fine.K, fine.dist, None, None, None, criteria)
        return cls(camera, rays.reshape(*fine.size[::-1], 2).astype(np.float32))

    def picture(
        self, print_grey: Image, T_cam_print: Float, unit_px: float, noise: float = 2.0, seed: int = 0
    ) -> Image:
        """(h, w) uint8: the print (y down, origin at its top left corner, `unit_px` pixels a unit) on a grey ground."""
        R, t = T_cam_print[:3, :3].astype(np.float32), T_cam_print[:3, 3].astype(np.float32)
        x, y = self.rays[..., 0], self.rays[..., 1]
        right, down, normal = (axis[0] * x + axis[1] * y + axis[2] for axis in R.T)  # of each ray, in the print's frame
        t_print = R.T @ t
        depth = t_print[2] / normal
        valid = (depth > 0) & np.isfinite(depth)
        maps = [
            np.where(valid, (depth * ray - offset) * np.float32(unit_px) - np.float32(0.5), np.float32(-1e6))
            for ray, offset in zip((right, down), t_print[:2], strict=True)
        ]
        fine = cv2.remap(print_grey, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=GROUND)
        grey = cv2.resize(fine, self.camera.size, interpolation=cv2.INTER_AREA).astype(np.float64)
        grey = cv2.GaussianBlur(grey, (0, 0), 0.6)
        grey += np.random.default_rng(seed).normal(0, noise, grey.shape)
        return np.asarray(grey.clip(0, 255), dtype=np.uint8)


def seen_from(distance: float, tilt_deg: float, towards_deg: float, centre: Float, at: Float, turn_deg: float) -> Float:
    """T_cam_print: the print's point `centre` (2,) on the ray `at` (2,) x/z, y/z, its far side tilted `towards_deg`."""
    axis = np.array((np.cos(np.radians(towards_deg)), np.sin(np.radians(towards_deg)), 0)) * np.radians(tilt_deg)
    turn = np.array((0.0, 0.0, np.radians(turn_deg)))
    R = cv2.Rodrigues(axis)[0] @ cv2.Rodrigues(turn)[0]
    t = distance * np.array((*at, 1.0)) - R @ np.array((*centre, 0.0))
    return rigid(R, t)
