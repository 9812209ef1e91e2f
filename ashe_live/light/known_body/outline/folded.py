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
from ashe_live.light.known_body.outline.profiles import POINTS_A_SAMPLE, EdgeImage, EdgeImages

ROUNDS = 4  # of reweighted least squares
AGREE_SIGMAS = 3.0  # Mahalanobis distance between the lights by two pictures, up to which they agree


def beside_folds(
    fit: ShadowFit, images: EdgeImages, darkening: float, with_nearness: bool
) -> tuple[Float, Float] | None:
    """The light (4,), z = 1, as it is if the body is off as the edges of a fit say, and its (p, p) covariance: of
    s = (x, y) / z and, `with_nearness`, of w / z. None where the shadow has no edges in the picture of the fit, and
    where it is not known how the body may be off there.

    By that picture, and those others that show the shadow and agree: their mean. As the same folds are behind all of
    them, it is as uncertain as they are on average (covariance intersection, Julier and Uhlmann, 1997).

    darkening: the part of the table's light that it gives, roughly.
    """
    own = _beside_folds_in(images.of(fit.view), fit, darkening, with_nearness)
    if own is None:
        return None
    showing = images.others_showing(fit.light, fit.view)
    others = [_beside_folds_in(image, fit, darkening, with_nearness) for image in showing]
    parameters = [0, 1, 3] if with_nearness else [0, 1]
    agreeing = [each for each in others if each is not None and _agree(each, own, parameters)]
    if not agreeing:
        return own
    found = sorted([own, *agreeing], key=lambda each: float(np.linalg.det(each[1])))
    information = np.array([np.linalg.inv(covariance) for _, covariance in found])
    # A vague one has nothing to say beside an exact one.
    together = [count * np.linalg.inv(information[:count].sum(axis=0)) for count in range(1, len(found) + 1)]
    best = min(range(len(found)), key=lambda number: float(np.linalg.det(together[number])))
    values = np.array([light[parameters] for light, _ in found[: best + 1]])
    light = own[0].copy()
    light[parameters] = together[best] @ np.einsum("nij,nj->i", information[: best + 1], values) / (best + 1)
    return light, together[best]


def _agree(one: tuple[Float, Float], other: tuple[Float, Float], parameters: list[int]) -> bool:
    """Whether two lights with their covariances may be the same."""
    away = one[0][parameters] - other[0][parameters]
    return bool(away @ np.linalg.solve(one[1] + other[1], away) < AGREE_SIGMAS**2)


def _beside_folds_in(
    image: EdgeImage, fit: ShadowFit, darkening: float, with_nearness: bool
) -> tuple[Float, Float] | None:
    """As `beside_folds`, by one picture."""
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
