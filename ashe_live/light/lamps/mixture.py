"""A light that may be in one of several places: the mean of these, and how far from it the truth may be."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, unit_circle
from ashe_live.light.lamps.place import Place
from ashe_live.light.shape.directions import direction_by_displacement

CIRCLES, POINTS = 24, 24  # of equal probability, that stand for a normal distribution; and on each of them


@dataclass(frozen=True, slots=True, eq=False)
class Errors:
    """The distribution of a direction's error, by samples."""

    radii: Float  # (n,) radians, increasing
    probability: Float  # (n,) that an error is no larger

    def radius(self, probability: float) -> float:
        """Radians, within which an error is with that probability."""
        return float(np.interp(probability, self.probability, self.radii))

    def within(self, radius_rad: float) -> float:
        """The probability that an error is no larger."""
        return float(np.interp(radius_rad, self.radii, self.probability))


def errors_of(offsets: Float, spreads: Float, shares: Float) -> Errors:
    """Of a mixture of normal distributions: offsets (n, 2) from the answer, covariances (n, 2, 2), shares (n,)."""
    radii = np.sqrt(-2 * np.log1p(-(np.arange(CIRCLES) + 0.5) / CIRCLES))  # quantiles of Rayleigh's distribution
    samples = (radii[:, None, None] * unit_circle(POINTS, 0.5)).reshape(-1, 2)
    values, vectors = np.linalg.eigh(spreads)
    along = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    errors = np.linalg.norm(offsets[:, None] + samples @ along.transpose(0, 2, 1), axis=2)
    order = np.argsort(errors, axis=None)
    cumulated = np.cumsum(np.repeat(shares / len(samples), len(samples))[order])
    return Errors(np.append(0.0, errors.ravel()[order]), np.append(0.0, np.minimum(cumulated, 1.0)))


def covariance_of(offsets: Float, spreads: Float, shares: Float) -> Float:
    """(k, k) about the answer, of a mixture of distributions.

    offsets: (n, k) of their means from the answer. spreads: (n, k, k) their covariances. shares: (n,).
    """
    return np.asarray(np.einsum("i,ijk->jk", shares, spreads + offsets[:, :, None] * offsets[:, None, :]))


@dataclass(frozen=True, slots=True, eq=False)
class PlaceMixture:
    """A light that is in one of n places."""

    mean: Place  # with the covariance of all
    errors: Errors  # of the mean's direction at the marker

    @staticmethod
    def of(places: Sequence[Place], probabilities: Float) -> "PlaceMixture":
        """probabilities: (n,) that the light is in each of the places, with the sum 1."""
        mean = probabilities @ np.stack([each.mean for each in places])
        offsets = np.stack([each.mean - mean for each in places])
        spreads = np.stack([each.covariance for each in places])
        information = np.asarray(np.linalg.inv(covariance_of(offsets, spreads, probabilities)))
        slope = direction_by_displacement(mean[:2])
        errors = errors_of(offsets[:, :2] @ slope.T, slope @ spreads[:, :2, :2] @ slope.T, probabilities)
        return PlaceMixture(Place(mean, information), errors)
