"""Measurements from silhouettes near a hull's: planes that touch the body, and tangents of its shadow on the plane."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.edges.outline_points import OutlinePoints
from ashe_live.light.edges.steps import steps_across
from ashe_live.light.hull.labelled import Labelled
from ashe_live.light.hull.supports import Planes, ShadowLines, SupportFunction, planes_of_lines, shadow_lines
from ashe_live.light.pixels.areas import areas_by_size, grown, majority, shrunk
from ashe_live.light.shape.outlines.silhouettes import Outlines, observe_outlines
from ashe_live.light.shape.predicted import Predicted
from ashe_live.light.views.joint.aligned import views_per_sample

DIRECTIONS = 24  # of tangents in each view
REACH_PX = 5.0  # of the full picture, within which a tangent's step of light is looked for
STEP_SIGMA_PX, UNSEEN_SIGMA_PX = 0.5, 1.5  # standard deviation of a tangent on a step of light, and where none is seen
NEAR_PX = 2  # of a hull's silhouette: so far from it labels decide
LEAST_LINES = 6  # tangents of shadows, in all views
HALF_SIZE = 0.6  # a body's half size over the root of its silhouette's area: between a disc's 0.56 and a square's 0.71


def shape_and_shadow(
    views: Sequence[Labelled], masks: Sequence[Predicted], middle: Float
) -> tuple[SupportFunction, ShadowLines] | None:
    """The body's support function by the silhouettes of all views, and its shadow's tangents; None where these are few.

    masks: the hull's silhouettes in each view. middle: (3,) of the body, marker frame.
    """
    planes: list[Planes] = []
    shadows: list[ShadowLines] = []
    sizes_m = []
    shared = math.sqrt(views_per_sample(len(views)))  # as where a body is aligned in several views
    for view, seen in zip(views, masks, strict=True):
        body, shadow = _relabelled(view, seen)
        outlines = observe_outlines(body, [shadow], view.unreliable, DIRECTIONS)
        depth_m = float(view.P[2, :3] @ middle + view.P[2, 3])
        if outlines is None or depth_m <= 0:
            continue
        lines, sigma_px = _tangents(view, outlines, 0, outlines.seen[0], math.nan)
        planes.append(planes_of_lines(view.P, lines, sigma_px, depth_m))
        # Beyond the object: elsewhere it hides more of the shadow, or labels take some of that for it.
        beyond = outlines.seen[1] & (outlines.least_px[1] > outlines.most_px[0])
        lines, sigma_px = _tangents(view, outlines, 1, beyond, -view.shift)
        shadows.append(shadow_lines(view.P, lines, shared * sigma_px, depth_m))
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


def _tangents(view: Labelled, outlines: Outlines, row: int, chosen: Mask, rise: float) -> tuple[Float, Float]:
    """The tangents of an outline along the chosen directions (d,), moved onto the steps of light where these are seen.

    In the region: lines (n, 3) with (x, y, 1) @ line <= 0 inside, the first two of unit length; and (n,) sigmas, px.
    Colours are smeared by cameras that take noise from them, and labels with them; brightness hardly is.
    """
    normals, reach = outlines.directions[chosen], outlines.least_px[row, chosen]
    if not len(normals):
        return np.empty((0, 3)), np.empty(0)
    hull = (outlines.body, *outlines.shadows)[row].hull_px
    touched = hull[(hull @ normals.T).argmax(axis=0)] + outlines.centre_px
    A = view.picture_from_region
    at = OutlinePoints((touched @ A[:2, :2].T + A[:2, 2])[None], normals[None], np.zeros((1, len(normals))))
    steps = steps_across(view.picture.linear_bgr, at, REACH_PX, np.array([rise]))
    is_seen = (steps.information[0] > 0) & view.picture.is_reliable_at(at.points[0])
    scale = float(A[0, 0])
    reach = reach + np.where(is_seen, steps.offset_px[0] / scale, 0.0)
    sigma = np.where(is_seen, STEP_SIGMA_PX, UNSEEN_SIGMA_PX)
    return np.column_stack([normals, -(reach + normals @ outlines.centre_px)]), sigma
