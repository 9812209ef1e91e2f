"""Points and rays in a frame as the camera gave it, with the distortion of its lens."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project, undistorted


def project_distorted(camera: Camera, T_cam_marker: Float, points_marker: Float) -> Float:
    """(n, 2) pixels of points (n, 3) of the marker frame, metres, in the frame as it came; NaN behind the camera.

    The distortion's polynomials were fitted within the picture, and may fold back what lies far outside. So beyond the
    widest ray that the picture shows, a ray's tangent is scaled as the widest one's in the same direction.
    """
    pixels = project(camera, T_cam_marker, points_marker)
    if not camera.is_distorted:
        return pixels
    tangents = np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(camera.K)[:2].T
    share = np.minimum(1.0, _widest_tangent(camera) / np.maximum(np.linalg.norm(tangents, axis=1), 1e-12))[:, None]
    rays = np.column_stack([share * tangents, np.ones(len(tangents))])
    distorted = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), np.eye(3), camera.dist)[0].reshape(-1, 2)
    return np.asarray(np.column_stack([distorted / share, np.ones(len(rays))]) @ camera.K[:2].T)


def tangents_of_pixels(camera: Camera, pixels: Float) -> Float:
    """(n, 2) x / z and y / z, camera frame, of the rays that pixels (n, 2) of the frame as it came see."""
    straight = undistorted(camera, pixels)
    return np.asarray(np.column_stack([straight, np.ones(len(straight))]) @ np.linalg.inv(camera.K)[:2].T)


def rays_of_pixels(camera: Camera, T_cam_marker: Float, pixels: Float) -> Float:
    """(n, 3) vectors of depth 1, marker frame, along the rays that pixels (n, 2) of the frame as it came see."""
    tangents = tangents_of_pixels(camera, pixels)
    return np.asarray(np.column_stack([tangents, np.ones(len(tangents))]) @ T_cam_marker[:3, :3])


def _widest_tangent(camera: Camera) -> float:
    """The tangent of the largest angle between the optical axis and what the picture shows: that of a corner."""
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * camera.size - 0.5
    return float(np.linalg.norm(tangents_of_pixels(camera, corners), axis=1).max())
