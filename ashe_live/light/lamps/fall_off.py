"""How the light falls over the lit ground: it tells a lamp from a sun, and about how far the lamp is.

A lamp at (X, Y, Z) lights a point p of the plane by Z / |X - p|^3, which is (1 + |s - p w / z|^2)^(-3/2) in the
light's parameters but for a factor; a sun lights all of it alike. A glossy ground mirrors either on top of that. The
picture's brightness also has the ground's paint and texture, vignetting, and what else is uneven (relief, a wall near
by, the camera's tone mapping). Vignetting and a little unevenness are fitted along; the rest has its own, larger
variance (docs/maths.md, "The fall of light"). Paint and texture are noise that is correlated over their size. No colour
has a level of its own: a plain ground's colours are the steps of its own brightness, and their levels would explain a
lamp away. Surfaces that an edge divides have one.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import camera_centre, image_from_plane
from ashe_live.light.ground.gloss import Gloss, mirrored
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.slow_shading import irradiances, log_irradiance
from ashe_live.light.ground.surfaces import surfaces
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
LEVEL = 0.5  # the same of a surface's log albedo, beside that of the largest
LARGEST_LEVEL = 1e3  # and of that one's: any
# The same of what a picture in a hundred shows and no lamp causes: sheen towards the light, the bumps of a rough
# ground in low light, a shadow's soft rim, tone mapping that differs from place to place.
WORST_GRADIENT, WORST_CURVATURE, WORST_CONTRAST = 0.25, 0.4, 0.3
WORST = np.array([WORST_GRADIENT] * 2 + [WORST_CURVATURE] * 3 + [WORST_CONTRAST])
LEAST_CONTRAST, MOST_CONTRAST = 0.3, 3.0
FAR = 0.2  # 1/m, nearness up to which a light is a sun to the ground's gloss
ROBUST_ROUNDS = 6
BLOCK = 40  # lights that are tried at once: what is computed of them then fits into the processor's cache
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
    fitted: Float  # (n, c) what is fitted along: levels, vignetting, gradient and curvature
    factor: Float  # (c, c) Cholesky factor of the information on these, with their priors
    uneven: Float  # (n, 5) gradient and curvature
    eye: Float  # (3,) the camera's centre, metres, marker frame
    gloss: Gloss | None = None  # of the ground under a sun: what it mirrors of one may be part of its light, or not

    @staticmethod
    def of(view: View, ground: LitGround, free: Mask) -> "FallOff | None":
        """Of the lit ground in `free` (h, w), away from objects and shadows; None where too little of it is seen.

        view: the one that `ground` was fitted to.
        """
        exposed = view.image_bgr.max(axis=2) < CLIPPED
        seen = free & view.is_ground
        parts = surfaces(view.image_bgr, seen) if ground.divided else seen.astype(np.int32)
        lit = np.flatnonzero((parts > 0) & exposed & (ground.squared_distance < LIT))
        if len(lit) < FEWEST:
            return None
        chosen = lit if len(lit) <= SAMPLES else np.sort(np.random.default_rng(0).choice(lit, SAMPLES, replace=False))
        brightness = log_opponent(view.image_bgr)[..., 0].ravel()[chosen].astype(np.float64)
        rows, columns = np.divmod(chosen, view.size[0])
        places = _on_ground(view, columns, rows)
        uneven = _uneven(places - places.mean(axis=0))
        part = parts.ravel()[chosen]
        levels = part[:, None] == np.arange(2, part.max() + 1)
        fitted = np.column_stack([np.ones(len(chosen)), levels, _vignetting(view, columns, rows), uneven])
        cells = rows * CELLS[1] // view.size[1] * CELLS[0] + columns * CELLS[0] // view.size[0]
        weights = _robust_weights(brightness, fitted, cells, uneven.shape[1] + 1)
        factor = _factor(fitted, weights)
        gloss = None if ground.fall is None else ground.fall.gloss
        return FallOff(places, brightness, weights, fitted, factor, uneven, camera_centre(view.T_cam_marker), gloss)

    def every(self, step: int) -> "FallOff":
        """Every `step`-th sample, which counts as much more: for a first look at many lights."""
        some = slice(None, None, step)
        weights, fitted = self.weights[some] * step, self.fitted[some]
        return replace(
            self,
            places=self.places[some],
            brightness=self.brightness[some],
            weights=weights,
            fitted=fitted,
            factor=_factor(fitted, weights),
            uneven=self.uneven[some],
        )

    def pull(self, parameters: Float, shares: Sequence[float], reference: Float, number: int = 0) -> Pull:
        """The pull on light `number` of l lights whose displacements and nearness are `parameters` (l, 3).

        shares: each light's share of all light on the plane at `reference` (2,), as its shadow there tells.
        """
        lit = partial(log_irradiance, self.places, parameters, shares, reference, number)
        with_gloss = [] if self.gloss is None else [lit(self._mirrored(parameters, self.gloss))]
        return min((self._pull(*each) for each in (lit(), *with_gloss)), key=attrgetter("worst_cost"))

    def _pull(self, log_light: Float, slopes: Float) -> Pull:
        """As `pull`, by the log of all light (n,) and its slopes (n, 3)."""
        rest = self.brightness - log_light
        gram = self._gram(np.column_stack([slopes, self.uneven, log_light, rest]))
        tone, told = -2, -1
        # The contrast's offset from 1, fitted with its prior, then eliminated.
        stiff = gram[tone, tone] + 1 / CONTRAST**2
        contrast = float(np.clip(1 + gram[tone, told] / stiff, LEAST_CONTRAST, MOST_CONTRAST))
        gram = gram - np.outer(gram[:, tone], gram[tone]) / stiff
        gradient, information = contrast * gram[:3, told], contrast**2 * gram[:3, :3]
        through = contrast * gram[:3, 3 : 3 + len(WORST)] * WORST
        # The covariance of the gradient: noise, and the worst unevenness (a "sandwich", after Huber, 1967).
        spread = information + through @ through.T
        spread += (1e-9 * np.trace(spread) + 1e-12) * np.eye(3)
        trusted = information @ np.linalg.inv(spread)
        told_of = trusted @ information
        uneven = slice(3, 3 + len(WORST))
        stiffness = gram[uneven, uneven] + np.diag(1 / WORST**2)
        explained = float(gram[uneven, told] @ np.linalg.solve(stiffness, gram[uneven, told]))
        cost = float(gram[told, told])
        return Pull(trusted @ gradient, np.asarray(0.5 * (told_of + told_of.T)), cost, cost - explained)

    def worst_costs(self, parameters: Float, share: float, reference: Float) -> Float:
        """(n,) `Pull.worst_cost` of n single lights with parameters (n, 3), all of one share, as in `pull`."""
        known = np.column_stack([self.uneven, self.brightness])
        of_known = known, self._gram(known), self._weighted(known)[1]
        blocks = range(0, len(parameters), BLOCK)
        return np.concatenate(
            [self._worst_costs(parameters[i : i + BLOCK], share, reference, *of_known) for i in blocks]
        )

    def _worst_costs(
        self, parameters: Float, share: float, reference: Float, known: Float, among: Float, known_explained: Float
    ) -> Float:
        """As `worst_costs`. known: (n, 6) unevenness and brightness; (6, 6) their inner products; (c, 6) as what can be
        fitted along.
        """
        relative = irradiances(self.places, parameters) / irradiances(reference[None], parameters)
        suns = np.flatnonzero(parameters[:, 2] <= FAR)
        if self.gloss is not None:
            glossy = 1 + mirrored(self.places, self.eye, parameters[suns], self.gloss)  # 1 of lamps
            relative = np.hstack([relative, relative[:, suns] * glossy])
        lights = np.log(np.maximum(1 - share + share * relative, 1e-3))
        weighted, explained = self._weighted(lights)
        by_light = known.T @ weighted - known_explained.T @ explained
        square = (lights * weighted).sum(axis=0) - (explained**2).sum(axis=0)
        uneven, told, with_told = slice(0, 5), 5, by_light[5]
        # As in `pull`: inner products of unevenness and contrast with one another, and with what the light leaves.
        columns = np.empty((lights.shape[1], 6, 7))
        columns[:, :5, :5] = among[uneven, uneven]
        columns[:, :5, 5] = columns[:, 5, :5] = by_light[uneven].T
        columns[:, 5, 5] = square
        columns[:, :5, 6] = among[uneven, told] - by_light[uneven].T
        columns[:, 5, 6] = with_told - square
        cost = among[told, told] - 2 * with_told + square
        stiff = square + 1 / CONTRAST**2
        cost -= columns[:, 5, 6] ** 2 / stiff
        columns = columns - columns[:, :, 5:6] * columns[:, 5:6] / stiff[:, None, None]
        stiffness = columns[:, :, :6] + np.diag(1 / WORST**2)
        cost -= (columns[:, :, 6:] * np.linalg.solve(stiffness, columns[:, :, 6:])).sum(axis=(1, 2))
        least = cost[: len(parameters)]
        if self.gloss is not None:
            least[suns] = np.minimum(least[suns], cost[len(parameters) :])
        return np.asarray(least)

    def _mirrored(self, parameters: Float, gloss: Gloss) -> Float:
        """(n, l) what the ground mirrors of each light (l, 3), over what it scatters; 0 of lamps."""
        found = np.zeros((len(self.places), len(parameters)))
        suns = parameters[:, 2] <= FAR
        found[:, suns] = mirrored(self.places, self.eye, parameters[suns], gloss)
        return found

    def _gram(self, columns: Float) -> Float:
        """(k, k) weighted inner products of columns (n, k), without what can be fitted along."""
        weighted, explained = self._weighted(columns)
        return np.asarray(columns.T @ weighted - explained.T @ explained)

    def _weighted(self, columns: Float) -> tuple[Float, Float]:
        """(n, k) columns times the samples' weights; (c, k) what can be fitted along, in an orthonormal basis."""
        weighted = columns * self.weights[:, None]
        return weighted, np.asarray(np.linalg.solve(self.factor, self.fitted.T @ weighted))


def clear_of(taken: Mask) -> Mask:
    """(h, w) the ground that is lit as the rest, away from objects and shadows (h, w)."""
    return ~grown(taken, BESIDE_PX)


def _factor(fitted: Float, weights: Float) -> Float:
    """(c, c) Cholesky factor of the information by samples with weights (n,) on what is fitted, and of its priors."""
    others = (VIGNETTING, *[GRADIENT] * 2, *[CURVATURE] * 3)
    further_levels = fitted.shape[1] - 1 - len(others)
    sigmas = np.array([LARGEST_LEVEL, *[LEVEL] * further_levels, *others])
    information = (fitted * weights[:, None]).T @ fitted + np.diag(1 / sigmas**2)
    return np.asarray(np.linalg.cholesky(information), dtype=np.float64)


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
