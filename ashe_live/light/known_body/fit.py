"""Moves a light until the predicted edges of the body's shadow lie where the light on the table falls to its half."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.shadow_edges import ShadowEdges, shadow_edges
from ashe_live.light.known_body.table import height_of
from ashe_live.light.pixels.view import View

SAMPLES = 41  # across an edge
ENDS = 7  # of them at either end, whose means are the levels of shadow and light
# How far from the predicted edge the search reaches: of the body's height in the picture at first, then as much as the
# penumbra needs, in standard deviations, and never less than so many pixels.
REACHES = (0.3, 0.22, 0.16)
LAST_ROUNDS, SPREADS, LEAST_PX, MOST_SHARE = 4, 2.6, 3.5, 0.4
LEAST_STEP = 0.35  # of an edge, over the light that the shadow takes, from which on it is one
BLUR_PX = 0.8  # standard deviation of the picture's blur, until it is measured
OUTLIER_SHARE, OUTLIER_PX = 0.12, 0.5  # scale of Cauchy's loss: of the reach, and at least
EARLY_LOSS = 2.0  # times that scale in the first rounds
FEWEST = 5  # places that show an edge, without which nothing is fitted
# Neighbouring points see the same pixels, and a table's stains are wider than these: points over the sample size.
POINTS_A_SAMPLE = 6.0
START_SIGMA = 0.12  # of a start's displacement s, over 1 + |s|
EDGE_SIGMA_PX = 0.3  # of an edge that is measured, beside which the start's own uncertainty counts
LEAST_SIGMA_PX = 0.1  # of the edges' misfit, however small it is
LARGEST_RAD = math.radians(20)  # of a light's diameter that is stated


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFit:
    """A light whose shadow's edges were moved onto those in the picture."""

    light: Float  # (4,) homogeneous, z = 1, marker frame
    covariance: Float  # (2, 2) of s = (x, y) / z
    size_rad: float | None  # the light's angular diameter; None: no wider than the picture's blur tells
    misfit_px: float  # root mean square distance of the edges, robust
    misfit_share: float  # the same over how far they were looked for
    clear: float  # of the outline's points that could be seen, the part with a step as deep as the shadow
    seen: float  # part of the outline's points that could be seen


@dataclass(frozen=True, slots=True, eq=False)
class _Measured:
    """Edges as the picture has them."""

    edges: ShadowEdges
    reach_px: Float  # (n,) how far from the prediction they were looked for
    offset_px: Float  # (n,) outwards of where they are predicted
    variance_px2: Float  # (n,) of the rise
    step: Float  # (n,) light lost, over the lit side's
    visible: Mask  # (n,) with room enough on the bare table


def room_of(clear: Mask) -> Float32:
    """(h, w) distance of each pixel from the nearest one that is not `clear` (h, w)."""
    return np.asarray(cv2.distanceTransform(clear.astype(np.uint8), cv2.DIST_L2, 3), dtype=np.float32)


def fitted(body: Proxy, light: Float, darkening: float, picture: Float32, room: Float32, view: View) -> EdgeFit | None:
    """The light near `light` (4,) that explains the edges; None where too few of them are seen.

    darkening: the part of the table's light that it gives, roughly. picture: (h, w) linear light. room: as from
    `room_of` the bare table, without what is near the body or in another light's penumbra.
    """
    here = light / light[2]
    start, start_sigma = here[:2].copy(), START_SIGMA * (1 + float(np.hypot(*here[:2])))
    # Where an edge is hidden, what it would tell stays as it was found.
    prior = EDGE_SIGMA_PX**2 * POINTS_A_SAMPLE / start_sigma**2 * np.eye(2)
    height_px = float(view.camera.K[0, 0]) * height_of(body) / float(np.linalg.norm(view.T_cam_marker[:3, 3]))
    size, blur = 0.0, BLUR_PX**2
    for number in range(len(REACHES) + LAST_ROUNDS):
        edges = shadow_edges(body, here, view)
        if edges is None:
            return None
        is_first = number < len(REACHES)
        if is_first:
            wanted_px = np.full(len(edges.points_px), max(REACHES[number] * height_px, 2 * LEAST_PX))
        else:
            spread_px = np.sqrt(blur + (size * edges.by_size) ** 2)
            wanted_px = np.clip(SPREADS * spread_px, LEAST_PX, max(MOST_SHARE * height_px, LEAST_PX))
        measured = _measured(edges, wanted_px, picture, room)
        weight = _weights(measured, darkening, EARLY_LOSS if is_first else 1.0)
        if np.count_nonzero(weight) < FEWEST:
            return None
        if number >= len(REACHES) - 1:
            blur, size = _widths(measured, weight)
        J = edges.by_light[:, :2]
        normal = (J * weight[:, None]).T @ J + prior
        step = np.linalg.solve(normal, (J * weight[:, None]).T @ measured.offset_px - prior @ (here[:2] - start))
        here = _moved(here, step)
    left_px = measured.offset_px - J @ step
    return _edge_fit(here, measured, weight, left_px, normal, size or None, darkening)


def _moved(light: Float, step: Float) -> Float:
    """A light (4,) with z = 1 after a step (2,) of its displacement, by no more than half of that and one."""
    most = 0.5 * math.hypot(1.0, float(np.hypot(*light[:2])))
    moved = light.copy()
    moved[:2] += step * min(1.0, most / max(float(np.hypot(*step)), 1e-12))
    return moved


def _edge_fit(
    light: Float,
    measured: "_Measured",
    weight: Float,
    left_px: Float,
    normal: Float,
    size_rad: float | None,
    darkening: float,
) -> EdgeFit:
    """What is said of a light (4,) once its edges are where they are seen, but for `left_px` (n,)."""
    variance = float((weight * left_px**2).sum() / weight.sum()) + LEAST_SIGMA_PX**2
    covariance = variance * POINTS_A_SAMPLE * np.linalg.inv(normal)
    visible = measured.visible
    is_step = measured.step > LEAST_STEP * darkening
    return EdgeFit(
        light,
        np.asarray(covariance, dtype=np.float64),
        size_rad,
        math.sqrt(variance),
        math.sqrt(float((weight * (left_px / measured.reach_px) ** 2).sum() / weight.sum())),
        float(is_step[visible].mean()) if visible.any() else 0.0,
        float(visible.mean()),
    )


def without(clear: Mask, edges: ShadowEdges, reach_px: float) -> Mask:
    """`clear` (h, w) without what lies near the edges of another shadow."""
    picture = clear.astype(np.uint8)
    outline = np.round(edges.points_px.clip(-1e4, 1e4)).astype(np.int32)
    cv2.polylines(picture, [outline], True, 0, max(1, round(2 * reach_px)))
    return picture > 0


def _measured(edges: ShadowEdges, wanted_px: Float, picture: Float32, room: Float32) -> _Measured:
    """Where edges are in `picture` (h, w), looked for within `wanted_px` (n,), or less where there is less `room`."""
    column, row = np.round(edges.points_px).astype(int).T
    inside = (column >= 0) & (row >= 0) & (column < room.shape[1]) & (row < room.shape[0])
    free = np.where(inside, room[row.clip(0, room.shape[0] - 1), column.clip(0, room.shape[1] - 1)], 0.0)
    visible = free >= LEAST_PX
    reach = np.where(visible, np.minimum(wanted_px, free), wanted_px)
    along = np.linspace(-1, 1, SAMPLES)
    lines = edges.points_px[:, None] + (reach[:, None] * along)[..., None] * edges.normals_px[:, None]
    x, y = np.moveaxis(lines, 2, 0).astype(np.float32)
    profiles = cv2.remap(picture, x, y, cv2.INTER_LINEAR).astype(np.float64)
    dark, lit = profiles[:, :ENDS].mean(axis=1), profiles[:, -ENDS:].mean(axis=1)
    step = (lit - dark) / np.maximum(lit, 1e-4)
    light = (profiles - dark[:, None]) / np.where(np.abs(lit - dark) > 1e-6, lit - dark, 1.0)[:, None]
    spacing = 2 * reach / (SAMPLES - 1)
    # The light on a line that is dark up to the edge and lit beyond it is as much as its lit part is long.
    inside = light.sum(axis=1) - 0.5 * (light[:, 0] + light[:, -1])
    offset = reach - inside * spacing
    rises = np.clip(np.diff(light, axis=1), 0, None)
    rises /= np.maximum(rises.sum(axis=1, keepdims=True), 1e-9)
    middles = 0.5 * (along[1:] + along[:-1])
    mean = rises @ middles
    variance = (rises * (middles[None] - mean[:, None]) ** 2).sum(axis=1) * reach**2
    return _Measured(edges, np.asarray(reach), np.clip(offset, -reach, reach), variance, step, np.asarray(visible))


def _weights(measured: _Measured, darkening: float, loss: float) -> Float:
    """(n,) weight of each edge, 0 for what is none; loss: factor on the scale of Cauchy's loss."""
    reach = measured.reach_px
    scale = loss * np.maximum(OUTLIER_SHARE * reach, OUTLIER_PX)
    is_edge = measured.visible & (measured.step > LEAST_STEP * darkening)
    # Near a corner the neighbouring edge bends the half light.
    straight = np.clip(measured.edges.to_corner_px / np.maximum(0.7 * reach, 1e-9), 0, 1) ** 2
    deep = np.clip(measured.step / max(darkening, 1e-6), 0, 1) ** 2
    return np.asarray(is_edge * straight * deep / (1 + (measured.offset_px / scale) ** 2))


def _widths(measured: _Measured, weight: Float) -> tuple[float, float]:
    """The variance of the picture's blur, px^2, and the light's angular diameter, 0 where the two cannot be told apart.

    A penumbra widens with the height that casts it, blur does not: a weighted linear regression of variances.
    """
    spreads = measured.edges.by_size
    design = np.column_stack([np.ones(len(spreads)), spreads**2])
    w = weight.copy()
    for _ in range(4):
        normal = (design * w[:, None]).T @ design + 1e-12 * np.eye(2)
        blur, squared = np.linalg.solve(normal, (design * w[:, None]).T @ measured.variance_px2)
        rest = measured.variance_px2 - design @ np.array([blur, squared])
        scale = 1.48 * float(np.median(np.abs(rest[weight > 0]))) + 1e-3
        w = weight / (1 + (rest / (2 * scale)) ** 2)
    error = scale * math.sqrt(POINTS_A_SAMPLE * abs(float(np.linalg.inv(normal)[1, 1])))
    blur = float(np.clip(blur, 0.3, 9.0))
    widest = float(np.percentile(spreads[weight > 0], 90))
    if squared <= 3 * error or squared * widest**2 < 0.5 * blur:
        return blur, 0.0
    return blur, min(math.sqrt(squared), LARGEST_RAD)
