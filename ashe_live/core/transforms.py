"""Rigid transforms, directions on the sphere, and the one place where OpenCV's frames become OpenGL's.

Column vectors throughout; pyrr, which keeps the translation in the last row, is used and guarded here only.
"""

import math

import numpy as np
import pyrr
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera

# OpenCV's camera looks along +z with y down, OpenGL's along -z with y up.
T_gl_cam: Float = np.diag([1.0, -1.0, -1.0, 1.0])
T_gl_cam.flags.writeable = False
# A marker that is turned by more than this, or shifted by more than this share of its side, lies elsewhere.
ELSEWHERE_COS = math.cos(math.radians(1.0))
ELSEWHERE_SIDES = 0.03
# Squared Mahalanobis radii of the ellipses that hold a sample of a 2D normal distribution with probability 0.68, 0.95.
ELLIPSE_68, ELLIPSE_95 = -2 * math.log(1 - 0.68), -2 * math.log(1 - 0.95)


def rigid(R: ArrayLike, t: ArrayLike) -> Float:
    """(4, 4) from a rotation (3, 3) and a translation (3,), metres."""
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = np.asarray(t, dtype=np.float64).reshape(3)
    return T


def translated_and_scaled(offset: ArrayLike, scale: ArrayLike) -> Float:
    """(4, 4) that maps x to `scale * (x + offset)`, both (3,)."""
    matrix = np.diag([*np.asarray(scale, dtype=np.float64), 1.0])
    matrix[:3, 3] = matrix.diagonal()[:3] * np.asarray(offset, dtype=np.float64)
    return matrix


def inverse_rigid(T_a_b: Float) -> Float:
    """(4, 4) `T_b_a` of a rigid `T_a_b` (4, 4), without the rounding of a general inverse."""
    R = T_a_b[:3, :3].T
    return rigid(R, -R @ T_a_b[:3, 3])


def transform_points(T_a_b: Float, points_b: ArrayLike) -> Float:
    """(n, 3) points of frame b in frame a."""
    return np.asarray(points_b, dtype=np.float64) @ T_a_b[:3, :3].T + T_a_b[:3, 3]


def normalised(vector: ArrayLike) -> Float:
    """`vector` (n,) at length 1. Raises ValueError when it has no direction: at length 0, or where it is not finite."""
    array = np.asarray(vector, dtype=np.float64)
    length = math.hypot(*array.ravel())
    if not (math.isfinite(length) and length > 0):
        raise ValueError(f"{array} has no direction")
    # Twice, as dividing by a tiny or huge length loses precision.
    array = array / length
    return np.asarray(array / math.hypot(*array.ravel()))


def direction_from_angles(azimuth_rad: float, elevation_rad: float) -> Float:
    """(3,) unit vector; azimuth from x towards y, elevation from the xy plane towards z."""
    flat = math.cos(elevation_rad)
    return np.array([flat * math.cos(azimuth_rad), flat * math.sin(azimuth_rad), math.sin(elevation_rad)])


def angles_from_direction(direction: ArrayLike) -> tuple[float, float]:
    """Azimuth in [0, 2 pi) and elevation in [-pi/2, pi/2], radians, of a direction (3,); azimuth 0 straight overhead.

    Raises ValueError as `normalised` does.
    """
    x, y, z = normalised(direction)
    # Of -0.0 and 0.0, which a direction has where its sign was turned, atan2 makes half a turn.
    azimuth = math.atan2(y + 0.0, x + 0.0) % (2 * math.pi)
    # A tiny negative angle wraps to 2 pi itself in floating point.
    return (azimuth if azimuth < 2 * math.pi else 0.0), math.atan2(z, math.hypot(x, y))


def tangent_basis(direction: ArrayLike) -> Float:
    """(2, 3) orthonormal: towards larger azimuth, towards larger elevation, at `direction`."""
    azimuth, elevation = angles_from_direction(direction)
    east = (-math.sin(azimuth), math.cos(azimuth), 0.0)
    flat = math.sin(elevation)
    up = (-flat * math.cos(azimuth), -flat * math.sin(azimuth), math.cos(elevation))
    return np.array([east, up])


def on_tangent_basis(direction: ArrayLike, covariance_rad2: Float, near_by: ArrayLike) -> Float:
    """(2, 2) rad^2: on the tangent basis at `direction`, the covariance (2, 2) that is given on the one at `near_by`.

    It is carried along the great circle between them (parallel transport). Close to the zenith two bases are turned
    against each other by far more than their directions are apart.
    """
    (xx, xy), (yx, yy) = tangent_basis(direction) @ tangent_basis(near_by).T
    angle = math.atan2(yx - xy, xx + yy)  # of the nearest rotation
    turn = np.array([(math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))])
    return np.asarray(turn @ covariance_rad2 @ turn.T)


def radius_of_68_percent(covariance_rad2: Float) -> float:
    """Radius of the circle that holds a 2D normal distribution's sample with probability 0.68.

    Between 0.99 of the larger deviation (a line) and 1.51 of it (a circle); in between, and at both ends, right to 1 %.
    """
    smaller, larger = np.maximum(np.linalg.eigvalsh(covariance_rad2), 0.0)
    return min(math.sqrt(0.985 * larger + 1.326 * smaller), math.pi)  # no two directions are farther apart


def angle_between(a: ArrayLike, b: ArrayLike) -> float:
    """Radians between two directions, exact also where arccos is not (nearly parallel, nearly opposite)."""
    unit_a, unit_b = normalised(a), normalised(b)
    return 2 * math.atan2(float(np.linalg.norm(unit_a - unit_b)), float(np.linalg.norm(unit_a + unit_b)))


def motion_between(T_room_old: Float | None, T_room_new: Float | None) -> Float | None:
    """(4, 4) from the marker's frame where it lay to that where it lies; None if it has not been moved.

    Both as `TrackedFrame.T_room_marker`.
    """
    if T_room_old is None or T_room_new is None or T_room_old is T_room_new:
        return None
    return np.asarray(inverse_rigid(T_room_new) @ T_room_old)


def lies_elsewhere(T_room_old: Float | None, T_room_new: Float | None, side_m: float) -> bool:
    """Whether the marker has been moved by so much that what was seen on its plane no longer lies there.

    That is by 1 degree, or by 3 % of its side of `side_m`. Both poses as `TrackedFrame.T_room_marker`, (4, 4), metres.
    """
    motion = motion_between(T_room_old, T_room_new)
    if motion is None:
        return False
    is_turned = np.trace(motion[:3, :3]) < 1 + 2 * ELSEWHERE_COS
    return bool(is_turned or np.linalg.norm(motion[:3, 3]) > ELSEWHERE_SIDES * side_m)


def project(camera: Camera, T_cam_marker: Float, points_marker: ArrayLike) -> Float:
    """(n, 2) pixels of (n, 3) points in the marker frame, without distortion; NaN behind the camera."""
    points_cam = transform_points(T_cam_marker, points_marker)
    depth = np.where(points_cam[:, 2] > 0, points_cam[:, 2], np.nan)
    return np.asarray((points_cam / depth[:, None]) @ camera.K[:2].T)


def undistorted(camera: Camera, pixels: Float) -> Float:
    """(n, 2) where the pinhole camera with the same K sees what the frame as it came shows at pixels (n, 2).

    Any numbers for pixels whose distortion cannot be inverted.
    """
    if not camera.is_distorted:
        return pixels
    import cv2  # here, as everything loads this module, and OpenCV takes long to load

    # After its default of five iterations corners are half a pixel off.
    until = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-9)
    points = np.asarray(pixels, dtype=np.float64)[:, None]
    return np.asarray(cv2.undistortPoints(points, camera.K, camera.dist, None, None, camera.K, until)[:, 0])


def pixels_by_points(points_cam: Float, K: Float) -> Float:
    """(n, 2, 3) derivatives of the pixels of points (n, 3), camera frame, metres, by these; without distortion."""
    depth = points_cam[:, 2]
    by_points = np.empty((len(depth), 2, 3))
    by_points[:, :, :2] = K[:2, :2] / depth[:, None, None]
    by_points[:, :, 2] = -(points_cam[:, :2] @ K[:2, :2].T) / (depth * depth)[:, None]
    return by_points


def pixels_by_pose(turned: Float, points_cam: Float, K: Float) -> Float:
    """(n, 2, 6) derivatives of the pixels of points in front of the camera, without distortion, by its pose.

    By (w, v) on the camera's axes, rad and m, as of MarkerPose.covariance: R' = exp(w) R, t' = t + v. turned: the
    points (n, 3) of the marker's frame on the camera's axes, R p; points_cam: (n, 3) in its frame, R p + t; metres.
    """
    by_points = pixels_by_points(points_cam, K)
    # A turn w moves a turned point p by w x p. NumPy's cross product would take as long as all else.
    crosses = np.zeros((len(turned), 3, 3))
    crosses[:, 0, 1], crosses[:, 0, 2] = turned[:, 2], -turned[:, 1]
    crosses[:, 1, 0], crosses[:, 1, 2] = -turned[:, 2], turned[:, 0]
    crosses[:, 2, 0], crosses[:, 2, 1] = turned[:, 1], -turned[:, 0]
    return np.concatenate([by_points @ crosses, by_points], axis=2)


def camera_centre(T_cam_marker: Float) -> Float:
    """(3,) where the camera's centre is, marker frame."""
    return np.asarray(inverse_rigid(T_cam_marker)[:3, 3])


def view_direction(T_cam_marker: Float) -> Float:
    """(3,) unit vector from the marker's centre towards the camera, marker frame."""
    return normalised(camera_centre(T_cam_marker))


def image_from_plane(camera: Camera, T_cam_marker: Float) -> Float:
    """(3, 3) homography from the marker's plane, (x, y, 1) in metres, to undistorted pixels.

    The third coordinate that it gives is the depth in front of the camera, metres.
    """
    return np.asarray(camera.K @ T_cam_marker[:3, [0, 1, 3]])


def raycast_to_plane(camera: Camera, T_cam_marker: Float, pixels: ArrayLike) -> Float:
    """(n, 3) points where the rays through undistorted `pixels` (n, 2) meet the marker plane, in the marker frame.

    NaN where a ray runs parallel to the plane or meets it behind the camera.
    """
    homogeneous = np.column_stack([np.asarray(pixels, dtype=np.float64), np.ones(len(np.asarray(pixels)))])
    rays_cam = homogeneous @ np.linalg.inv(camera.K).T
    T_marker_cam = inverse_rigid(T_cam_marker)
    rays = rays_cam @ T_marker_cam[:3, :3].T
    centre = T_marker_cam[:3, 3]
    sinking = rays[:, 2] * np.sign(centre[2]) < -1e-12
    distance = np.where(sinking, -centre[2] / np.where(sinking, rays[:, 2], 1.0), np.nan)
    points = centre + distance[:, None] * rays
    points[sinking, 2] = 0.0
    return np.asarray(points)


def gl_projection(camera: Camera, near: float, far: float) -> Float:
    """(4, 4) clip from gl camera, such that OpenGL draws a point where OpenCV projects it.

    OpenCV's pixel centres are integers and OpenGL's are at halves, hence the + 0.5.
    """
    width, height = camera.size
    (fx, _, cx), (_, fy, cy), _ = camera.K
    return np.array(
        [
            [2 * fx / width, 0, 1 - 2 * (cx + 0.5) / width, 0],
            [0, 2 * fy / height, 2 * (cy + 0.5) / height - 1, 0],
            [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
            [0, 0, -1, 0],
        ]
    )


def light_view(to_light: Float) -> Float:
    """(4, 4) rotation into a light's frame: z towards the light, stable in azimuth also straight overhead."""
    eye = normalised(to_light)
    # pyrr's look_at divides by zero when the view direction is parallel to `up`.
    up = (0.0, 1.0, 0.0) if abs(eye[1]) < 0.9 else (1.0, 0.0, 0.0)
    look_at = np.asarray(pyrr.matrix44.create_look_at(eye, np.zeros(3), np.array(up)), dtype=np.float64).T
    return rigid(look_at[:3, :3], np.zeros(3))


def orthographic(lower: Float, upper: Float) -> Float:
    """(4, 4) clip from a light's frame, for the box between two corners (3,) of that frame (z towards the light)."""
    (left, bottom, back), (right, top, front) = lower, upper
    matrix = pyrr.matrix44.create_orthogonal_projection(left, right, bottom, top, -front, -back)
    return np.asarray(matrix, dtype=np.float64).T
