"""The ground hidden and shaded by the body that the marker is printed on, as the paper cube.

It is covered where a model is to stand in the body's place.
"""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angles_from_direction, camera_centre, direction_from_angles
from ashe_live.core.types import Illumination, MarkerPose
from ashe_live.render.cover.rectified import in_square
from ashe_live.render.lights.cast_shadows import shadow_hull_of_point

# A cover is kept while the camera turns by less than TURNED_RAD; it is made to reach far enough for MARGIN_RAD.
TURNED_RAD = math.radians(8.0)
MARGIN_RAD = math.radians(10.0)
NEARER = 0.65  # share of the camera's distance at which the cover still hides the body
LOWEST_RAD = math.radians(15.0)  # least elevation of the camera: from lower, the body hides ground without end
MOST_HALF_SIDES = 6.0  # limit of half of the side of the square of ground that is examined, in sides of the marker
AROUND_SIDES = 0.6  # width of the ground around the hidden and shaded part, from which that is filled
FOOT_SIDES = 0.5  # width of the ground around the body's foot that is darkened, as the body hides much of its sky


def half_of_square(marker: MarkerPose, body: Proxy, illumination: Illumination) -> float:
    """Metres from the marker's centre: half of a square that holds all that the body hides or shades, and some more."""
    corners = np.concatenate([_hidden(body, eye) for eye in _eyes(marker, MARGIN_RAD)] + _shaded(body, illumination))
    most = float(np.abs(corners).max()) + AROUND_SIDES * marker.side_m
    return min(most, MOST_HALF_SIDES * marker.side_m)


def hidden_and_shaded(
    marker: MarkerPose, body: Proxy, illumination: Illumination, half_m: float, size: int
) -> tuple[Mask, Mask]:
    """(n, n) of a square of the plane each: what has to be made up, and what has to be covered from around here.

    What is made up is what the camera does not see, and what the body shades.
    """
    foot = body.points_marker()[:, :2]
    beside_m = FOOT_SIDES * marker.side_m
    grown = np.concatenate([foot + offset for offset in beside_m * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])])
    shaded = [*_shaded(body, illumination), grown]
    unknown = _painted([_hidden(body, eye) for eye in _eyes(marker, 0.0)] + shaded, half_m, size)
    return unknown, _painted([_hidden(body, eye) for eye in _eyes(marker, MARGIN_RAD)], half_m, size) | unknown


def _eyes(marker: MarkerPose, turned_rad: float) -> list[Float]:
    """(3,) places of the camera, marker frame, metres: where it is, or where it may turn to."""
    eye = camera_centre(marker.T_cam_marker)
    azimuth, elevation = angles_from_direction(eye)
    distance = float(np.linalg.norm(eye))
    if turned_rad == 0:
        return [distance * direction_from_angles(azimuth, max(elevation, LOWEST_RAD))]
    elevations = [max(elevation - turned_rad, LOWEST_RAD), min(max(elevation, LOWEST_RAD) + turned_rad, math.pi / 2)]
    places = [(azimuth + aside, above) for aside in (-turned_rad, 0.0, turned_rad) for above in elevations]
    return [part * distance * direction_from_angles(*place) for place in places for part in (1.0, NEARER)]


def _hidden(body: Proxy, eye: Float) -> Float:
    """(n, 2) convex, metres: the ground that the body hides from an eye, which is its shadow in a lamp there."""
    return shadow_hull_of_point(body.points_marker(), np.append(eye, 1.0))


def _shaded(body: Proxy, illumination: Illumination) -> list[Float]:
    """(n, 2) convex, metres, of each light: the ground that the body shades."""
    lights = [each for each in illumination.lights if each.to_light_marker[2] > 0]
    return [shadow_hull_of_point(body.points_marker(), each.homogeneous) for each in lights]


def _painted(hulls: list[Float], half_m: float, size: int) -> Mask:
    """(n, n) of a square of the plane, first row at the largest y: the insides of polygons (m, 2)."""
    mask = np.zeros((size, size), np.uint8)
    for hull in hulls:
        cv2.fillConvexPoly(mask, cv2.convexHull(in_square(hull, half_m, size)), 1, shift=FRACTION_BITS)
    return mask > 0
