"""The surface by which a real object is drawn: its body's, moved onto the object's outline in a picture of it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, cross_2d
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import inverse_rigid, transform_points
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted, tangents_of_pixels
from ashe_live.render.occlusion.seen_outline import SeenOutline, seen_outline

FINEST = 0.1  # edges longer than this share of the outline's size are divided, so that what they bound can bend
ROUNDS = 6  # of division in halves, at most


Triangles = tuple[Float, NDArray[np.uint32]]  # (n, 3) points and (m, 3) corners of triangles, as of `Proxy.surface`


def drawn_surface(body: Proxy, seen_in: TrackedFrame | None) -> Triangles:
    """The surface by which a body is drawn, metres, marker frame.

    seen_in: a frame that shows the object where the body stands. In it each point moves with the outline beyond it, by
    the share of its distance from the outline's middle, and keeps its depth; so the outline itself lies on the
    object's, and from elsewhere it is nearly there. Below the plane nothing would be seen: there points come nearer. A
    mesh, which several views gave, stays as it is, as does a body that the marker is on.
    """
    points, triangles = body.surface()
    if seen_in is None or seen_in.marker is None or seen_in.marker.body is not None or body.mesh is not None:
        return points, triangles
    camera, T_cam_marker = seen_in.camera, seen_in.marker.T_cam_marker
    if (points @ T_cam_marker[2, :3] + T_cam_marker[2, 3]).min() <= 1e-3:
        return points, triangles
    pixels = project_distorted(camera, T_cam_marker, points)
    hull = cv2.convexHull(pixels.astype(np.float32))[:, 0].astype(np.float64)
    outline = seen_outline(seen_in.frame.image_bgr, hull)
    if outline is None:
        return points, triangles
    size_px = np.sqrt(cv2.contourArea(hull.astype(np.float32)))
    points, triangles = _divided(points, pixels, triangles, FINEST * size_px)
    pixels = project_distorted(camera, T_cam_marker, points)
    tangents = tangents_of_pixels(camera, pixels + _moved_px(outline, pixels))
    depth = points @ T_cam_marker[2, :3] + T_cam_marker[2, 3]
    T_marker_cam = inverse_rigid(T_cam_marker)
    moved = transform_points(T_marker_cam, np.column_stack([tangents, np.ones(len(tangents))]) * depth[:, None])
    eye = T_marker_cam[:3, 3]
    below = (moved[:, 2] < 0) & (points[:, 2] >= 0) & (eye[2] > 0)
    share = np.where(below, eye[2] / np.maximum(eye[2] - moved[:, 2], 1e-9), 1.0)[:, None]
    return eye + share * (moved - eye), triangles


def _moved_px(outline: SeenOutline, pixels: Float) -> Float:
    """(n, 2) by how much pixels (n, 2) within an outline move."""
    middle = outline.points_px.mean(axis=0)
    rim, inside = outline.points_px - middle, pixels - middle
    angles = np.arctan2(rim[:, 1], rim[:, 0])
    order = np.argsort(angles)
    at = np.arctan2(inside[:, 1], inside[:, 0])
    last = np.searchsorted(angles[order], at) % len(order)
    a, b = order[last - 1], order[last]
    # Where the ray from the middle meets the line through the places before and after it.
    across = rim[b] - rim[a]
    along = cross_2d(rim[a], inside) / _nonzero(cross_2d(inside, across))
    along = np.clip(along, 0.0, 1.0)[:, None]
    reach = np.linalg.norm(rim[a] + along * across, axis=1)
    share = np.minimum(np.linalg.norm(inside, axis=1) / np.maximum(reach, 1e-9), 1.0)[:, None]
    moved = outline.offset_px[:, None] * outline.normals
    return np.asarray(share * ((1 - along) * moved[a] + along * moved[b]))


def _nonzero(values: Float) -> Float:
    return np.where(np.abs(values) < 1e-12, 1e-12, values)


def _divided(
    points: Float, pixels: Float, corners: NDArray[np.uint32], longest_px: float
) -> tuple[Float, NDArray[np.uint32]]:
    """The same surface with edges of at most about `longest_px` in the picture, without triangles that have no area.

    points (n, 3), pixels (n, 2), corners (m, 3). A divided edge is so in both triangles that it
    bounds, so that no gap opens.
    """
    points, pixels, triangles = _without_slivers(points, pixels, corners)
    for _ in range(ROUNDS):
        edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2)
        is_long = np.linalg.norm(pixels[edges[..., 0]] - pixels[edges[..., 1]], axis=2) > longest_px
        if not is_long.any():
            break
        pairs, which = np.unique(np.sort(edges[is_long], axis=1), axis=0, return_inverse=True)
        middles = np.full(triangles.shape, -1, dtype=np.int64)
        middles[is_long] = len(points) + which.reshape(-1)
        points = np.concatenate([points, points[pairs].mean(axis=1)])
        pixels = np.concatenate([pixels, pixels[pairs].mean(axis=1)])
        triangles = _with_middles(triangles, middles)
    return points, triangles.astype(np.uint32)


def _without_slivers(
    points: Float, pixels: Float, triangles: NDArray[np.uint32]
) -> tuple[Float, Float, NDArray[np.int64]]:
    """Equal points made one, and triangles between fewer than three left out."""
    _, first, same = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    corners = same.reshape(-1)[triangles.astype(np.int64)]
    a, b, c = corners.T
    return points[first], pixels[first], corners[(a != b) & (b != c) & (c != a)]


def _with_middles(triangles: NDArray[np.int64], middles: NDArray[np.int64]) -> NDArray[np.int64]:
    """(k, 3) the triangles (m, 3) divided at the middles (m, 3) of their edges from each corner to the next, or -1."""
    count = (middles >= 0).sum(axis=1)
    # Turned so that a single divided edge comes first, and a single undivided one last.
    turn = np.where(
        count == 1, (middles >= 0).argmax(axis=1), np.where(count == 2, (middles < 0).argmax(axis=1) + 1, 0)
    )
    order = (np.arange(3) + turn[:, None]) % 3
    a, b, c = np.take_along_axis(triangles, order, axis=1).T
    ab, bc, ca = np.take_along_axis(middles, order, axis=1).T
    whole, one, two, three = (count == each for each in range(4))
    parts = [
        (whole, (a, b, c)),
        (one, (a, ab, c)),
        (one, (ab, b, c)),
        (two, (ab, b, bc)),
        (two, (a, ab, bc)),
        (two, (a, bc, c)),
        (three, (a, ab, ca)),
        (three, (ab, b, bc)),
        (three, (bc, c, ca)),
        (three, (ab, bc, ca)),
    ]
    return np.concatenate([np.column_stack(corners)[of] for of, corners in parts])
