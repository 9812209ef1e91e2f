"""Lamps near a known body: their distance shows in how its shadow grows with the height that casts it, and fans out."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import PoseShapeErrors
from ashe_live.light.known_body.found_light import FoundLight, image_beside, points_of
from ashe_live.light.known_body.outline.edge_image import EdgeImage
from ashe_live.light.known_body.outline.fit import NEAREST, ShadowFit, fitted, nearness_sigma
from ashe_live.light.known_body.outline.folded import beside_folds
from ashe_live.light.known_body.outline.odds import edge_log_odds
from ashe_live.light.known_body.seen import Seen

# Standard deviation of the body's width over its height, of bodies of which it is not known how they may be off: one
# wider by a hundredth casts the shadow of a lamp whose w / z is larger by a hundredth over that height.
FOLDED = 0.017
LAMP_ODDS = 0.5  # of a lamp near by over a sun, or what is as far as one, before the picture is seen
LEAST_SIGMAS = 4.0  # standard errors by which the nearness of a lamp must differ from that of a sun, 0
LEAST_INVERSE_DISTANCE = 0.4  # 1/m: a lamp farther away is as good as a sun
# The nearness is looked for so many standard deviations of the edges' about theirs, on grids of so many values, each
# about what the one before has found, where that is too coarse for it; and none is narrower than this, 1/m.
WITHIN_SIGMAS, GRID, GRIDS, LEAST_NEARNESS = 4.0, 9, 2, 1e-3
# What counts of the log likelihood of a light's fall over table and sides: sheen, a lens's dark corners and a table's
# own gradients look like it. By all of it the nearness of 28 path-traced lamps (the set cube_training, its scenes 0 to
# 29) was off by 1.7 of its standard deviations, root mean square.
OF_FALL = 1 / 3
# A rough table has other lines in reach of a shadow's edges, so that a lamp is also looked for from other starts: the
# length of its shadow, over that of the light that was found, and the body's height over the lamp's (of nine starts
# compared on scenes 0 to 59 of cube_training and 220 to 290 of cube_sealed, docs/accuracy/cube.md).
OTHER_STARTS = ((1.0, 0.3), (1.8, 0.3))
SURELY_NEAR = 2.0  # standard errors of a nearness, from which on a fitted light is no sun by its edges


@dataclass(frozen=True, slots=True, eq=False)
class _ByEdges:
    """A lamp by its shadow's edges."""

    light: Float  # (4,)
    covariance: Float  # (3, 3) of s and w / z, as the body may be off
    has_folds: bool  # whether that has in it how the body's frame may be off


@dataclass(frozen=True, slots=True)
class _Nearness:
    """The posterior of a light's nearness w / z."""

    sun: float  # probability that it is 0
    mean: float  # 1/m
    variance: float  # 1/m^2, with that of a lamp


def as_lamps(seen: Seen, found: Sequence[FoundLight], decided: int = 0) -> list[FoundLight]:
    """The lights: as lamps where their distance is determined; else as uncertain as they are if they may be lamps.

    decided: number of lights, the first ones, that were decided to be suns or lamps before, without some of the others:
    their angular sizes are known.
    """
    lights = []
    for number, one in enumerate(found):
        size_rad = one.size_rad if number < decided else None
        lights.append(_as_lamp(seen, one, [other for other in found if other is not one], size_rad))
    return lights


def _as_lamp(seen: Seen, one: FoundLight, others: Sequence[FoundLight], size_rad: float | None) -> FoundLight:
    """The light as a lamp, as a sun, or as a sun that may be a lamp: as its shadow's edges beside the others' have it.

    size_rad: its angular size, where that is known.
    """
    if one.fit is None:
        return one
    image = image_beside(seen, others)
    fit = _likeliest_fit(image, one, size_rad)
    edges = _of_folded_body(image, fit, one.darkening, seen.pose_shape_errors)
    if edges is None:
        return one
    nearness = _nearness(seen, edges, others)
    # By the edges, the displacement follows the nearness.
    by_nearness = edges.covariance[:, 2] / edges.covariance[2, 2]
    light = _along(edges.light, by_nearness, np.array([nearness.mean]))[0]
    covariance = edges.covariance + (nearness.variance - edges.covariance[2, 2]) * np.outer(by_nearness, by_nearness)
    inverse_distance = nearness.mean / float(np.linalg.norm(light[:3]))
    is_near = nearness.mean > LEAST_SIGMAS * math.sqrt(nearness.variance)
    if is_near and inverse_distance > LEAST_INVERSE_DISTANCE:
        fit = replace(fit, light=fit.light + light - edges.light)
        return replace(one, light=light, covariance=covariance, fit=fit, has_folds=edges.has_folds)
    if nearness.sun > 0.5:
        sun, as_sun = one.fit.light, one.fit.covariance[:2, :2]
        if sun[3] != 0:  # its edges were found as a lamp's
            sun = _along(edges.light, by_nearness, np.zeros(1))[0]
            as_sun = (edges.covariance - edges.covariance[2, 2] * np.outer(by_nearness, by_nearness))[:2, :2]
        # As uncertain as a sun is by its edges, and as the nearness leaves it, whose mean is not what is stated.
        squared = nearness.variance + nearness.mean**2
        own = as_sun + squared * np.outer(by_nearness[:2], by_nearness[:2])
        return replace(one, light=sun, covariance=own, may_be_lamp=False, has_folds=False)
    sun_or_lamp = replace(one, light=light * (1, 1, 1, 0), covariance=covariance[:2, :2])
    return replace(sun_or_lamp, may_be_lamp=True, has_folds=edges.has_folds)


def _likeliest_fit(image: EdgeImage, one: FoundLight, size_rad: float | None) -> ShadowFit:
    """Of fits with the nearness free, from several starts, by the odds of their edges.

    The light's own where none is as likely: a fit that ends on wrong edges is no evidence on how near the light is.
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


def _of_folded_body(
    image: EdgeImage, fit: ShadowFit, darkening: float, errors: PoseShapeErrors | None
) -> _ByEdges | None:
    """The light of a fit, with its nearness, as the body may be off by its errors.

    None where these are not known and the nearness was not fitted: nothing then says how the edges move with it.
    """
    adjusted = None if errors is None else beside_folds(fit, image, darkening, errors, with_nearness=True)
    if adjusted is not None:
        return _ByEdges(*adjusted, has_folds=True)
    if len(fit.covariance) < 3:
        return None
    # A wider body casts the shadow of a nearer lamp, which ends at the same place: s / (1 - height w / z).
    end = fit.light[:2] / (1 - image.height_m * fit.light[3])
    by_width = FOLDED * np.append(-end, 1 / image.height_m)
    return _ByEdges(fit.light, fit.covariance + np.outer(by_width, by_width), has_folds=False)


def _nearness(seen: Seen, edges: _ByEdges, others: Sequence[FoundLight]) -> _Nearness:
    """By a light's edges, the map, and the sides, beside other lights.

    A lamp's light falls off over the table, and gives more to what is nearer to it.
    """
    light, covariance = edges.light, edges.covariance
    by_nearness, sigma = covariance[:, 2] / covariance[2, 2], math.sqrt(covariance[2, 2])
    beside = seen.beside(points_of(others))
    most = NEAREST / seen.body.height_m
    low, high = (float(np.clip(light[3] + sign * WITHIN_SIGMAS * sigma, 0.0, most)) for sign in (-1, 1))
    # Edges that exclude any lamp leave nothing to look for.
    mean, variance, sun = float(np.clip(light[3], 0.0, most)), sigma**2, float(high < LEAST_NEARNESS)
    for number in range(GRIDS):
        if high - low < LEAST_NEARNESS:
            break
        grid = np.append(np.linspace(low, high, GRID), 0.0)
        by_map = beside.scanned(seen.lit(_along(light, by_nearness, grid))).log_likelihood
        score = OF_FALL * by_map - 0.5 * ((grid - light[3]) / sigma) ** 2
        likelihood = np.exp(score - score.max())
        weight = likelihood[:-1] / max(float(likelihood[:-1].sum()), 1e-300)
        mean = float(weight @ grid[:-1])
        variance = float(weight @ (grid[:-1] - mean) ** 2) + (grid[1] - grid[0]) ** 2 / 12
        if number == 0:
            # The edges' fit has the prior of a lamp's nearness in it, so that at 0 a sun's has to be taken out.
            density = LAMP_ODDS * math.sqrt(2 / math.pi) / nearness_sigma(light)
            lamp = float(likelihood[:-1].mean()) * (high - low) * density
            sun = float(likelihood[-1]) / (float(likelihood[-1]) + lamp)
        if variance > (grid[1] - grid[0]) ** 2:
            break
        spread = WITHIN_SIGMAS * math.sqrt(variance)
        low, high = max(low, mean - spread), min(high, mean + spread)
    by_both = (1 - sun) * (variance + sun * mean**2)
    return _Nearness(sun, (1 - sun) * mean, by_both + sun * LEAST_NEARNESS**2)


def _along(light: Float, by_nearness: Float, nearness: Float) -> Float:
    """(m, 4) a light (4,), z = 1, with m other values of w / z, and what else the edges then say."""
    lights = np.tile(light, (len(nearness), 1))
    away = nearness - light[3]
    lights[:, :2] += away[:, None] * by_nearness[:2]
    lights[:, 3] = nearness
    return lights
