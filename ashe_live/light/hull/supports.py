"""A convex body of any shape: its support function as a Gaussian process, measured by silhouettes and by a shadow.

The support function h(u) is how far a body reaches along u. A tangent of a silhouette spans, with the camera's centre,
a plane that touches the body: a measurement of h. So does a tangent of the shadow with the light's direction, for u at
right angles to it. Where two cameras' measurements cross they must agree (frontier points); elsewhere h is smooth, as a
solid's is. A light's likelihood is that of the shadow's tangents given the silhouettes' (docs/maths, "A hull").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE
from ashe_live.light.shape.directions import displacement_of

# Standard deviation of h about a ball's, over half the body's size: a cube's is 0.2, a pole's 0.5. Its correlation
# fades over a chord of the unit sphere, about 45 degrees: that between a cube's face and its edge.
ROUGHNESS, CHORD = 0.35, 0.8
ANYWHERE_M, ANY_SIZE = 1.0, 2.0  # standard deviations of the place, and of the radius over half the body's size
ON_GROUND_M = 1e-4  # standard deviation of the lowest point's height: the body stands
OUTLIER, WIDENED, ROUNDS = 2.5, 1.7, 4  # beyond so many sigmas of what all others predict, a sigma is widened


@dataclass(frozen=True, slots=True)
class Planes:
    """Planes that touch the body: u . X = h with X inside where it is less."""

    normals: Float  # (n, 3) unit vectors u, marker frame
    reach_m: Float  # (n,) h
    sigma_m: Float  # (n,) standard deviation of h


@dataclass(frozen=True, slots=True)
class ShadowLines:
    """Lines on the plane z = 0 that touch the shadow: m . x = r."""

    normals: Float  # (n, 2) unit vectors m, marker frame
    reach_m: Float  # (n,) r
    sigma_m: Float  # (n,)


def planes_of_lines(P: Float, lines: Float, sigma_px: Float, depth_m: float) -> Planes:
    """The planes through a camera's centre and tangents of a silhouette.

    P: (3, 4). lines: (n, 3) with (x, y, 1) @ line <= 0 inside, its first two of unit length. sigma_px: (n,).
    depth_m: of the body.
    """
    planes = lines @ P
    length = np.linalg.norm(planes[:, :3], axis=1)
    return Planes(planes[:, :3] / length[:, None], -planes[:, 3] / length, sigma_px * depth_m / length)


def shadow_lines(P: Float, lines: Float, sigma_px: Float, depth_m: float) -> ShadowLines:
    """The tangents of a shadow on the plane z = 0, from those in the picture; arguments as in `planes_of_lines`."""
    on_plane = lines @ P[:, [0, 1, 3]]
    length = np.linalg.norm(on_plane[:, :2], axis=1)
    return ShadowLines(on_plane[:, :2] / length[:, None], -on_plane[:, 2] / length, sigma_px * depth_m / length)


@dataclass(frozen=True, slots=True, eq=False)
class _PredictedTangents:
    """n tangents of a shadow beside what silhouettes predict."""

    residual: Float  # (n,) metres along the normals of the planes u . X <= r through them and the light
    covariance: Float  # (n, n) of that
    length: Float  # (n,) |u|


class SupportFunction:
    """The posterior of a body's support function given planes that touch it: a Gaussian process.

    Planes that disagree with the others get a larger standard deviation.
    """

    def __init__(self, several: Sequence[Planes], half_size_m: float) -> None:
        below = np.array([[0.0, 0.0, -1.0]])
        self._normals = np.concatenate([*(each.normals for each in several), below])
        self._half_size_m = half_size_m
        reach = np.concatenate([*(each.reach_m for each in several), [0.0]])
        sigma = np.concatenate([*(each.sigma_m for each in several), [ON_GROUND_M]])
        prior = self._covariance(self._normals, self._normals)
        for _ in range(ROUNDS):
            sigma = np.where(_disagree(prior + np.diag(sigma**2), reach), sigma * WIDENED, sigma)
        self._whitening = np.linalg.inv(np.linalg.cholesky(prior + np.diag(sigma**2)))
        self._whitened = self._whitening @ reach

    def log_likelihood(self, shadow: ShadowLines, to_light: Float) -> float:
        """Log likelihood of the shadow's tangents in the light from direction (3,), marker frame."""
        predicted = self._predicted(shadow, to_light)
        factor = np.linalg.cholesky(predicted.covariance)
        whitened = np.linalg.solve(factor, predicted.residual)
        log_likelihood = -0.5 * whitened @ whitened - np.log(np.diag(factor)).sum() - np.log(predicted.length).sum()
        return float(log_likelihood) / BORDERS_PER_SAMPLE  # a tangent's error is that of the border it touches

    def without_outliers(self, shadow: ShadowLines, to_light: Float) -> ShadowLines:
        """The tangents, those that disagree with the others in a light with a larger sigma."""
        sigma = shadow.sigma_m
        for _ in range(ROUNDS):
            predicted = self._predicted(replace(shadow, sigma_m=sigma), to_light)
            sigma = np.where(_disagree(predicted.covariance, predicted.residual), sigma * WIDENED, sigma)
        return replace(shadow, sigma_m=sigma)

    def _predicted(self, shadow: ShadowLines, to_light: Float) -> _PredictedTangents:
        """The shadow's tangents as the silhouettes predict them in a light.

        A point X casts its shadow at x - s z, so that m . (x - s z) <= r is u . X <= r, with u = (m, -m . s).
        """
        across = np.column_stack([shadow.normals, -shadow.normals @ displacement_of(to_light)])
        length = np.linalg.norm(across, axis=1)
        normals = across / length[:, None]
        known = self._whitening @ self._covariance(self._normals, normals)
        spread = self._covariance(normals, normals) - known.T @ known + np.diag((shadow.sigma_m / length) ** 2)
        return _PredictedTangents(shadow.reach_m / length - known.T @ self._whitened, spread, length)

    def _covariance(self, one: Float, other: Float) -> Float:
        """(n, m) prior covariance of h: the body's place, its size, and a Matern process of order 3/2."""
        cosine = one @ other.T
        chord = math.sqrt(3) / CHORD * np.sqrt(np.maximum(2 - 2 * cosine, 0))
        rough = ROUGHNESS**2 * (1 + chord) * np.exp(-chord)
        return np.asarray(ANYWHERE_M**2 * cosine + self._half_size_m**2 * (ANY_SIZE**2 + rough))


def _disagree(covariance: Float, values: Float) -> Mask:
    """(n,) whether values, of a zero mean and this covariance (n, n), are not what the others predict.

    Leave-one-out predictions: Rasmussen and Williams, "Gaussian Processes for Machine Learning", 5.4.2.
    """
    inverse = np.linalg.inv(covariance)
    return np.asarray(np.abs(inverse @ values) > OUTLIER * np.sqrt(np.diag(inverse)))
