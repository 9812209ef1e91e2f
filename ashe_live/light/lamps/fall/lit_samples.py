"""Samples of the lit ground's brightness, with what other than a lamp may cause it, and the samples' weights.

The picture's brightness also has the ground's paint and texture, vignetting, and what else is uneven. Vignetting and a
little unevenness are fitted along (docs/maths, "The fall of light"). Paint and texture are noise that is correlated
over their size. No colour has a level of its own: a plain ground's colours are the steps of its own brightness, and
their levels would absorb a lamp's fall. Lit areas that are not connected have one each, as what is beyond a table's end
may be a floor; so do surfaces that an edge divides.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float, Mask, median
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.ground.lit_ground import UNLIT_DISTANCE, LitGround
from ashe_live.light.ground.surfaces import areas_of, surfaces
from ashe_live.light.pixels.areas import grown, sampled
from ashe_live.light.pixels.log_colour import is_exposed, log_opponent
from ashe_live.light.pixels.view import View

BESIDE_PX = 4  # of the coarse picture: ground nearer than this to an object or a shadow is not lit as the rest
AROUND_PX = 7  # side of the squares of which half has to be lit: what is narrower than half joins no two areas
SAMPLES, FEWEST = 1500, 300  # pixels of lit ground that are used, at most and at least
CELLS = (12, 9)  # in which samples' errors may be correlated: texture is larger than a pixel
# Sigmas of what is fitted along: vignetting at the picture's corner (of log brightness), the ground's own unevenness as
# a gradient (1/m) and a curvature (1/m^2) of log irradiance, and the camera's contrast beside that of sRGB.
VIGNETTING, GRADIENT, CURVATURE, CONTRAST = 0.2, 0.03, 0.05, 0.1
LEVEL = 0.5  # the same of an area's log albedo, beside that of the largest
LARGEST_LEVEL = 1e3  # and of that one's: any
ROBUST_ROUNDS = 6
LEAST_NOISE = 0.01  # of log brightness


@dataclass(frozen=True, eq=False)
class LitSamples:
    """The log brightness of lit ground, and what beside a lamp may cause it."""

    places: Float  # (n, 2) metres on the plane, marker frame
    brightness: Float  # (n,) log of linear light
    weights: Float  # (n,) information on each sample
    fitted: Float  # (n, c) what is fitted along: levels, vignetting, gradient and curvature
    factor: Float  # (c, c) Cholesky factor of the information on these, with their priors
    uneven: Float  # (n, 5) gradient and curvature

    @staticmethod
    def of(view: View, ground: LitGround, free: Mask) -> "LitSamples | None":
        """Of the lit ground in `free` (h, w), away from objects and shadows; None where too little of it is seen.

        view: the one that `ground` was fitted to.
        """
        exposed = is_exposed(view.image_bgr)
        seen = free & view.is_ground
        is_lit = seen & (ground.squared_distance <= UNLIT_DISTANCE)
        parts = surfaces(view.image_bgr, seen) if ground.divided else areas_of(_mostly(is_lit), is_lit)
        chosen = sampled((parts > 0) & exposed & is_lit, SAMPLES)
        if len(chosen) < FEWEST:
            return None
        brightness = log_opponent(view.image_bgr)[..., 0].ravel()[chosen].astype(np.float64)
        rows, columns = np.divmod(chosen, view.size[0])
        places = _on_ground(view, columns, rows)
        uneven = _uneven(places - places.mean(axis=0))
        part = parts.ravel()[chosen]
        levels = part[:, None] == np.arange(2, part.max() + 1)
        fitted = np.column_stack([np.ones(len(chosen)), levels, _vignetting(view, columns, rows), uneven])
        cells = rows * CELLS[1] // view.size[1] * CELLS[0] + columns * CELLS[0] // view.size[0]
        weights = _robust_weights(brightness, fitted, cells, uneven.shape[1] + 1)
        return LitSamples(places, brightness, weights, fitted, _factor(fitted, weights), uneven)

    def every(self, step: int) -> "LitSamples":
        """Every `step`-th sample, which counts as much more."""
        some = slice(None, None, step)
        weights, fitted = self.weights[some] * step, self.fitted[some]
        factor = _factor(fitted, weights)
        return LitSamples(self.places[some], self.brightness[some], weights, fitted, factor, self.uneven[some])

    def gram(self, columns: Float) -> Float:
        """(k, k) weighted inner products of columns (n, k), without what can be fitted along."""
        weighted, explained = self.weighted(columns)
        return np.asarray(columns.T @ weighted - explained.T @ explained)

    def weighted(self, columns: Float) -> tuple[Float, Float]:
        """(n, k) columns times the samples' weights; (c, k) what can be fitted along, in an orthonormal basis."""
        weighted = columns * self.weights[:, None]
        return weighted, np.asarray(np.linalg.solve(self.factor, self.fitted.T @ weighted))


def clear_of(taken: Mask) -> Mask:
    """(h, w) the ground that is lit as the rest, away from objects and shadows (h, w)."""
    return ~grown(taken, BESIDE_PX)


def _mostly(mask: Mask) -> Mask:
    """(h, w) where at least half of the pixels around are in a mask (h, w)."""
    return np.asarray(cv2.blur(mask.astype(np.float32), (AROUND_PX, AROUND_PX)) >= 0.5)


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
        noise = SIGMA_OVER_MAD * median(np.abs(rest)) + LEAST_NOISE
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
