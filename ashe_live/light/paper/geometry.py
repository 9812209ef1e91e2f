"""The AShE paper's geometry: from the centres of object and shadow in the picture to a direction in 3D.

Source: "A Shadow Estimator for Augmented Reality Systems on Mobile Platforms" (AShE). The virtual object is a cube
that stands on the marker's centre, its edge the marker's side. Pixels are undistorted unless stated otherwise.
"""

import math

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import normalised, project, raycast_to_plane


def cube_corners(side_m: float) -> Float:
    """AShE, virtual object: (8, 3) corners of the cube in the marker frame."""
    half = side_m / 2
    return np.array([[x, y, z] for z in (0.0, side_m) for y in (-half, half) for x in (-half, half)])


def cube_centre(side_m: float) -> Float:
    """AShE, virtual object: (3,) the cube's centre in the marker frame."""
    return np.array([0.0, 0.0, side_m / 2])


def real_to_virtual_scale(virtual_area_px: float, object_area_px: float) -> float:
    """AShE, scale between the real and the virtual object.

    Open: whether of lengths or areas. It multiplies a length, so it is a ratio of lengths: the root of that of areas.
    """
    return math.sqrt(virtual_area_px / object_area_px)


def virtual_shadow_centre(object_px: Float, shadow_px: Float, virtual_px: Float, scale: float) -> Float:
    """AShE, the shadow's vector brought to the virtual object: (2,) pixels.

    Open: the centre of the scaling. The vector starts in the object's centre, so it is scaled about that, then moved.
    """
    return np.asarray(virtual_px + scale * (shadow_px - object_px))


def to_light_from_centres(
    camera: Camera, T_cam_marker: Float, side_m: float, object_px: Float, shadow_px: Float, scale: float
) -> Float | None:
    """AShE, light direction: (3,) unit vector towards the light, marker frame; None when the ray misses the plane.

    The shadow's centre, brought to the virtual cube, is cast onto the marker plane; the light comes from there to the
    cube's centre. Open: the virtual object's centre of mass in the picture is the projection of the cube's centre.
    """
    centre = cube_centre(side_m)
    virtual_px = project(camera, T_cam_marker, centre[None])[0]
    pixel = virtual_shadow_centre(object_px, shadow_px, virtual_px, scale)
    shadow_point = raycast_to_plane(camera, T_cam_marker, pixel[None])[0]
    if not np.isfinite(shadow_point).all():
        return None
    return normalised(centre - shadow_point)
