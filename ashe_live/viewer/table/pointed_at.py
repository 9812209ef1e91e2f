"""Which of the models on the table a pixel points at."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.models.placement import PlacedModel, Placement
from ashe_live.render.gl.framing import corners_of
from ashe_live.tracking.edges.lens import ideal_from_source
from ashe_live.viewer.hands.pointing import Pixel


def model_at(at_px: Pixel, tracked: TrackedFrame, models: Sequence[tuple[PlacedModel, Placement | None]]) -> int | None:
    """The number of the model at a pixel of the video, or of the nearest one; None where none is in view.

    By the rectangles around the models' boxes in the picture; within several, by the nearest middle.
    """
    if tracked.marker is None:
        return None
    (at,) = ideal_from_source(tracked.camera, np.array([at_px]))
    best, nearest = None, (np.inf, np.inf)
    for number, (model, placement) in enumerate(models):
        if placement is None:
            continue
        seen = project(tracked.camera, tracked.marker.T_cam_marker, corners_of(model, placement))
        if np.isfinite(seen).all() and (distances := _distances(at, seen)) < nearest:
            best, nearest = number, distances
    return best


def _distances(at: Float, seen: Float) -> tuple[float, float]:
    """Distances from a pixel (2,) to the rectangle around pixels (n, 2), 0 within it, and to its middle."""
    lower, upper = seen.min(axis=0), seen.max(axis=0)
    outside = np.maximum(np.maximum(lower - at, at - upper), 0)
    return float(np.linalg.norm(outside)), float(np.linalg.norm(at - (lower + upper) / 2))
