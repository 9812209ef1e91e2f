"""Gaussian mixtures of colours: models of materials, and the unary cost of a pixel under each."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32

# Standard deviations added to every component's: image noise, JPEG artefacts, relief.
COLOUR_NOISE = np.array([0.05, 0.045, 0.045])
LEAST_MEMBERS = 5  # colours of a component
# Colours are processed in blocks whose intermediate results fit into the processor's cache.
BLOCK = 4096
# Largest cost: twice the negative log density of the uniform background component, a few per cent of every material.
UNEXPLAINED = 13.0
ROWS, COLUMNS = np.triu_indices(3)  # of a quadratic form's six coefficients
TIMES = np.where(ROWS == COLUMNS, 1.0, 2.0)  # that each of these is in the form's matrix
NORMAL = 3 * math.log(2 * math.pi)  # twice the log of a normal density's constant, in three dimensions


@dataclass(frozen=True, slots=True, eq=False)
class Mixture:
    """The log-opponent colours of a material as a mixture of normal distributions."""

    centres: Float32  # (k, 3)
    covariances: Float32  # (k, 3, 3)
    weights: Float32  # (k,) mixing proportions

    def shifted(self, shifts: Float, widenings: Float) -> "Mixture":
        """The union of s copies of the mixture: each moved by its own of `shifts` (s, 3), its covariances multiplied
        by its `widenings` (s,).
        """
        centres = self.centres + shifts[:, None].astype(np.float32)
        covariances = self.covariances * widenings[:, None, None, None].astype(np.float32)
        return Mixture(centres.reshape(-1, 3), covariances.reshape(-1, 3, 3), np.tile(self.weights, len(shifts)))

    def only(self, kept: NDArray[np.bool_]) -> "Mixture":
        """The components in `kept` (k,), with their weights as they are."""
        return Mixture(self.centres[kept], self.covariances[kept], self.weights[kept])


def clusters(colours: Float32, count: int, start: NDArray[np.intp] | None = None) -> tuple[NDArray[np.intp], Float32]:
    """K-means: labels (n,) and centres (k, 3) of colours (n, 3), k at most `count`; deterministic to the bit.

    start: (n,) initial labels, if there are any.
    """
    # OpenCV has one random generator per thread: seeded here, so that the result does not depend on what ran before.
    cv2.setRNGSeed(1)
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 12, 0.01)
    how = cv2.KMEANS_PP_CENTERS if start is None else cv2.KMEANS_USE_INITIAL_LABELS
    given = np.empty(0, np.int32) if start is None else start.astype(np.int32)[:, None]
    _, labels, centres = cv2.kmeans(colours, min(count, len(colours)), given, criteria, 1, how)
    return labels[:, 0].astype(np.intp), np.asarray(centres, dtype=np.float32)


def nearest_centres(colours: Float32, centres: Float32) -> NDArray[np.intp]:
    """(n,) index of the nearest of at most 255 centres (k, 3) to each of the colours (n, 3); the first of equals."""
    labels = np.empty(len(colours), np.intp)
    # Maxima over rows of bytes take a fifth of the time of `argmin`.
    first = np.arange(len(centres), 0, -1, dtype=np.uint8)[:, None]
    squares = (centres**2).sum(axis=1)[:, None]
    for begin in range(0, len(colours), BLOCK):
        block = slice(begin, begin + BLOCK)
        distances = squares - 2 * centres @ colours[block].T
        labels[block] = (first * (distances == distances.min(axis=0))).max(axis=0)
    return len(centres) - labels


def mixture_of(
    colours: Float32, count: int, widening: float = 1.0, start: NDArray[np.intp] | None = None
) -> Mixture | None:
    """The mixture of at most `count` components fitted to colours (n, 3) by K-means; None if there are too few colours.

    widening: factor on the components' covariances. start: as in `clusters`.
    """
    if len(colours) < LEAST_MEMBERS:
        return None
    labels, centres = clusters(colours, count, start)
    membership = (labels == np.arange(len(centres))[:, None]).astype(np.float64)
    members = membership.sum(axis=1)
    kept = members >= LEAST_MEMBERS
    if not kept.any():
        return None
    membership, members = membership[kept], members[kept][:, None]
    middle = colours.mean(axis=0, dtype=np.float64)
    away = (colours - middle).T.copy()  # along the rows, where products are several times faster
    means = membership @ away.T / members
    squares = membership @ (away[:, None] * away).reshape(9, -1).T / members
    covariances = (squares - (means[:, :, None] * means[:, None, :]).reshape(-1, 9)) * members / (members - 1)
    return Mixture(
        (middle + means).astype(np.float32),
        (widening * covariances.reshape(-1, 3, 3) + np.diag(COLOUR_NOISE**2)).astype(np.float32),
        (members[:, 0] / len(labels)).astype(np.float32),
    )


def nearest_squared_distance(
    colours: Float32, centres: Float32, covariances: Float32, costs: Float | Float32 | None = None
) -> Float32:
    """(n,) smallest squared Mahalanobis distance of colours (n, 3) to a centre (k, 3), each plus its `costs` (k,).

    covariances: (k, 3, 3), one for each centre, or (3, 3) for all. The distances are quadratics in the colour, so that
    all of them are one product of (k, 10) and (10, n).
    """
    precisions = np.linalg.inv(np.broadcast_to(covariances, (len(centres), 3, 3)).astype(np.float64))
    offsets = np.einsum("ki,kij,kj->k", centres, precisions, centres) + (0.0 if costs is None else costs)
    coefficients = np.empty((len(centres), 10), np.float32)
    coefficients[:, :6] = precisions[:, ROWS, COLUMNS] * TIMES
    coefficients[:, 6:9] = -2 * np.einsum("kij,kj->ki", precisions, centres)
    coefficients[:, 9] = offsets
    # Colours run along the rows, as minima over rows are several times faster than minima along them.
    monomials = np.empty((10, len(colours)), np.float32)
    monomials[6:9], monomials[9] = colours.T, 1
    for row, one, other in zip(monomials, ROWS, COLUMNS, strict=False):
        np.multiply(monomials[6 + one], monomials[6 + other], out=row)
    nearest = np.empty(len(colours), np.float32)
    for begin in range(0, len(colours), BLOCK):
        block = slice(begin, begin + BLOCK)
        (coefficients @ monomials[:, block]).min(axis=0, out=nearest[block])
    return nearest


def cost(colours: Float32, mixture: Mixture, extra_costs: Float | float = 0.0) -> Float32:
    """(n,) cost of colours (n, 3): twice their negative log density by the likeliest component, at most UNEXPLAINED.

    extra_costs: (k,) extra costs of the components; the least of them is added to UNEXPLAINED too.
    """
    spread = np.linalg.slogdet(mixture.covariances.astype(np.float64))[1]
    rarity = -2 * np.log(np.maximum(mixture.weights, 1e-3))
    costs = spread + rarity + NORMAL + extra_costs
    nearest = nearest_squared_distance(colours, mixture.centres, mixture.covariances, costs)
    return np.minimum(nearest, np.float32(UNEXPLAINED + np.min(extra_costs)))


@dataclass(frozen=True, slots=True, eq=False)
class Quantised:
    """The cells of colour space, as large as the noise, in which a picture's colours lie.

    Costs are computed once for each of them, and not for each pixel.
    """

    colours: Float32  # (k, 3) log-opponent, the mean of each cell's
    cell: NDArray[np.intp]  # (h, w) index of each pixel's cell

    @staticmethod
    def of(colours: Float32) -> "Quantised":
        """Quantises the colours of a picture (h, w, 3)."""
        flat = colours.reshape(-1, 3)
        places = np.floor(flat / COLOUR_NOISE.astype(np.float32)).astype(np.int32)
        places -= places.min(axis=0)
        _, spans_y, spans_z = (int(most) + 1 for most in places.max(axis=0))
        number = (places[:, 0] * spans_y + places[:, 1]) * spans_z + places[:, 2]
        _, cell, counts = np.unique(number, return_inverse=True, return_counts=True)
        sums = np.stack([np.bincount(cell, channel) for channel in flat.T], axis=1)
        return Quantised((sums / counts[:, None]).astype(np.float32), cell.reshape(colours.shape[:2]))

    def as_picture(self, values: Float32) -> Float32:
        """(h, w) the values (k,) of the cells, spread over their pixels."""
        return values.take(self.cell)
