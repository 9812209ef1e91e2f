"""A sight: a camera with its pose, as it sees bodies. Bodies are independent of it: many sights may see one body."""

from dataclasses import dataclass, field

import numpy as np

from ashe_live.core.arrays import Float, once_for_each
from ashe_live.core.camera import Camera
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import BodyFrame


@dataclass(frozen=True, eq=False)
class Sight:
    """A camera without distortion, its pose, and the origin of pixel coordinates."""

    camera: Camera
    T_cam_marker: Float  # (4, 4)
    centre_px: Float = field(default_factory=lambda: np.zeros(2))  # (2,) origin of pixels, near the object

    @staticmethod
    def of(view: View) -> "Sight":
        """The sight of a view, its pixels counted from the picture's corner."""
        return Sight(view.camera, view.T_cam_marker)

    @property
    def P_marker(self) -> Float:
        """(3, 4) projection from the marker frame to pixels about `centre_px`."""
        P = self.camera.K @ self.T_cam_marker[:3]
        P[:2] -= self.centre_px[:, None] * P[2]
        return np.asarray(P)

    @once_for_each
    def P(self, frame: BodyFrame) -> Float:
        """(3, 4) projection from a body frame to pixels about `centre_px`."""
        P = self.P_marker
        in_body_frame = frame.unit_m * P
        in_body_frame[:, 3] = P[:, :2] @ frame.origin_marker + P[:, 3]
        return np.asarray(in_body_frame)
