"""The ground hidden and shaded by the body that the marker is printed on, as the paper cube.

It is covered where a model is to stand in the body's place.
"""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Mask
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angles_from_direction, camera_centre, direction_from_angles
from ashe_live.core.types import MarkerPose
from ashe_live.render.cover.rectified import in_square
from ashe_live.render.lights.cast_shadows import shadow_hull_of_point

# A cover is kept while the camera turns by less than TURNED_RAD; it is made to reach far enough for MARGIN_RAD.
TURNED_RAD = math.radians(8.0)
MARGIN_RAD = math.radians(10.0)
WAYS = 8  # in which it may turn
NEARER = 0.65  # share of the camera's distance at which the cover still hides the body
LOWEST_RAD = math.radians(15.0)  # least elevation of the camera: from lower, the body hides ground without end
MOST_HALF_SIDES = 6.0  # limit of half of the side of the square of ground that is examined, in sides of the marker
AROUND_SIDES = 0.6  # width of the ground around the hidden and shaded part, from which that is filled
FOOT_SIDES = 0.5  # width of the ground around the body's foot that is darkened, as the body hides much of its sky


def half_of_square(marker: MarkerPose, body: Proxy, illumination: Illumination) -> float:
    """Metres from the marker's centre: half of a square that holds all that the body hides or shades, and some more."""
    corners = np.concatenate([_hidden(body, _eyes(marker, MARGIN_RAD)), *_shaded(body, illumination)])
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
    hidden, may_be = (_hidden(body, _eyes(marker, turned_rad)) for turned_rad in (0.0, MARGIN_RAD))
    unknown = _painted([hidden, *_shaded(body, illumination), grown], half_m, size)
    return unknown, _painted([may_be], half_m, size) | unknown


def _eyes(marker: MarkerPose, turned_rad: float) -> list[Float]:
    """(3,) places of the camera, marker frame, metres: where it is, or all around there where it may turn to."""
    eye = camera_centre(marker.T_cam_marker)
    distance, (azimuth, elevation) = float(np.linalg.norm(eye)), angles_from_direction(eye)
    towards = direction_from_angles(azimuth, max(elevation, LOWEST_RAD))
    if turned_rad == 0:
        return [distance * towards]
    # Not by azimuth and elevation: the higher the camera, the less an azimuth turns it.
    aside = direction_from_angles(azimuth + math.pi / 2, 0.0)
    above = np.cross(towards, aside)
    ways = [math.cos(way) * aside + math.sin(way) * above for way in math.tau / WAYS * np.arange(WAYS)]
    places = [angles_from_direction(math.cos(turned_rad) * towards + math.sin(turned_rad) * way) for way in ways]
    directions = [direction_from_angles(around, max(high, LOWEST_RAD)) for around, high in places]
    return [part * distance * direction for direction in directions for part in (1.0, NEARER)]


def _hidden(body: Proxy, eyes: list[Float]) -> Float:
    """(n, 2) corners, metres: the ground that the body hides from eyes, and from between them, is their convex hull."""
    # What is hidden from an eye is the body's shadow in a lamp there.
    return np.concatenate([shadow_hull_of_point(body.points_marker(), np.append(eye, 1.0)) for eye in eyes])


def _shaded(body: Proxy, illumination: Illumination) -> list[Float]:
    """(n, 2) convex, metres, of each light: the ground that the body shades."""
    lights = [each for each in illumination.lights if each.to_light_marker[2] > 0]
    return [shadow_hull_of_point(body.points_marker(), each.homogeneous) for each in lights]


def _painted(polygons: list[Float], half_m: float, size: int) -> Mask:
    """(n, n) of a square of the plane, first row at the largest y: what is in the convex hulls of points (m, 2)."""
    mask = np.zeros((size, size), np.uint8)
    for corners in polygons:
        cv2.fillConvexPoly(mask, cv2.convexHull(in_square(corners, half_m, size)), 1, shift=FRACTION_BITS)
    return mask > 0
