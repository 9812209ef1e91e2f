"""The same outline elsewhere on the table, where no shadow of the body can be: what a pattern shows by chance.

On stripes, checks, boards and tiles there are lines everywhere that the edges of some shadow could be.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.outline.edges import ShadowEdges
from ashe_live.light.known_body.outline.fit import BLUR_PX, REACHES, ShadowFit, windows_px
from ashe_live.light.known_body.outline.odds import edge_log_odds, log_odds_of_places
from ashe_live.light.known_body.outline.profiles import LEAST_PX, EdgeImage, Profiles
from ashe_live.light.known_body.table import REACH_HEIGHTS
from ashe_live.light.pixels.view import View

EVERY = 3  # of the outline's points, which still is more than are independent
# Heights of the body between places where the outline is tried; how many are, of those most in view; and which part of
# what is seen of it at the body must be seen there.
APART_HEIGHTS, MOST_PLACES, LEAST_SEEN = 0.6, 60, 0.8
START_SIGMA_HEIGHTS = 0.15  # how far it gives way to edges, about as far as a light's start does
FEWEST_PLACES = 8  # with less of the table in view nothing is concluded
# Of the log odds of outlines where no shadow is: their least standard deviation; and of so many of these a shadow's may
# be anywhere.
LEAST_SCATTER, SPREAD = 1.0, 10.0
# Least depth of the table over that of the marker's centre, and the coordinate of what is nearer, or behind the camera.
LEAST_DEPTH, NOWHERE_PX = 0.1, -1e6


def most_log_odds(fit: ShadowFit, image: EdgeImage, darkening: float) -> float:
    """What the edges of `fit` may say for it at most, as other edges of the table say as much.

    The log odds of the same outline laid elsewhere are taken for normal; those of a shadow's for even over SPREAD of
    their standard deviations. math.inf where too little of the table is in view. darkening: as of `fitted`.
    """
    profiles = fit.profiles_in(image)
    if profiles is None or not profiles.visible.any():
        return math.inf
    edges, chosen = profiles.edges, np.flatnonzero(profiles.visible)[::EVERY]
    image = replace(image, room=image.room.outside(edges.corners_px))
    along = np.arange(-REACH_HEIGHTS, REACH_HEIGHTS, APART_HEIGHTS) * image.height_m
    moves = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    around = image.room.around(laid(edges, chosen, moves, image.view)[0].points_px).reshape(len(moves), -1)
    moves = moves[np.argsort(-(around >= LEAST_PX).sum(axis=1), kind="stable")[:MOST_PLACES]]
    found = _on_edges(image, edges, chosen, moves, fit.size_rad or 0.0, darkening)
    log_odds = _log_odds(found, len(chosen), darkening)
    if len(log_odds) < FEWEST_PLACES:
        return math.inf
    sigmas = (edge_log_odds(fit) - float(log_odds.mean())) / max(float(log_odds.std()), LEAST_SCATTER)
    return 0.5 * max(sigmas, 0.0) ** 2 - math.log(SPREAD / math.sqrt(2 * math.pi))


def _on_edges(
    image: EdgeImage,
    edges: ShadowEdges,
    chosen: NDArray[np.intp],
    starts: Float,
    size_rad: float,
    darkening: float,
) -> Profiles:
    """The `chosen` points of an outline laid on the table by each of `starts` (k, 2), and from there moved onto edges.

    As a light is that was found, in windows that grow narrower. size_rad: its angular diameter.
    """
    moves, tall_px = starts, image.height_px
    prior = (START_SIGMA_HEIGHTS * image.height_m) ** -2.0 * np.eye(2)
    for number in range(len(REACHES) + 2):
        there, by_move = laid(edges, chosen, moves, image.view)
        wanted_px = windows_px(there, BLUR_PX**2, size_rad, tall_px)
        if number < len(REACHES):
            wanted_px = np.full(len(there.points_px), max(REACHES[number] * tall_px, 2 * LEAST_PX))
        found = image.profiles(there, wanted_px)
        J = by_move.reshape(len(moves), -1, 2)
        weighted = np.swapaxes(J * found.weights(darkening, 1.0).reshape(len(moves), -1, 1), 1, 2)
        pull = (weighted @ found.offset_px.reshape(len(moves), -1, 1))[..., 0] - (moves - starts) @ prior
        moves = moves + np.linalg.solve(weighted @ J + prior, pull[..., None])[..., 0]
    return found


def _log_odds(found: Profiles, count: int, darkening: float) -> Float:
    """Those of outlines with `count` points each, of which enough are seen, by their edges."""
    weights = found.weights(darkening, 1.0)
    by_point = found.visible, found.are_steps(darkening), weights, weights * (found.offset_px / found.reach_px) ** 2
    shown, steps, weight, squares = (each.reshape(-1, count).sum(axis=1) for each in by_point)
    misfit_share = np.sqrt(squares / np.maximum(weight, 1e-9))
    log_odds = log_odds_of_places(EVERY * count, steps / np.maximum(shown, 1), misfit_share)
    return np.asarray(log_odds[shown >= LEAST_SEEN * count])


def laid(edges: ShadowEdges, chosen: NDArray[np.intp], moves: Float, view: View) -> tuple[ShadowEdges, Float]:
    """The `chosen` points of an outline after each of k `moves` (k, 2), metres on the table, one after another; and
    (n, 2) pixels along their normals by such metres.
    """
    P = (view.camera.K @ view.T_cam_marker[:3])[:, [0, 1, 3]]
    side = edges.side[chosen]
    image = P[:, :2] @ (moves[:, None] + edges.on_plane()[0][chosen]).reshape(-1, 2).T + P[:, 2:]
    is_before = image[2] > LEAST_DEPTH * P[2, 2]
    depth = np.where(is_before, image[2], 1.0)
    # A side's line as it lies on the table after each move, (3, k, m), and in the picture.
    lines = np.repeat(edges.corners.lines[[0, 1, 3], None], len(moves), axis=1)
    lines[2] -= moves @ lines[:2, 0]
    in_picture = np.tensordot(np.linalg.inv(P).T, lines, 1)
    lengths = np.maximum(np.hypot(*in_picture[:2]), 1e-12)
    moved = replace(
        edges,
        points_px=np.where(is_before, image[:2] / depth, NOWHERE_PX).T,
        normals_px=(in_picture[:2] / lengths)[..., side].reshape(2, -1).T,
        side=np.tile(side, len(moves)),
        to_corner_px=np.tile(edges.to_corner_px[chosen], len(moves)),
        by_size=np.tile(edges.by_size[chosen], len(moves)),
    )
    return moved, ((lines[:2] / lengths)[..., side].reshape(2, -1) / depth).T
