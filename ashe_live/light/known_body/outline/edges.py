"""The edges of a known body's shadow: where they are predicted, and how they move with the light."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import image_from_plane, project
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import nearness_of
from ashe_live.light.shape.light_points import cast_on_ground

POINTS = 105  # of an outline, spread evenly along it in the picture


@dataclass(frozen=True, slots=True, eq=False)
class ShadowEdges:
    """Points on a shadow's outline in a picture."""

    points_px: Float  # (n, 2)
    corners_px: Float  # (m, 2) those of the outline, which is convex
    normals_px: Float  # (n, 2) unit vectors out of the shadow
    to_corner_px: Float  # (n,) distance from the nearer end of the point's straight edge
    by_light: Float  # (n, 3) pixels along the normal by s_x, s_y and by w / z, 1/m
    by_size: Float  # (n,) standard deviation, pixels, of the penumbra of a light of 1 rad


def shadow_edges(body: Proxy, light: Float, view: View) -> ShadowEdges | None:
    """The outline of the body's shadow in a light (4,), marker frame; None where it has none in the picture."""
    points = body.points_marker()
    cast = cast_on_ground(points, light)
    if cast is None:
        return None
    rim = cv2.convexHull(cast[:, :2].astype(np.float32), returnPoints=False)[:, 0]
    corners, casting = cast[rim, :2], points[rim]
    pixels = project(view.camera, view.T_cam_marker, cast[rim])
    if len(rim) < 3 or not np.isfinite(pixels).all():
        return None
    lengths_px = np.linalg.norm(np.roll(pixels, -1, axis=0) - pixels, axis=1)
    ends = lengths_px.cumsum()
    at = (np.arange(POINTS) + 0.5) / POINTS * ends[-1]
    edge = np.minimum(np.searchsorted(ends, at, side="right"), len(rim) - 1)
    after = (edge + 1) % len(rim)
    along_px = at - (ends - lengths_px)[edge]
    # Evenly in the picture is not evenly on the table: an edge's points are those of its line's homogeneous points.
    start, stop = (_depths(view, corners[each]) for each in (edge, after))
    share = along_px / np.maximum(lengths_px[edge], 1e-9)
    part = share * start / np.maximum(share * start + (1 - share) * stop, 1e-12)
    places = corners[edge] + part[:, None] * (corners[after] - corners[edge])
    # And those of the body's edge are in the ratio of their homogeneous scales.
    nearness = float(nearness_of(light))
    first, last = (1 - casting[each, 2] * nearness for each in (edge, after))
    way = part * first / np.maximum(part * first + (1 - part) * last, 1e-12)
    origin = casting[edge] + way[:, None] * (casting[after] - casting[edge])

    points_px, by_place = _with_slopes(view, places)
    tangent = np.einsum("nij,nj->ni", by_place, corners[after] - corners[edge])
    normals = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]
    middle = project(view.camera, view.T_cam_marker, np.append(corners.mean(axis=0), 0.0)[None])[0]
    normals *= np.sign(((points_px - middle) * normals).sum(axis=1))[:, None]
    across = np.einsum("ni,nij->nj", normals, by_place)
    lower = origin[:, 2] / (1 - origin[:, 2] * nearness)
    by_light = np.column_stack([-across * lower[:, None], (across * places).sum(axis=1) * lower])
    offsets = (light[:3] - light[3] * origin) / np.linalg.norm(light[:3])
    by_size = _penumbra(across, lower, offsets)
    to_corner = np.minimum(along_px, lengths_px[edge] - along_px)
    return ShadowEdges(points_px, pixels, normals, to_corner, by_light, by_size)


def _penumbra(across: Float, lower: Float, offsets: Float) -> Float:
    """(n,) standard deviation by the light's angular diameter, seen from the marker's centre: a disc's is a quarter.

    offsets: (n, 3) from what casts each point to the light, over the light's distance from the marker's centre.
    """
    s = offsets[:, :2] / offsets[:, 2:]
    # A turn of the direction by 1 moves s, and with it the edge along `across`, by no more than this: with the metric
    # (I - s s' / (1 + s's)) / (1 + s's) of directions in s, whose inverse is (1 + s's) (I + s s').
    by_direction = np.sqrt((1 + (s * s).sum(axis=1)) * ((across * across).sum(axis=1) + (across * s).sum(axis=1) ** 2))
    return np.asarray(by_direction / np.linalg.norm(offsets, axis=1) * lower / 4)


def _depths(view: View, places: Float) -> Float:
    return np.asarray(places @ view.T_cam_marker[2, :2] + view.T_cam_marker[2, 3])


def _with_slopes(view: View, places: Float) -> tuple[Float, Float]:
    """(n, 2) pixels of places (n, 2) on the table, and (n, 2, 2) their derivatives by these."""
    H = image_from_plane(view.camera, view.T_cam_marker)
    image = places @ H[:, :2].T + H[:, 2]
    pixels = image[:, :2] / image[:, 2:]
    slopes = (H[None, :2, :2] - pixels[:, :, None] * H[None, 2:, :2]) / image[:, 2, None, None]
    return pixels, slopes
