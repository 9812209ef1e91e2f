"""What is known in the marker's frame, in that frame after it has moved: onto the ground below, or in the room."""

from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy, ProxyMesh
from ashe_live.core.ranges import INVERSE_DISTANCE
from ashe_live.core.transforms import inverse_rigid, tangent_basis, transform_points
from ashe_live.core.types import TrackedFrame


def moved_light(light: Light, T_new_old: Float) -> Light:
    """The light with its covariances by the new frame; T_new_old (4, 4): rigid, metres.

    A lamp is as large as it is seen from there; its brightness stays that at the old frame's origin.
    """
    turn, shift = T_new_old[:3, :3], T_new_old[:3, 3]
    there = turn @ light.to_light_marker + light.inverse_distance * shift
    distance = float(np.linalg.norm(there))
    if light.inverse_distance > INVERSE_DISTANCE.high * distance:  # the frame was moved into the lamp
        shift, there, distance = np.zeros(3), turn @ light.to_light_marker, 1.0
    to_light = there / distance
    nearness = light.inverse_distance / distance
    # (3, 3) derivatives of the new direction, on its tangent basis, and inverse distance by the old ones.
    moves = np.column_stack([turn @ tangent_basis(light.to_light_marker).T, shift]) / distance
    by_old = np.vstack([tangent_basis(to_light) @ moves, -nearness * (to_light @ moves)])
    by_old[2, 2] += 1 / distance
    covariance, lamp_covariance = light.covariance_rad2, light.lamp_covariance
    if lamp_covariance is not None:
        lamp_covariance = _propagated(lamp_covariance, by_old)
    if covariance is not None:
        # A lamp's direction is also as uncertain as its distance makes it at another place.
        covariance = _propagated(covariance, by_old[:2, :2]) if lamp_covariance is None else lamp_covariance[:2, :2]
    moved = light.elsewhere(to_light, nearness)
    return replace(moved, covariance_rad2=covariance, lamp_covariance=lamp_covariance)


def moved_body(body: Proxy, T_new_old: Float) -> Proxy:
    """The body by the new frame, in which its spheroids must stand as upright; T_new_old (4, 4): rigid, metres."""
    spheroids = body.spheroids_marker.copy()
    spheroids[:, :3] = transform_points(T_new_old, spheroids[:, :3])
    mesh = body.mesh and ProxyMesh(transform_points(T_new_old, body.mesh.points_marker), body.mesh.triangles)
    return Proxy(body.family, spheroids, mesh)


def with_moved_marker(tracked: TrackedFrame, T_new_old: Float) -> TrackedFrame:
    """The frame, which must have a marker, with the pose of the new frame in it; T_new_old (4, 4): rigid, metres."""
    marker = tracked.pose
    T_cam_new = marker.T_cam_marker @ inverse_rigid(T_new_old)
    # A turn by which the pose is off is one about the old origin, and shifts the new one.
    by_old, (x, y, z) = np.eye(6), T_cam_new[:3, 3] - marker.T_cam_marker[:3, 3]
    by_old[3:, :3] = (0, z, -y), (-z, 0, x), (y, -x, 0)
    covariance, noise = (
        None if each is None else _propagated(each, by_old) for each in (marker.covariance, marker.noise_covariance)
    )
    return replace(
        tracked, marker=replace(marker, T_cam_marker=T_cam_new, covariance=covariance, noise_covariance=noise)
    )


def _propagated(covariance: Float, slope: Float) -> Float:
    """To first order, the covariance (m, m) of what changes by `slope` (m, n) with what has `covariance` (n, n)."""
    spread = slope @ covariance @ slope.T
    return np.asarray(0.5 * (spread + spread.T))
