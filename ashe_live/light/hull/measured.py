"""What silhouettes near a hull's measure: planes that touch the body, and tangents of its shadow on the plane."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.hull.labelled import Labelled
from ashe_live.light.hull.supports import Planes, ShadowLines, SupportFunction, planes_of_lines, shadow_lines
from ashe_live.light.pixels.areas import areas_by_size, grown, majority, shrunk
from ashe_live.light.shape.predicted import Predicted
from ashe_live.light.shape.silhouettes import Outlines, observe_outlines

DIRECTIONS = 24  # of tangents in each view
EDGE_SIGMA_PX = 0.7  # standard deviation of a mask's edge
SHARED = 0.3  # correlation between views of a shadow border's errors, as where a body is aligned in several
NEAR_PX = 2  # of a hull's silhouette: so far from it labels decide
LEAST_LINES = 6  # tangents of shadows, in all views
HALF_SIZE = 0.6  # a body's half size over the root of its silhouette's area: between a disc's 0.56 and a square's 0.71


def shape_and_shadow(
    views: Sequence[Labelled], masks: Sequence[Predicted], middle: Float
) -> tuple[SupportFunction, ShadowLines] | None:
    """What the silhouettes of all views tell of the body, and its shadow's tangents; None where these are too few.

    masks: the hull's silhouettes in each view. middle: (3,) of the body, marker frame.
    """
    planes: list[Planes] = []
    shadows: list[ShadowLines] = []
    sizes_m = []
    shared_px = EDGE_SIGMA_PX * math.sqrt(1 + SHARED * (len(views) - 1))
    for view, seen in zip(views, masks, strict=True):
        body, shadow = _relabelled(view, seen)
        outlines = observe_outlines(body, [shadow], view.unreliable, DIRECTIONS, EDGE_SIGMA_PX)
        depth_m = float(view.P[2, :3] @ middle + view.P[2, 3])
        if isinstance(outlines, str) or depth_m <= 0:
            continue
        planes.append(planes_of_lines(view.P, _body_lines(outlines), EDGE_SIGMA_PX, depth_m))
        shadows.append(shadow_lines(view.P, _shadow_lines(outlines), shared_px, depth_m))
        sizes_m.append(outlines.size_px * depth_m / view.focal_px)
    if sum(len(each.reach_m) for each in shadows) < LEAST_LINES:
        return None
    together = ShadowLines(
        np.concatenate([each.normals for each in shadows]),
        np.concatenate([each.reach_m for each in shadows]),
        np.concatenate([each.sigma_m for each in shadows]),
    )
    return SupportFunction(planes, HALF_SIZE * float(np.median(sizes_m))), together


def _relabelled(view: Labelled, seen: Predicted) -> tuple[Mask, Mask]:
    """Object and shadow (h, w) by their colours near the hull's silhouettes, the largest area of each."""
    ground = np.minimum(view.as_lit, view.as_shadow)
    body = (grown(seen.body, NEAR_PX) & (view.as_body < ground)) | shrunk(seen.body, NEAR_PX)
    body = _largest(majority(body))
    shadow = grown(seen.whole, NEAR_PX + 1) & (view.as_shadow < np.minimum(view.as_lit, view.as_body))
    return body, _largest(majority(shadow & ~grown(body, 1)))


def _largest(mask: Mask) -> Mask:
    return next(iter(areas_by_size(mask, 1)), mask)


def _body_lines(outlines: Outlines) -> Float:
    return _lines(outlines, 0, outlines.seen[0])


def _shadow_lines(outlines: Outlines) -> Float:
    """The tangents beyond the object: elsewhere it hides more of the shadow, or labels take some of that for it."""
    return _lines(outlines, 1, outlines.seen[1] & (outlines.least_px[1] > outlines.most_px[0]))


def _lines(outlines: Outlines, row: int, chosen: Mask) -> Float:
    """(n, 3) tangents of an outline along the chosen directions (d,): (x, y, 1) @ line <= 0 inside."""
    normals, reach = outlines.directions[chosen], outlines.least_px[row, chosen]
    return np.column_stack([normals, -(reach + normals @ outlines.centre_px)])
