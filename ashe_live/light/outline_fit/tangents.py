"""Tangents from the light's vanishing point: they touch the object's outline and its shadow's, whatever the shape.

A plane through the camera's centre and the light's direction meets both silhouettes or neither (docs/maths.md,
"Common tangents"). Each of the two outermost planes gives one equation in the two numbers of s, free of any body.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.shape.layout import Layout, numbers_of
from ashe_live.light.shape.silhouettes import Outlines, Silhouette

NARROWEST = 0.05  # share of the distance to the vanishing point that must remain before a tangent is believed
TANGENT_SIGMAS = 1.5  # a tangent's error in those of an edge; beyond OUTLIER of its own it counts less and less
OUTLIER = 4.0
GROUNDED_SHARE = 0.15  # of its height: what a body's tangent touches below this may be its foot
ITERATIONS = 15


def sharpened_lights(
    P: Float, outlines: Outlines, lights: Float, information: Float, edge_sigma_px: float, spheroids: Float | None
) -> tuple[Float, Float]:
    """The most likely lights given those of a fitted body and the tangents, and the covariance of their numbers.

    P: (3, 4) pixels from the body's frame, about the outlines' centre. lights: (l, 4) in that frame; their numbers are
    believed with `information` (split, split), which must be positive definite. spheroids: (k, 5) the body, where it
    can be told from it what a tangent touches. Returns (l, 4) and (split, split).
    """
    layout, numbers = Layout(len(lights)), numbers_of(lights)
    sigma = TANGENT_SIGMAS * max(edge_sigma_px, 0.05)
    feet = [None if spheroids is None else _stands_there(P, spheroids, light) for light in lights]

    def evaluate(candidate: Float) -> tuple[float, Float, Float, Float]:
        """Cost, its gradient / 2 and its curvature / 2; and the part of that which holds towards either side."""
        offset = (candidate - numbers).ravel()
        gradient, curvature, known = information @ offset, information.copy(), information.copy()
        cost = float(offset @ gradient)
        for i, (shadow, foot) in enumerate(zip(outlines.shadows, feet, strict=True)):
            light = layout.lights_of(candidate.ravel())[i : i + 1]
            gaps, by_light, bounds_only = tangent_gaps(P, outlines.body, shadow, light, foot)
            error, slope, own = gaps[0] / sigma, by_light[0] / sigma, layout.light(i)
            weight = 1 / (1 + (error / OUTLIER) ** 2)
            cost += float(OUTLIER**2 * np.log1p((error / OUTLIER) ** 2).sum())
            gradient[own] += slope.T @ (weight * error)
            curvature[own, own] += slope.T @ (weight[:, None] * slope)
            known[own, own] += slope.T @ (np.where(bounds_only[0], 0.0, weight)[:, None] * slope)
        return cost, gradient, curvature, known

    best, damping = numbers, 1e-3
    cost, gradient, curvature, known = evaluate(best)
    for _ in range(ITERATIONS):
        step = np.linalg.solve(curvature + damping * np.diag(np.diag(curvature)), -gradient)
        candidate = best + step.reshape(numbers.shape)
        new_cost, *new_slopes = evaluate(candidate)
        if new_cost < cost:
            settled = cost - new_cost < 1e-4 * cost
            best, cost, (gradient, curvature, known) = candidate, new_cost, new_slopes
            damping *= 0.2
            if settled:
                break
        else:
            damping *= 8.0
    # A bound says where the light is not: beyond it, nothing is known any better.
    return layout.lights_of(best.ravel()), np.asarray(np.linalg.inv(known))


def tangent_gaps(
    P: Float, body: Silhouette, shadow: Silhouette, lights: Float, foot: Mask | None = None
) -> tuple[Float, Float, Mask]:
    """How far the two pairs of tangents are apart.

    P: (3, 4) pixels about the silhouettes' centre. lights: (n, 4) candidates for its light. foot: (2,) sides on which
    the object's tangent touches where it stands: it hides its own shadow there. Returns (n, 2) gaps in pixels, first
    and second side, their derivatives by the light's numbers (n, 2, 2), and (n, 2) whether they are mere bounds, as an
    outline that is hidden or cut may reach further. A gap which that explains is 0, as is that of a vanishing point
    within the outlines, which has no tangents.
    """
    foot = np.zeros(2, dtype=np.bool_) if foot is None else foot
    v = _vanishing_points(P, lights)
    # A light right behind the outlines' centre has no side; any will do, as its gaps are zeroed below.
    v[:, 0] = np.where(np.abs(v[:, :2]).max(axis=1) < 1e-12 * np.abs(P[:, :3]).max(), 1e-9, v[:, 0])
    one, other = _outermost(v, body), _outermost(v, shadow)
    # Both ends' errors as pixels: q is measured abreast of the centre.
    scale = np.array([1.0, -1.0]) / np.hypot(1 / one.room, 1 / other.room)
    gaps = scale * (other.q - one.q)
    shadow_may_reach_further = ~other.certain | foot
    outside = (one.least_room > NARROWEST) & (other.least_room > NARROWEST)
    explained = (shadow_may_reach_further & (gaps < 0)) | (~one.certain & (gaps > 0)) | ~outside[:, None]
    by_v = np.where(explained, 0.0, scale)[..., None] * (other.by_v - one.by_v)
    return np.where(explained, 0.0, gaps), by_v @ P[:, :2], shadow_may_reach_further | ~one.certain


def _vanishing_points(P: Float, lights: Float) -> Float:
    """(n, 3) the homogeneous images of lights (n, 4), over their z."""
    return np.asarray(numbers_of(lights) @ P[:, :2].T + P[:, 2] + lights[:, 3:] / lights[:, 2:3] * P[:, 3])


def _stands_there(P: Float, spheroids: Float, light: Float) -> Mask:
    """(2,) whether a body's first and second tangent touch it near the ground."""
    angles = np.arange(16) * (2 * math.pi / 16)
    rim = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(16)])
    rims = spheroids[:, None, :3] + spheroids[:, None, 3:4] * rim
    poles = spheroids[:, None, :3] + spheroids[:, None, 4:] * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    points = np.concatenate([rims, poles], axis=1).reshape(-1, 3)
    images = points @ P[:, :3].T + P[:, 3]
    pixels = images[:, :2] / np.maximum(images[:, 2:], 1e-3 * P[2, 3])
    v = _vanishing_points(P, light[None])
    if np.abs(v[0, :2]).max() < 1e-12 * np.abs(P[:, :3]).max():
        return np.zeros(2, dtype=np.bool_)
    ends = _outermost(v, Silhouette(pixels, np.ones(len(pixels), np.bool_))).index[0]
    touched = points[ends, 2]
    return np.asarray(touched < GROUNDED_SHARE * points[:, 2].max())


@dataclass(frozen=True, slots=True)
class _Ends:
    """Where lines from n vanishing points v touch a silhouette, on its first and its second side."""

    index: NDArray[np.intp]  # (n, 2) corners
    q: Float  # (n, 2) signed distance from the origin, across the direction of v, at which a line passes abreast of it
    room: Float  # (n, 2) the distance left to v as a share of the whole (negative beyond v)
    certain: Mask  # (n, 2)
    by_v: Float  # (n, 2, 3) derivative of q
    least_room: Float  # (n,) over all corners


def _outermost(v: Float, silhouette: Silhouette) -> _Ends:
    """The tangents from vanishing points v (n, 3)."""
    points = silhouette.hull_px
    length = np.hypot(v[:, :1], v[:, 1:2])
    unit, nearness = v[:, :2] / length, v[:, 2:] / length
    along = unit @ points.T
    room = 1 - nearness * along
    span = length * np.where(np.abs(room) < 1e-9, 1e-9, room)
    q = (v[:, :1] * points[:, 1] - v[:, 1:2] * points[:, 0]) / span
    index = np.stack([q.argmax(axis=1), q.argmin(axis=1)], axis=1)
    least_room = room.min(axis=1)

    row = np.arange(len(v))[:, None]
    along, room, span, q, touched = (*(each[row, index] for each in (along, room, span, q)), points[index])
    turn = touched[..., ::-1] * np.array([1.0, -1.0])
    by_span = unit[:, None] - nearness[:, None] * (touched - along[..., None] * unit[:, None])
    by_v = np.concatenate([turn - q[..., None] * by_span, (q * along)[..., None]], axis=2) / span[..., None]
    return _Ends(index, q, room, silhouette.certain[index], by_v, least_room)
