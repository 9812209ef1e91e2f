"""Lamps beside a known body: how near a light is shows in how its shadow fans out, and in how its light falls off.

The nearness of a light (x, y, z, w) is w / z: one over its height above the plane, 1/m, and 0 for a sun. Its
displacement is s = (x, y) / z (docs/maths, "A known body").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ashe_live.core.arrays import Float, without
from ashe_live.light.known_body.found_light import FoundLight, images_beside, points_of
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.outline.by_edges import ByEdges, by_edges
from ashe_live.light.known_body.outline.confirmed import confirmed
from ashe_live.light.known_body.outline.fit import NEAREST, ShadowFit, fitted, nearness_sigma
from ashe_live.light.known_body.outline.odds import edge_log_odds
from ashe_live.light.known_body.outline.profiles import EdgeImage
from ashe_live.light.known_body.seen import Seen

LAMP_ODDS = 0.5  # prior odds of a lamp near by against a sun, or a lamp as far as one
LEAST_SIGMAS = 4.0  # standard deviations by which the nearness of what is stated as a lamp differs from a sun's
LEAST_INVERSE_DISTANCE = 0.4  # 1/m: a lamp farther away is as good as a sun
# The posterior of the nearness is sampled on a grid that reaches this many of the edges' standard deviations to both
# sides of their nearness; where that is too coarse, on one more about what the first has found. 1/m: the narrowest
# range that is worth a grid.
WITHIN_SIGMAS, GRID_POINTS, GRIDS, LEAST_RANGE = 4.0, 9, 2, 1e-3
# The share that counts of the log likelihood of a light's fall over table and sides, which sheen, a lens's dark corners
# and the table's own gradients resemble. With all of it, the nearness of 28 path-traced lamps (scenes 0 to 29 of the
# set cube_training) was off by 1.7 of its standard deviations, root mean square.
FALL_SHARE = 1 / 3
# A rough table has other lines within reach of a shadow's edges, so that fits of a lamp also start from elsewhere. Each
# start: the length of its shadow over that of the light found before, and the body's height over the lamp's. They are
# the best of nine that were compared (on scenes 0 to 59 of cube_training and 220 to 290 of cube_sealed,
# docs/accuracy/cube.md).
OTHER_STARTS = ((1.0, 0.3), (1.8, 0.3))
SURELY_NEAR = 2.0  # standard deviations of a fit's nearness, from which on its edges are no sun's


@dataclass(frozen=True, slots=True)
class _Nearness:
    """The posterior of a light's nearness."""

    sun: float  # probability that it is 0
    mean: float  # 1/m, over suns and lamps
    variance: float  # 1/m^2, likewise


def as_lamps(seen: Seen, found: Sequence[FoundLight], decided: int = 0) -> list[FoundLight]:
    """The lights as lamps where their distance is determined, else as suns, as uncertain as that leaves them.

    decided: the number of lights, the first ones, that have been through this before, without some of the others: their
    angular sizes are known.
    """
    return [
        _as_lamp(seen, one, without(found, [one]), one.size_rad if number < decided else None)
        for number, one in enumerate(found)
    ]


def _as_lamp(seen: Seen, one: FoundLight, others: Sequence[FoundLight], size_rad: float | None) -> FoundLight:
    """The light as a lamp, as a sun, or as a sun that may be a lamp, by its shadow's edges beside the others' shadows.

    size_rad: its angular size, where that is known.
    """
    if one.fit is None:
        return one
    images = images_beside(seen, others)
    fit = confirmed(_likeliest_fit(images.of(one.fit.view), one, size_rad), images, one.darkening)
    edges = by_edges(images, fit, one.darkening)
    if edges is None:
        return one
    nearness = _nearness(seen, edges, others)
    light, covariance = edges.stated(nearness.mean, nearness.variance)
    inverse_distance = nearness.mean / float(np.linalg.norm(light[:3]))
    is_near = nearness.mean > LEAST_SIGMAS * math.sqrt(nearness.variance)
    if is_near and inverse_distance > LEAST_INVERSE_DISTANCE:
        return replace(one, light=light, covariance=covariance, fit=fit, has_folds=edges.has_folds)
    if nearness.sun > 0.5:
        return _as_sun(one, one.fit, edges, nearness)
    sun_or_lamp = replace(one, light=light * (1, 1, 1, 0), covariance=covariance[:2, :2])
    return replace(sun_or_lamp, may_be_lamp=True, has_folds=edges.has_folds)


def _as_sun(one: FoundLight, own: ShadowFit, edges: ByEdges, nearness: _Nearness) -> FoundLight:
    """The light as the sun that its edges show, as uncertain as its nearness leaves it. own: the light's own fit."""
    sun, covariance = own.light, own.covariance[:2, :2]
    if sun[3] != 0:  # the light was found as a lamp
        sun, with_nearness = edges.stated(0.0, 0.0)
        covariance = with_nearness[:2, :2]
    # The mean square about 0, as it is not the mean of the nearness that is stated.
    mean_square = nearness.variance + nearness.mean**2
    line = edges.by_nearness[:2]
    covariance = covariance + mean_square * np.outer(line, line)
    return replace(one, light=sun, covariance=covariance, may_be_lamp=False, has_folds=False)


def _likeliest_fit(image: EdgeImage, one: FoundLight, size_rad: float | None) -> ShadowFit:
    """The fit with the largest odds of its edges: the light's own, or one of those with the nearness free.

    If that is its own, the others ended on wrong edges, and are no evidence on how near the light is.
    """
    assert one.fit is not None
    fitted_from = partial(fitted, image, darkening=one.darkening, with_nearness=True, size_rad=size_rad)
    light, height = one.casting / one.casting[2], image.height_m
    first = fitted_from(light)
    fits = [each for each in (first, one.fit) if each is not None]
    # A sun's straight edges are found from any start, and those of a light whose size is known were found before.
    if first is max(fits, key=edge_log_odds) and (size_rad is not None or _may_be_sun(first)):
        return first
    end = light[:2] / (1 - height * light[3])
    starts = [np.array([*(longer * (1 - sunk) * end), 1.0, sunk / height]) for longer, sunk in OTHER_STARTS]
    others = map(fitted_from, starts)
    return max([*fits, *(each for each in others if each is not None)], key=edge_log_odds)


def _may_be_sun(fit: ShadowFit) -> bool:
    return bool(abs(fit.light[3]) < SURELY_NEAR * math.sqrt(fit.covariance[2, 2]))


def _nearness(seen: Seen, edges: ByEdges, others: Sequence[FoundLight]) -> _Nearness:
    """The nearness by a light's edges, the map, and the sides, beside other lights.

    A lamp's light falls off over the table, and gives more to what is nearer to it.
    """
    beside = seen.beside(points_of(others))
    most = NEAREST / seen.body.height_m
    reach = WITHIN_SIGMAS * edges.nearness_sigma
    low, high = (float(np.clip(edges.nearness + sign * reach, 0.0, most)) for sign in (-1, 1))
    mean, variance = float(np.clip(edges.nearness, 0.0, most)), edges.nearness_sigma**2
    sun = float(high < LEAST_RANGE)  # edges that exclude any lamp leave nothing to look for
    for number in range(GRIDS):
        if high - low < LEAST_RANGE:
            break
        grid = np.linspace(low, high, GRID_POINTS)
        spacing = grid[1] - grid[0]
        likelihoods = _likelihoods(seen, beside, edges, np.append(grid, 0.0))
        of_lamps, of_sun = likelihoods[:-1], float(likelihoods[-1])
        weight = of_lamps / max(float(of_lamps.sum()), 1e-300)
        mean = float(weight @ grid)
        variance = float(weight @ (grid - mean) ** 2) + spacing**2 / 12
        if number == 0:
            # The edges' fit has the prior of a lamp's nearness in it: at 0 its density has to be taken out for a sun.
            density = LAMP_ODDS * math.sqrt(2 / math.pi) / nearness_sigma(edges.light)
            of_lamp = float(of_lamps.mean()) * (high - low) * density
            sun = of_sun / (of_sun + of_lamp)
        if variance > spacing**2:
            break
        reach = WITHIN_SIGMAS * math.sqrt(variance)
        low, high = max(low, mean - reach), min(high, mean + reach)
    # Mean and variance of the mixture of a sun and a lamp.
    of_mixture = (1 - sun) * (variance + sun * mean**2)
    return _Nearness(sun, (1 - sun) * mean, of_mixture + sun * LEAST_RANGE**2)


def _likelihoods(seen: Seen, beside: MarginalLikelihood, edges: ByEdges, nearness: Float) -> Float:
    """(m,) likelihoods of values of the nearness (m,) by edges, map and sides, over the largest of them."""
    lights, of_edges = edges.lights_at(nearness)
    by_fall = beside.scanned(seen.lit(lights)).log_likelihood
    score = FALL_SHARE * by_fall + of_edges
    return np.asarray(np.exp(score - score.max()))
