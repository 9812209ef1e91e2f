"""How the light falls over the lit ground: it tells a lamp from a sun, and about how far the lamp is.

A lamp at (X, Y, Z) lights a point p of the plane by Z / |X - p|^3, which is (1 + |s - p w / z|^2)^(-3/2) in the
light's parameters but for a factor; a sun lights all of it alike. The picture's brightness also has the ground's paint
and texture, vignetting, and what else is uneven (sheen, relief, a wall near by, the camera's tone mapping). Vignetting
and a little unevenness are fitted along; the rest has its own, larger variance (docs/maths.md, "The fall of light").
Paint and texture are noise that is correlated over their size. No colour has a level of its own: a plain ground's
colours are the steps of its own brightness, and their levels would explain a lamp away.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.slow_shading import irradiances
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View

BESIDE_PX = 4  # of the coarse picture: ground nearer than this to an object or a shadow is not lit as the rest
LIT = 6.0  # largest squared distance of a lit pixel's colour from the ground's palette
CLIPPED = 250  # value of the brightest channel from which on it tells nothing
SAMPLES, FEWEST = 1500, 300  # pixels of lit ground: as many as are used, and as few as tell anything
CELLS = (12, 9)  # in which samples' errors may be correlated: texture is larger than a pixel
# Sigmas of what is fitted along: vignetting at the picture's corner (of log brightness), the ground's own unevenness as
# a gradient (1/m) and a curvature (1/m^2) of log irradiance, and the camera's contrast beside that of sRGB.
VIGNETTING, GRADIENT, CURVATURE, CONTRAST = 0.2, 0.03, 0.05, 0.1
# The same of what a picture in a hundred shows and no lamp causes: sheen towards the light, the bumps of a rough
# ground in low light, a shadow's soft rim, tone mapping that differs from place to place.
WORST_GRADIENT, WORST_CURVATURE, WORST_CONTRAST = 0.25, 0.4, 0.3
LEAST_CONTRAST, MOST_CONTRAST = 0.3, 3.0
ROBUST_ROUNDS = 6
LEAST_NOISE = 0.01  # of log brightness


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """What the fall of light tells near some parameters of a light: a pull towards others, linearised there."""

    gradient: Float  # (3,) information times the offset of displacement and nearness
    information: Float  # (3, 3) on these, positive semi-definite
    cost: float  # twice the negative log likelihood of the light, without what worst unevenness may explain
    worst_cost: float  # the same, with all that it may explain


@dataclass(frozen=True, slots=True, eq=False)
class FallOff:
    """The log brightness of lit ground, and what beside a lamp may cause it."""

    places: Float  # (n, 2) metres on the plane, marker frame
    brightness: Float  # (n,) log of linear light
    weights: Float  # (n,) information on each sample
    fitted: Float  # (n, c) what is fitted along: level, vignetting, gradient and curvature
    factor: Float  # (c, c) Cholesky factor of the information on these, with their priors
    uneven: Float  # (n, 5) gradient and curvature

    @staticmethod
    def of(view: View, ground: LitGround, free: Mask) -> "FallOff | None":
        """Of the lit ground in `free` (h, w), away from objects and shadows; None where too little of it is seen.

        view: the one that `ground` was fitted to.
        """
        exposed = view.image_bgr.max(axis=2) < CLIPPED
        lit = np.flatnonzero(free & exposed & view.is_ground & (ground.squared_distance < LIT))
        if len(lit) < FEWEST:
            return None
        chosen = lit if len(lit) <= SAMPLES else np.sort(np.random.default_rng(0).choice(lit, SAMPLES, replace=False))
        brightness = log_opponent(view.image_bgr)[..., 0].ravel()[chosen].astype(np.float64)
        rows, columns = np.divmod(chosen, view.size[0])
        places = _on_ground(view, columns, rows)
        uneven = _uneven(places - places.mean(axis=0))
        fitted = np.column_stack([np.ones(len(chosen)), _vignetting(view, columns, rows), uneven])
        cells = rows * CELLS[1] // view.size[1] * CELLS[0] + columns * CELLS[0] // view.size[0]
        weights = _robust_weights(brightness, fitted, cells, uneven.shape[1] + 1)
        prior: Float = np.array([1e-6, 1 / VIGNETTING**2, *[1 / GRADIENT**2] * 2, *[1 / CURVATURE**2] * 3])
        information = (fitted * weights[:, None]).T @ fitted + np.diag(prior)
        factor = np.asarray(np.linalg.cholesky(information), dtype=np.float64)
        return FallOff(places, brightness, weights, fitted, factor, uneven)

    def pull(self, parameters: Float, shares: Sequence[float], reference: Float, number: int = 0) -> Pull:
        """The pull on light `number` of l lights whose displacements and nearness are `parameters` (l, 3).

        shares: each light's share of all light on the plane at `reference` (2,), as its shadow there tells.
        """
        log_light, slopes = log_irradiance(self.places, parameters, shares, reference, number)
        rest = self.brightness - log_light
        gram = self._gram(np.column_stack([slopes, self.uneven, log_light, rest]))
        tone, told = -2, -1
        # The contrast's offset from 1, fitted with its prior, then eliminated.
        stiff = gram[tone, tone] + 1 / CONTRAST**2
        contrast = float(np.clip(1 + gram[tone, told] / stiff, LEAST_CONTRAST, MOST_CONTRAST))
        gram = gram - np.outer(gram[:, tone], gram[tone]) / stiff
        gradient, information = contrast * gram[:3, told], contrast**2 * gram[:3, :3]
        worst = np.array([WORST_GRADIENT] * 2 + [WORST_CURVATURE] * 3 + [WORST_CONTRAST])
        through = contrast * gram[:3, 3 : 3 + len(worst)] * worst
        # The covariance of the gradient: noise, and the worst unevenness (a "sandwich", after Huber, 1967).
        spread = information + through @ through.T
        spread += (1e-9 * np.trace(spread) + 1e-12) * np.eye(3)
        trusted = information @ np.linalg.inv(spread)
        told_of = trusted @ information
        uneven = slice(3, 3 + len(worst))
        stiffness = gram[uneven, uneven] + np.diag(1 / worst**2)
        explained = float(gram[uneven, told] @ np.linalg.solve(stiffness, gram[uneven, told]))
        cost = float(gram[told, told])
        return Pull(trusted @ gradient, np.asarray(0.5 * (told_of + told_of.T)), cost, cost - explained)

    def worst_costs(self, parameters: Float, share: float, reference: Float) -> Float:
        """(n,) `Pull.worst_cost` of n single lights with parameters (n, 3), all of one share, as in `pull`."""
        relative = irradiances(self.places, parameters) / irradiances(reference[None], parameters)
        lights = np.log(np.maximum(1 - share + share * relative, 1e-3))
        known = np.column_stack([self.uneven, self.brightness])
        both = self._gram(np.column_stack([known, lights]))
        uneven, told, of_light = slice(0, 5), 5, slice(6, None)
        square, with_told = np.diag(both)[of_light], both[told, of_light]
        # As in `pull`: inner products of unevenness and contrast with one another, and with what the light leaves.
        columns = np.empty((len(parameters), 6, 7))
        columns[:, :5, :5] = both[uneven, uneven]
        columns[:, :5, 5] = columns[:, 5, :5] = both[uneven, of_light].T
        columns[:, 5, 5] = square
        columns[:, :5, 6] = both[uneven, told] - both[uneven, of_light].T
        columns[:, 5, 6] = with_told - square
        cost = both[told, told] - 2 * with_told + square
        stiff = square + 1 / CONTRAST**2
        cost -= columns[:, 5, 6] ** 2 / stiff
        columns = columns - columns[:, :, 5:6] * columns[:, 5:6] / stiff[:, None, None]
        worst = np.array([WORST_GRADIENT] * 2 + [WORST_CURVATURE] * 3 + [WORST_CONTRAST])
        explained = np.linalg.solve(columns[:, :, :6] + np.diag(1 / worst**2), columns[:, :, 6:])
        return np.asarray(cost - (columns[:, :, 6:] * explained).sum(axis=(1, 2)))

    def _gram(self, columns: Float) -> Float:
        """(k, k) weighted inner products of columns (n, k), without what can be fitted along."""
        weighted = columns * self.weights[:, None]
        through = np.linalg.solve(self.factor, self.fitted.T @ weighted)
        return np.asarray(columns.T @ weighted - through.T @ through)


def clear_of(taken: Mask) -> Mask:
    """(h, w) the ground that is lit as the rest, away from objects and shadows (h, w)."""
    return ~grown(taken, BESIDE_PX)


def log_irradiance(
    places: Float, parameters: Float, shares: Sequence[float], reference: Float, number: int
) -> tuple[Float, Float]:
    """(n,) log of all light at places (n, 2) over that at `reference` (2,); (n, 3) its slopes by light `number`.

    Arguments as in `FallOff.pull`; what is no light's share is the same everywhere.
    """
    total = np.full(len(places), 1.0 - sum(shares))
    slopes = np.zeros((len(places), 3))
    for i, (light, share) in enumerate(zip(parameters, shares, strict=True)):
        here, by_light = _log_fall(places, light)
        there, by_light_there = _log_fall(reference[None], light)
        part = share * np.exp(here - there)
        total += part
        if i == number:
            slopes = part[:, None] * (by_light - by_light_there)
    total = np.maximum(total, 1e-3)
    return np.log(total), slopes / total[:, None]


def _log_fall(places: Float, light: Float) -> tuple[Float, Float]:
    """(n,) log of (1 + |s - p w / z|^2)^(-3/2) at places (n, 2), and (n, 3) its slopes by s and w / z (3,)."""
    aside = light[:2] - light[2] * places
    squared = 1 + (aside**2).sum(axis=1)
    by_displacement = -3 * aside / squared[:, None]
    return -1.5 * np.log(squared), np.column_stack([by_displacement, -(by_displacement * places).sum(axis=1)])


def _on_ground(view: View, columns: NDArray[np.intp], rows: NDArray[np.intp]) -> Float:
    """(n, 2) metres on the plane, of pixels on the ground."""
    pixels = np.stack([columns, rows, np.ones(len(rows))])
    on_plane = np.linalg.solve(image_from_plane(view.camera, view.T_cam_marker), pixels)
    return np.asarray((on_plane[:2] / on_plane[2]).T)


def _vignetting(view: View, columns: NDArray[np.intp], rows: NDArray[np.intp]) -> Float:
    """(n,) squared distance from the principal point, 1 at half the picture's diagonal."""
    x, y = view.camera.K[:2, 2]
    return np.asarray(((columns - x) ** 2 + (rows - y) ** 2) / (math.hypot(*view.size) / 2) ** 2)


def _uneven(places: Float) -> Float:
    """(n, 5) the two linear and three quadratic functions of places (n, 2)."""
    x, y = places.T
    return np.column_stack([x, y, x * x, x * y, y * y])


def _robust_weights(brightness: Float, fitted: Float, cells: NDArray[np.intp], smooth: int) -> Float:
    """(n,) information on each sample's brightness: Cauchy's weights over the noise, and over the design effect.

    From a fit of any smooth brightness, so that neither a lamp nor a sun is favoured. The design effect is that of
    correlated errors within `cells` (n,) on the last `smooth` columns of `fitted` (Liang and Zeger, 1986).
    """
    weights, noise = np.ones(len(brightness)), 1.0
    rest = brightness
    for _ in range(ROBUST_ROUNDS):
        weighted = fitted * weights[:, None]
        ridge = 1e-6 * np.eye(fitted.shape[1])
        rest = brightness - fitted @ np.linalg.solve(weighted.T @ fitted + ridge, weighted.T @ brightness)
        noise = 1.48 * float(np.median(np.abs(rest))) + LEAST_NOISE
        weights = 1 / (1 + (rest / (2 * noise)) ** 2)
    bread = np.linalg.inv((fitted * weights[:, None]).T @ fitted + 1e-6 * np.eye(fitted.shape[1]))
    scores = fitted * (weights * rest)[:, None]
    of_cells = np.zeros((int(cells.max()) + 1, fitted.shape[1]))
    np.add.at(of_cells, cells, scores)
    together, apart = (
        (bread @ (each.T @ each) @ bread)[-smooth:, -smooth:] + 1e-12 * np.eye(smooth) for each in (of_cells, scores)
    )
    effect = max(1.0, float(np.trace(np.linalg.solve(apart, together))) / smooth)
    return np.asarray(weights / (noise**2 * effect))
