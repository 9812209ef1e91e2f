"""A light by its shadow's edges, its nearness free: w / z of (x, y, z, w), 0 for a sun, with s = (x, y) / z."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.outline.fit import ShadowFit
from ashe_live.light.known_body.outline.folded import beside_folds
from ashe_live.light.known_body.outline.profiles import EdgeImages
from ashe_live.light.known_body.outline.reach import Reach

# Standard deviation of a body's width over its height, where its errors are not known. A body that is wider by a
# hundredth casts the shadow of a lamp whose nearness is larger by a hundredth over the height.
WIDTH_SIGMA = 0.017
SURELY_BEYOND = 3.0  # standard deviations of a nearness below 0, from which on it is that of no light


@dataclass(frozen=True, slots=True, eq=False)
class ByEdges:
    """A light by its shadow's edges, its nearness free."""

    light: Float  # (4,) z = 1
    covariance: Float  # (3, 3) of s and the nearness, the body's own errors included
    has_folds: bool  # whether these are the known errors of the body and its frame
    reach: Reach | None = None  # that its shadow has at least; light and covariance do not know of it

    @property
    def nearness(self) -> float:
        return float(self.light[3])

    @property
    def nearness_sigma(self) -> float:
        return math.sqrt(self.covariance[2, 2])

    @property
    def is_beyond_suns(self) -> bool:
        """Whether the edges draw together as those of no light's shadow do, however wrong the body may be."""
        return self.nearness < -SURELY_BEYOND * self.nearness_sigma

    @property
    def by_nearness(self) -> Float:
        """(3,) how much s and the nearness change with the nearness, for the edges to agree as well as they can."""
        return np.asarray(self.covariance[:, 2] / self.covariance[2, 2])

    def lights_at(self, nearness: Float) -> tuple[Float, Float]:
        """(m, 4) the likeliest light, z = 1, if its nearness had one of the values (m,), and (m,) log likelihoods of
        these: by the edges, and by how far the shadow reaches.
        """
        lights = np.tile(self.light, (len(nearness), 1))
        lights[:, :2] += (nearness - self.light[3])[:, None] * self.by_nearness[:2]
        lights[:, 3] = nearness
        log_likelihood = -0.5 * ((nearness - self.nearness) / self.nearness_sigma) ** 2
        if self.reach is not None:
            beyond = self.reach.beyond(lights[:, :2], self._held, nearness)
            lights[:, :2] = beyond.mode
            log_likelihood -= 0.5 * beyond.short**2
        return lights, log_likelihood

    def stated(self, nearness: float, variance: float) -> tuple[Float, Float]:
        """(4,) the light, z = 1, if its nearness had this mean and variance, and its (3, 3) covariance."""
        (light,), _ = self.lights_at(np.array([nearness]))
        line = self.by_nearness
        covariance = self.covariance + (variance - self.covariance[2, 2]) * np.outer(line, line)
        if self.reach is None:
            return light, np.asarray(covariance)
        s = self.light[:2] + (nearness - self.nearness) * line[:2]
        beyond = self.reach.beyond(s[None], self._held, np.array([nearness]))
        if beyond.short[0] == 0:
            return light, np.asarray(covariance)
        covariance = np.zeros((3, 3))
        covariance[:2, :2] = self._held - beyond.narrowed[0] * np.outer(beyond.along, beyond.along)
        line = np.append(self.reach.by_nearness(line[:2], beyond.along), 1.0)
        return light, covariance + variance * np.outer(line, line)

    @property
    def _held(self) -> Float:
        """(2, 2) covariance of s at a nearness that is held."""
        line = self.by_nearness[:2]
        return np.asarray(self.covariance[:2, :2] - self.covariance[2, 2] * np.outer(line, line))


def by_edges(images: EdgeImages, fit: ShadowFit, darkening: float) -> ByEdges | None:
    """The light of a fit, with its nearness, as uncertain as the body's errors make it.

    None where these are not known and the nearness was held in the fit: nothing then says how the edges move with it.
    """
    image = images.of(fit.view)
    reach = Reach.seen(fit, image, darkening)
    adjusted = beside_folds(fit, images, darkening, with_nearness=True)
    if adjusted is not None:
        return ByEdges(*adjusted, True, reach)
    if len(fit.covariance) < 3:
        return None
    # A wider body casts the shadow of a nearer lamp, which ends at the same place: s / (1 - height w / z).
    end = fit.light[:2] / (1 - image.height_m * fit.light[3])
    by_width = WIDTH_SIGMA * np.append(-end, 1 / image.height_m)
    return ByEdges(fit.light, fit.covariance + np.outer(by_width, by_width), False, reach)
