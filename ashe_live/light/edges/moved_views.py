"""Lets a view's pose move with what is aligned in it: around the pose measured by its marker, within its covariance.

A marker that is small in the picture leaves the camera's tilt uncertain by half a degree, and rolling shutters and
focal lengths that breathe bend it by more. What stands on the plane is then misplaced by other pixels in each view, so
that no one body fits them all. Poses are nuisance parameters of the joint fit, as in bundle adjustment (Triggs et al.,
"Bundle adjustment: a modern synthesis", 2000), with what the tracker says of them as their prior (docs/maths, "One
body in all views").
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import camera_centre, pixels_by_pose, rigid
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE, POINTS_PER_OUTLINE
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody

HIGHEST = 0.9  # of a point on a body below the camera, over the camera's height


def pose_offset(view: View) -> Float:
    """(6,) the (w, v) by which the view's pose has been moved from the measured one."""
    assert view.measured is not None
    turned, _ = cv2.Rodrigues(view.T_cam_marker[:3, :3] @ view.measured.T_cam_marker[:3, :3].T)
    return np.append(turned.ravel(), view.T_cam_marker[:3, 3] - view.measured.T_cam_marker[:3, 3])


def pose_cost(view: View) -> float:
    """How far the view's pose has been moved, in squared standard deviations; 0 where it is exact."""
    covariance = view.pose_covariance
    if covariance is None:
        return 0.0
    offset = pose_offset(view)
    return float(offset @ np.linalg.solve(covariance, offset))


def moved_view(view: View, step: Float) -> View:
    """The view with its pose moved by (w, v), (6,)."""
    turn, _ = cv2.Rodrigues(step[:3])
    pose = rigid(np.asarray(turn) @ view.T_cam_marker[:3, :3], view.T_cam_marker[:3, 3] + step[3:])
    return replace(view, T_cam_marker=pose)


@dataclass(frozen=True, slots=True)
class PoseEquations:
    """The normal equations of a view's pose (w, v) by a body's borders there, the prior included."""

    normal: Float  # (6, 6)
    gradient: Float  # (6,)
    mixed: Float  # (split + q, 6) of theta and the pose

    @staticmethod
    def of(
        lit: LitBody, view: View, places: tuple[Float, Float], by_theta: Float, weight: Float, offset_px: Float
    ) -> "PoseEquations | None":
        """Of r = (1 + l) p points on the outlines of a body and its shadows; None where the view's pose is exact.

        places: (r, 2) the points, and outward normals. by_theta: (split + q, r) derivatives of their movement. weight:
        (r,) information of their borders. offset_px: (r,) how far outside of them these are.
        """
        covariance = view.pose_covariance
        if covariance is None:
            return None
        by_pose = _derivatives_by_pose(lit, view, *places)
        weighted = by_pose * weight
        # Points are counted one by one, though neighbours' errors are correlated, and by their own variances, though a
        # body that is no good model misses them by more; so the prior counts as often.
        squares = (weight * offset_px**2)[weight > 0]
        prior = (
            BORDERS_PER_SAMPLE * max(float(squares.mean()) if squares.size else 1.0, 1.0) * np.linalg.inv(covariance)
        )
        return PoseEquations(
            weighted @ by_pose.T + prior, weighted @ offset_px - prior @ pose_offset(view), by_theta @ weighted.T
        )

    def marginalised(self, normal: Float, gradient: Float) -> tuple[Float, Float]:
        """Theta's normal matrix (..., split + q, split + q) and gradient, less what they lose to the unknown pose."""
        by_theta = np.linalg.solve(self.normal, self.mixed.T).T
        return normal - by_theta @ self.mixed.T, gradient - by_theta @ self.gradient

    def step(self, of_theta: Float) -> Float:
        """(6,) of the pose, along with a step of theta."""
        return np.asarray(np.linalg.solve(self.normal, self.gradient - self.mixed.T @ of_theta))


def _derivatives_by_pose(lit: LitBody, view: View, points: Float, normals: Float) -> Float:
    """(6, r) derivatives by (w, v) of the outward movement of the r = (1 + l) p points on a body's outlines.

    A shadow's points lie on the plane. The body's lie about where their rays pass the vertical line through its frame's
    origin.
    """
    pose, eye = view.T_cam_marker, camera_centre(view.T_cam_marker)
    rays = np.column_stack([points, np.ones(len(points))]) @ np.linalg.inv(view.camera.K).T
    onward = rays @ pose[:3, :3]
    towards = lit.body.frame.origin_marker - eye[:2]
    body = onward[:POINTS_PER_OUTLINE]
    along = body[:, :2] @ towards
    # A ray across the way to that line, as straight below the camera, passes it nowhere.
    beside_line = (towards @ towards) / np.where(np.abs(along) > 1e-9, along, np.inf)
    highest = min(2 * lit.body.middle_m, HIGHEST * eye[2])
    height = np.zeros(len(points))
    height[:POINTS_PER_OUTLINE] = np.clip(eye[2] + beside_line * body[:, 2], 0.0, highest)
    depth = (height - eye[2]) / np.minimum(onward[:, 2], -1e-6)
    turned = (eye + depth[:, None] * onward) @ pose[:3, :3].T
    by_pose = pixels_by_pose(turned, turned + pose[:3, 3], view.camera.K)
    return np.asarray(np.einsum("rc,rcp->pr", normals, by_pose))
