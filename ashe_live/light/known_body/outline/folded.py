"""The light of a body that may be off, by its shadow's edges and by how folds move all of them together.

A face that is turned turns the frame in which the body is seen, and moves several edges of its shadow at once, not all
of them as a light would. So light and folds are fitted together, each fold as likely as what the tracker saw leaves it:
generalised least squares (docs/maths.md, "Folds").
"""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Wobble
from ashe_live.light.known_body.outline.fit import EDGE_SIGMA_PX, LEAST_SHOWN, LEAST_SIGMA_PX, START_SIGMA
from ashe_live.light.known_body.outline.profiles import POINTS_A_SAMPLE, Profiles

ROUNDS = 4  # of reweighted least squares


def beside_folds(
    light: Float, profiles: Profiles, darkening: float, wobble: Wobble
) -> tuple[Float, Float]:
    """(2,) by how much the displacement s of a sun (4,), z = 1, which lies on its edges, is off, and (2, 2) covariance.

    profiles: its edges. darkening: the part of the table's light that it gives.
    """
    edges = profiles.edges
    count = len(edges.corners_px)
    # A whole side is off where stains, the hidden sky's gradient, or what bulges, shift it.
    by_sides = EDGE_SIGMA_PX * (edges.side[:, None] == np.arange(count))
    causes = np.concatenate([edges.by_wobble(wobble, light), by_sides], axis=1)
    J = np.concatenate([edges.by_light[:, :2], causes], axis=1)
    sigma = START_SIGMA * (1 + float(np.hypot(*light[:2])))
    prior = np.diag(np.concatenate([np.full(2, sigma**-2), np.ones(causes.shape[1])]))
    left_px, variance = profiles.offset_px, EDGE_SIGMA_PX**2
    for number in range(ROUNDS):
        weight = profiles.weights(darkening, 2.0 if number == 0 else 1.0, left_px)
        shown = np.bincount(edges.side, weight, count) >= LEAST_SHOWN * np.bincount(edges.side, profiles.visible, count)
        weight = weight * shown[edges.side]
        weighted = J.T * (weight / (POINTS_A_SAMPLE * variance))
        covariance = np.linalg.inv(weighted @ J + prior)
        step = covariance @ (weighted @ profiles.offset_px)
        left_px = profiles.offset_px - J @ step
        variance = float((weight * left_px**2).sum() / max(float(weight.sum()), 1e-9)) + LEAST_SIGMA_PX**2
    return step[:2], covariance[:2, :2]
