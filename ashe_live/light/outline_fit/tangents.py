"""Common tangents of object and shadow from the light's vanishing point, which exist whatever the object's shape.

A plane through the camera's centre and the light's direction meets both silhouettes or neither (docs/maths,
"Common tangents"). Each of the two outermost planes gives one equation in the components of s, free of a body model.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask, unit_circle
from ashe_live.light.shape.layout import ParameterLayout, light_parameters, nearness_of
from ashe_live.light.shape.outlines.silhouettes import EDGE_SIGMA_PX, Outlines, Silhouette

NARROWEST = 0.05  # least distance from an outline to the vanishing point, relative to that from the origin
TANGENT_SIGMAS = 1.5  # sigma of a tangent's position, in sigmas of an edge
OUTLIER = 4.0  # scale of Cauchy's loss, in sigmas of a tangent
GROUNDED_SHARE = 0.15  # of the body's height: a tangent that touches it lower may touch its foot
ITERATIONS, CONVERGED = 15, 1e-4  # at most; and the relative gain of the cost that ends them


@dataclass(frozen=True, slots=True, eq=False)
class TangentGaps:
    """The gaps between the object's and the shadow's tangents on both sides, for a candidate light."""

    px: Float  # (2,) on the first and the second side
    by_light: Float  # (2, 2) derivatives by the light's displacement s
    is_bound: Mask  # (2,) whether a gap is a mere bound, as an outline that is hidden or cut may extend further


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Candidate lights, and the negative log posterior around them, twice."""

    parameters: Float  # (l, 2) displacements s
    cost: float
    gradient: Float  # (split,) half that of the cost
    curvature: Float  # (split, split) half that of the cost
    two_sided: Float  # (split, split) the part of it that is not from mere bounds


def lights_refined_by_tangents(
    P: Float, outlines: Outlines, lights: Float, information: Float, spheroids: Float | None
) -> tuple[Float, Float]:
    """Maximum a posteriori lights given those of a fitted body, as the prior, and the common tangents.

    P: (3, 4) pixels from the body's frame, counted from the outlines' centre. lights: (l, 4) in that frame, with
    `information` (split, split) on their parameters, which must be positive definite. spheroids: (k, 5) the body, if it
    is a good enough model to show where a tangent touches it; else None. Returns the lights (l, 4) and the covariance
    (split, split) of their parameters.
    """
    layout, fitted, nearness = ParameterLayout(len(lights)), light_parameters(lights), nearness_of(lights)
    sigma = TANGENT_SIGMAS * EDGE_SIGMA_PX
    feet = [None if spheroids is None else _touches_near_ground(P, spheroids, light) for light in lights]

    def evaluated(candidate: Float) -> _State:
        offset = (candidate - fitted).ravel()
        gradient, curvature, two_sided = information @ offset, information.copy(), information.copy()
        cost = float(offset @ gradient)
        for i, (shadow, foot) in enumerate(zip(outlines.shadows, feet, strict=True)):
            light = layout.lights_of(candidate.ravel(), nearness)[i]
            gaps = tangent_gaps(P, outlines.body, shadow, light, foot)
            error, slope, block = gaps.px / sigma, gaps.by_light / sigma, layout.light(i)
            weight = 1 / (1 + (error / OUTLIER) ** 2)
            cost += float(OUTLIER**2 * np.log1p((error / OUTLIER) ** 2).sum())
            gradient[block] += slope.T @ (weight * error)
            curvature[block, block] += slope.T @ (weight[:, None] * slope)
            two_sided[block, block] += slope.T @ (np.where(gaps.is_bound, 0.0, weight)[:, None] * slope)
        return _State(candidate, cost, gradient, curvature, two_sided)

    best = _cheapest(evaluated, fitted)
    # A bound only excludes lights on one side of it; it adds no information about those on the other.
    return layout.lights_of(best.parameters.ravel(), nearness), np.asarray(np.linalg.inv(best.two_sided))


def _cheapest(evaluated: Callable[[Float], _State], start: Float) -> _State:
    """The state with the least cost that is reached from `start` (l, 2), by the method of Levenberg and Marquardt."""
    best, damping = evaluated(start), 1e-3
    for _ in range(ITERATIONS):
        damped = best.curvature + damping * np.diag(np.diag(best.curvature))
        new = evaluated(best.parameters + np.linalg.solve(damped, -best.gradient).reshape(start.shape))
        if not new.cost < best.cost:
            damping *= 8.0
            continue
        is_settled = best.cost - new.cost < CONVERGED * best.cost
        best, damping = new, 0.2 * damping
        if is_settled:
            break
    return best


def tangent_gaps(P: Float, body: Silhouette, shadow: Silhouette, light: Float, foot: Mask | None = None) -> TangentGaps:
    """The gaps of a candidate (4,) for the shadow's light.

    P: (3, 4) pixels counted from the silhouettes' centre. foot: (2,) sides on which the object's tangent touches its
    foot, where it hides its own shadow. A gap that an outline's hidden or cut part explains is 0, and so is the gap of
    a vanishing point within the outlines, from which there are no tangents.
    """
    foot = np.zeros(2, dtype=np.bool_) if foot is None else foot
    v = _vanishing_point(P, light)
    if _has_no_direction(v, P):
        v[0] = 1e-9  # any direction will do, as its gaps are zeroed below
    one, other = _outermost(v, body), _outermost(v, shadow)
    # q is measured abreast of the centre; scaled so that gaps are in pixels where the tangents touch.
    scale = np.array([1.0, -1.0]) / np.hypot(1 / one.room, 1 / other.room)
    gaps = scale * (other.q - one.q)
    shadow_may_reach_further = ~other.certain | foot
    is_outside = min(one.least_room, other.least_room) > NARROWEST
    explained = (shadow_may_reach_further & (gaps < 0)) | (~one.certain & (gaps > 0)) | (not is_outside)
    by_v = np.where(explained, 0.0, scale)[..., None] * (other.by_v - one.by_v)
    return TangentGaps(np.where(explained, 0.0, gaps), by_v @ P[:, :2], shadow_may_reach_further | ~one.certain)


def _vanishing_point(P: Float, light: Float) -> Float:
    """(3,) the homogeneous image of a light (4,), divided by the light's z."""
    return np.asarray(light_parameters(light) @ P[:, :2].T + P[:, 2] + nearness_of(light) * P[:, 3])


def _has_no_direction(v: Float, P: Float) -> bool:
    """Whether a vanishing point v (3,) is at the outlines' centre."""
    return bool(np.abs(v[:2]).max() < 1e-12 * np.abs(P[:, :3]).max())


def _touches_near_ground(P: Float, spheroids: Float, light: Float) -> Mask:
    """(2,) whether the first and the second tangent from the light's vanishing point touch the body near the ground."""
    rim = np.column_stack([unit_circle(16), np.zeros(16)])
    rims = spheroids[:, None, :3] + spheroids[:, None, 3:4] * rim
    poles = spheroids[:, None, :3] + spheroids[:, None, 4:] * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    points = np.concatenate([rims, poles], axis=1).reshape(-1, 3)
    images = points @ P[:, :3].T + P[:, 3]
    pixels = images[:, :2] / np.maximum(images[:, 2:], 1e-3 * P[2, 3])
    v = _vanishing_point(P, light)
    if _has_no_direction(v, P):
        return np.zeros(2, dtype=np.bool_)
    ends = _outermost(v, Silhouette(pixels, np.ones(len(pixels), np.bool_)))
    return np.asarray(points[ends.index, 2] < GROUNDED_SHARE * points[:, 2].max())


@dataclass(frozen=True, slots=True)
class _Ends:
    """The tangents from a vanishing point v to a silhouette, on its first and its second side."""

    index: NDArray[np.intp]  # (2,) the corners that they touch
    q: Float  # (2,) signed distance from the origin at which they cross the normal to the direction of v
    room: Float  # (2,) distance from the corner to v along that direction, over the origin's (negative beyond v)
    certain: Mask  # (2,) whether the silhouette truly ends at the corner
    by_v: Float  # (2, 3) derivative of q
    least_room: float  # over all corners


def _outermost(v: Float, silhouette: Silhouette) -> _Ends:
    """The tangents from a vanishing point v (3,)."""
    points = silhouette.hull_px
    length = np.hypot(v[0], v[1])
    unit, nearness = v[:2] / length, v[2] / length
    along = points @ unit
    room = 1 - nearness * along
    span = length * np.where(np.abs(room) < 1e-9, 1e-9, room)
    q = (v[0] * points[:, 1] - v[1] * points[:, 0]) / span
    least_room, index = float(room.min()), np.array([q.argmax(), q.argmin()])

    along, room, span, q, touched = (each[index] for each in (along, room, span, q, points))
    turn = touched[:, ::-1] * np.array([1.0, -1.0])
    by_span = unit - nearness * (touched - along[:, None] * unit)
    by_v = np.column_stack([turn - q[:, None] * by_span, q * along]) / span[:, None]
    return _Ends(index, q, room, silhouette.certain[index], by_v, least_room)
