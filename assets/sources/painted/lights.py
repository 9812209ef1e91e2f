"""Suns and lamps: homogeneous points (4,), the unit vector towards them and one over their distance (0 for a sun)."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def direction(azimuth_deg: float, elevation_deg: float) -> Floats:
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)])


def seen_from(points: Floats, sun: Floats) -> Floats:
    """(n, 3) the vector from points (n, 3) to a light (4,), over the light's distance from the marker's centre."""
    return sun[:3] - sun[3] * points


def fall(points: Floats, sun: Floats) -> Floats:
    """(n,) one over the cube of that vector's length: with its part along a normal, the irradiance of a small light."""
    return np.asarray((seen_from(points, sun) ** 2).sum(axis=1) ** -1.5)


def lamp(sun: Floats, diameter_deg: float) -> dict:
    """What ground_truth.json says of a light's place, if it has one."""
    if sun[3] <= 0:
        return {}
    radius_m = math.tan(math.radians(diameter_deg) / 2) / sun[3]
    return {"lamp": {"position_m": (sun[:3] / sun[3]).tolist(), "radius_m": radius_m}}
