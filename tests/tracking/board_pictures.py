"""Pictures of flat prints through any lens, painted ray by ray: independent of OpenCV's projection of the corners."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid

GROUND = 110
SUPERSAMPLING = 2


@dataclass(frozen=True)
class Lens:
    """A camera and the ray of each of its (supersampled) pixels."""

    camera: Camera
    rays: Float  # (h, w, 2) x/z and y/z

    @classmethod
    def of(cls, camera: Camera) -> "Lens":
        width, height = camera.size
        fine = camera.resized((width * SUPERSAMPLING, height * SUPERSAMPLING))
        columns, rows = np.meshgrid(np.arange(fine.size[0]), np.arange(fine.size[1]))
        pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(np.float64)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 60, 1e-10)
        rays = cv2.undistortPoints(pixels[:, None], fine.K, fine.dist, None, None, None, criteria)
        return cls(camera, rays.reshape(*fine.size[::-1], 2))

    def picture(
        self, print_grey: Image, T_cam_print: Float, unit_px: float, noise: float = 2.0, seed: int = 0
    ) -> Image:
        """(h, w) uint8: the print (y down, origin at its top left corner, `unit_px` pixels a unit) on a grey ground."""
        R, t = T_cam_print[:3, :3], T_cam_print[:3, 3]
        x, y = self.rays[..., 0], self.rays[..., 1]
        normal = R[:, 2]
        depth = (normal @ t) / (normal[0] * x + normal[1] * y + normal[2])
        points = np.stack([x * depth, y * depth, depth], axis=-1) - t
        across, down = points @ R[:, 0], points @ R[:, 1]
        valid = (depth > 0) & np.isfinite(depth)
        maps = [np.where(valid, one * unit_px - 0.5, -1e6).astype(np.float32) for one in (across, down)]
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
