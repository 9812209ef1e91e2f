"""Converts between places in the window, pixels of the video and points of the marker plane."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Size
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import TrackedFrame
from ashe_live.render.gl.framing import letterbox
from ashe_live.tracking.edges.lens import ideal_from_source, source_from_ideal
from ashe_live.viewer.hands.requests import Drag, Request

Pixel = tuple[float, float]


def source_pixel(at_px: Pixel, framebuffer: Size, video: Size) -> Pixel:
    """The video's pixel at a place in the framebuffer, whose left and top edges are 0; also beyond the video."""
    left, bottom, width, height = letterbox(video, framebuffer)
    top = framebuffer[1] - bottom - height
    # OpenCV's pixel centres are integers.
    return (at_px[0] - left) * video[0] / width - 0.5, (at_px[1] - top) * video[1] / height - 0.5


def in_mirror(request: Request, framebuffer: Size) -> Request:
    """A request made while looking at the mirrored picture, as if made in the picture itself."""
    match request.argument:
        case Drag((x0, y0), (x, y), is_first):
            width = framebuffer[0]
            return Request(request.command, Drag((width - x0, y0), (width - x, y), is_first))
        case (right, up):
            return Request(request.command, (-right, up))
    return request


def in_video(request: Request, framebuffer: Size, shown: TrackedFrame | None) -> Request:
    """`request` with a drag in the framebuffer converted to one in the video that is fitted into it."""
    drag = request.argument
    if not isinstance(drag, Drag) or shown is None or min(framebuffer) < 1:
        return request
    begin, now = (source_pixel(at, framebuffer, shown.frame.size) for at in (drag.begin_px, drag.now_px))
    return Request(request.command, Drag(begin, now, drag.is_first))


def ground_at(tracked: TrackedFrame, source_px: Pixel) -> Float | None:
    """(2,) metres, marker frame: the plane's point that the picture shows there; None where it shows none of it."""
    if tracked.marker is None:
        return None
    ideal = ideal_from_source(tracked.camera, np.array([source_px]))
    (point,) = raycast_to_plane(tracked.camera, tracked.marker.T_cam_marker, ideal)
    return np.asarray(point[:2]) if np.isfinite(point).all() else None


def pixel_of(tracked: TrackedFrame, ground: Float) -> Pixel | None:
    """Where the picture shows a point (2,) of the plane; None where it does not."""
    if tracked.marker is None:
        return None
    ideal = project(tracked.camera, tracked.marker.T_cam_marker, [(*ground, 0.0)])
    if not np.isfinite(ideal).all():
        return None
    ((x, y),) = source_from_ideal(tracked.camera, ideal)
    width, height = tracked.frame.size
    return (float(x), float(y)) if -0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5 else None
