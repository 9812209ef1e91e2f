"""Shading: whether the object is lit as the fitted body would be in the light that its shadow tells of."""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import inverse_rigid, project
from ashe_live.light.areas import shrunk
from ashe_live.light.log_colour import Float32
from ashe_live.light.predicted import SUBPIXEL_BITS
from ashe_live.light.regions import Region

AROUND, UPWARDS = 16, 9
BOUNCE = 0.3  # of the ground's light that comes back from it
DARKEST = 0.02
LOWEST_Z = 0.1
FARTHEST_PX = 1e5
LEAST_PX = 30
LEAST_SPREAD = 1e-3


def agreement(region: Region, body: Mask, proxy: Proxy, to_lights_marker: list[Float], left_over: list[float]) -> float:
    """Correlation of log brightness over the object with a Lambertian body's; 0 where either hardly varies.

    `left_over`: of the ground's light, in each light's shadow.
    """
    expected = _irradiance(region, proxy, to_lights_marker, left_over)
    core = shrunk(body, 1) & region.is_ground & (expected > 0)
    if np.count_nonzero(core) <= LEAST_PX:
        return 0.0
    return correlation(np.log(expected[core] + DARKEST), region.colours[..., 0][core])


def correlation(one: Float | Float32, other: Float | Float32) -> float:
    """Pearson's, of n numbers each; 0 where either hardly varies."""
    a, b = (values - values.mean(dtype=np.float64) for values in (one, other))
    variances = float(a @ a) / len(a), float(b @ b) / len(b)
    return float(a @ b) / len(a) / math.sqrt(variances[0] * variances[1]) if min(variances) >= LEAST_SPREAD**2 else 0.0


def _irradiance(region: Region, proxy: Proxy, to_lights_marker: list[Float], left_over: list[float]) -> Float32:
    """(h, w) of the body's surface, in units of lit level ground's; 0 where it is not."""
    view = region.view
    points, triangles = proxy.surface(AROUND, UPWARDS)
    first, second, third = points[triangles.T]
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1)
    eye = inverse_rigid(view.T_cam_marker)[:3, 3]
    pixels = project(view.camera, view.T_cam_marker, points)[triangles]
    in_view = np.isfinite(pixels).all(axis=(1, 2)) & (np.abs(np.nan_to_num(pixels)).max(axis=(1, 2)) < FARTHEST_PX)
    front = (lengths > 1e-9 * lengths.max()) & (((eye - first) * normals).sum(axis=1) > 0) & in_view
    normals = normals[front] / lengths[front, None]
    up = normals[:, 2]
    sky = 1 - sum(1 - left for left in left_over)
    irradiance = max(sky, 0.0) * (1 + up) / 2 + BOUNCE * (1 - up) / 2
    for to_light, left in zip(to_lights_marker, left_over, strict=True):
        irradiance += (1 - left) / max(to_light[2], LOWEST_Z) * np.maximum(normals @ to_light, 0)
    picture = np.zeros(view.is_ground.shape, np.float32)
    corners = np.round(pixels[front] * 2**SUBPIXEL_BITS).astype(np.int32)
    # Neighbours share the pixels of their edge: the brighter one gets them, whichever way the marker is turned.
    for index in np.argsort(irradiance):
        cv2.fillConvexPoly(picture, corners[index], float(irradiance[index]), shift=SUBPIXEL_BITS)
    return picture
