"""How far a shadow is seen to reach: it is no shorter, whatever its end and the body's errors leave open.

The equations of a light beside a body's errors are solved once, about the light that lies on the edges. They do not
know that a shadow which ends before those edges would have none there.
"""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.outline.fit import ShadowFit, informative_sides
from ashe_live.light.known_body.outline.profiles import BY_NONE, BY_STEP, EdgeImage, Profiles

# A body that was folded by hand is off by so much, in standard deviations: its turn, and the place of a face over its
# height. By SIGMAS of both the shadow may end before the edges that are seen, as these are where they are.
TURN_RAD, SHIFT, SIGMAS = np.radians(0.9).item(), 0.011, 2.0
FAR = 30.0  # standard deviations, from which on the tail of a normal distribution is that of its expansion
LEAST_SIGMA = 1e-9  # of a displacement


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Of a body's shadow, at least: where it ends over the body's height, which is s / (1 - height w / z)."""

    towards: Float  # (2,) unit vector along the displacement s
    least: float
    height_m: float  # of the body

    @staticmethod
    def seen(fit: ShadowFit, image: EdgeImage, darkening: float) -> "Reach | None":
        """By the edges of a fit with its nearness: up to where places with a step are likelier on edges than on none.

        None where none are, and where the shadow's end is seen, which determines its reach. darkening: as of `fitted`.
        """
        profiles = fit.profiles_in(image)
        s = fit.light[:2] / fit.light[2]
        length = math.hypot(*s)
        if profiles is None or not profiles.visible.any() or length < 1e-9 or _shows_end(profiles, s, darkening):
            return None
        visible = profiles.visible
        far = length * profiles.edges.drop[visible] / image.height_m
        log_odds = np.where(profiles.are_steps(darkening)[visible], BY_STEP, BY_NONE)
        order = np.argsort(far, kind="stable")
        so_far = log_odds[order].cumsum()
        best = int(so_far.argmax())
        if so_far[best] <= 0:
            return None
        farthest = float(far[order[best]])
        # A turn moves the end as it moves the light: by as much as the tangent of its angle from the zenith grows.
        off = SIGMAS * math.hypot(TURN_RAD * (1 + farthest**2), SHIFT)
        return Reach(np.asarray(s / length), farthest - off, image.height_m)

    def beyond(self, s: Float, covariance: Float, nearness: Float) -> "Beyond":
        """The likeliest displacements that reach so far, of normal distributions: means (m, 2), `covariance` (2, 2), at
        values (m,) of the nearness w / z, 1/m.
        """
        across = covariance @ self.towards
        sigma = math.sqrt(max(float(self.towards @ across), LEAST_SIGMA**2))
        # An end beyond `least` is one of s that is beyond this.
        short = np.maximum(self.least * (1 - self.height_m * nearness) - s @ self.towards, 0.0) / sigma
        along = across / sigma
        return Beyond(short, s + short[:, None] * along, along)

    def by_nearness(self, line: Float, along: Float) -> Float:
        """(2,) by how much a displacement changes with the nearness whose shadow ends at `least`, where it would by
        `line` (2,) with any end; along: as in Beyond.
        """
        shorter = (self.least * self.height_m + float(self.towards @ line)) / float(self.towards @ along)
        return np.asarray(line - shorter * along)


@dataclass(frozen=True, slots=True, eq=False)
class Beyond:
    """The likeliest of displacements s that reach far enough."""

    short: Float  # (m,) standard deviations by which the likeliest of all are too short; 0 where they are not
    mode: Float  # (m, 2)
    along: Float  # (2,) by how much s changes with its reach, for one standard deviation of that

    @property
    def narrowed(self) -> Float:
        """(m,) part of the reach's variance that is taken away: it has no values below the mode, and fewer above it."""
        return np.array([one * (_mean_above(one) - one) for one in self.short.tolist()])


def _mean_above(least: float) -> float:
    """Of a standard normal variable, where it is above `least`, which is no less than 0."""
    if least > FAR:
        return least + 1 / least
    return math.exp(-0.5 * least**2) / math.sqrt(2 * math.pi) / (0.5 * math.erfc(least / math.sqrt(2)))


def _shows_end(profiles: Profiles, s: Float, darkening: float) -> bool:
    """Whether edges are seen that move rather along the displacement `s` (2,) of a shadow than across, as its end."""
    weight = profiles.weights(darkening, 1.0)
    is_seen = (weight > 0) & informative_sides(profiles, weight, darkening, with_nearness=True)[profiles.edges.side]
    along, across = np.abs(profiles.edges.by_light[is_seen, :2] @ np.array([(s[0], -s[1]), (s[1], s[0])])).T
    return bool((along > across).any())
