"""The light of a body that may be off, by its shadow's edges and by how folds move all of them together.

A face that is turned turns the frame in which the body is seen, and moves several edges of its shadow at once, not all
of them as a light would. So light and folds are fitted together, each fold as likely as what the tracker saw leaves it:
generalised least squares (docs/maths, "Folds").
"""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.outline.fit import (
    EARLY_LOSS,
    EDGE_SIGMA_PX,
    LEAST_SIGMA_PX,
    ShadowFit,
    informative_sides,
    moved,
    prior_of,
)
from ashe_live.light.known_body.outline.profiles import POINTS_A_SAMPLE, EdgeImage

ROUNDS = 4  # of reweighted least squares


def beside_folds(fit: ShadowFit, image: EdgeImage, darkening: float, with_nearness: bool) -> tuple[Float, Float] | None:
    """The light (4,), z = 1, as it is if the body is off as the edges of a fit say, and its (p, p) covariance: of
    s = (x, y) / z and, `with_nearness`, of w / z. None where the shadow has no edges in the picture, and where it is
    not known how the body may be off.

    darkening: the part of the table's light that it gives, roughly.
    """
    errors, profiles = image.pose_shape_errors, fit.profiles_in(image)
    if errors is None or profiles is None:
        return None
    light, height = fit.light, image.height_m
    parameters = [0, 1, 3] if with_nearness else [0, 1]
    edges = profiles.edges
    # A whole side is off where stains, the hidden sky's gradient, or what bulges, shift it.
    by_sides = EDGE_SIGMA_PX * (edges.side[:, None] == np.arange(len(edges.corners_px)))
    causes = np.concatenate([edges.by_errors(errors, light), by_sides], axis=1)
    J = np.concatenate([edges.by_light[:, : len(parameters)], causes], axis=1)
    start, of_light = prior_of(light, height, with_nearness)
    of_light = of_light / (EDGE_SIGMA_PX**2 * POINTS_A_SAMPLE)
    prior = np.eye(J.shape[1])
    prior[: len(parameters), : len(parameters)] = of_light
    to_start = np.zeros(J.shape[1])
    to_start[: len(parameters)] = of_light @ (start - light[parameters])
    of_lights = np.eye(len(prior), len(parameters))  # of the inverse, only the light's columns are wanted
    left_px, variance = profiles.offset_px, EDGE_SIGMA_PX**2
    for number in range(ROUNDS):
        weight = profiles.weights(darkening, EARLY_LOSS if number == 0 else 1.0, left_px)
        weight = weight * informative_sides(profiles, weight, darkening, with_nearness)[edges.side]
        weighted = J.T * (weight / (POINTS_A_SAMPLE * variance))
        wanted = np.column_stack([weighted @ profiles.offset_px + to_start, of_lights])
        step, *by_lights = np.linalg.solve(weighted @ J + prior, wanted).T
        left_px = profiles.offset_px - J @ step
        variance = float((weight * left_px**2).sum() / max(float(weight.sum()), 1e-9)) + LEAST_SIGMA_PX**2
    return moved(light, step[: len(parameters)], height), np.array(by_lights)[:, : len(parameters)]
