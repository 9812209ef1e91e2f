"""Lights' directions by how light is distributed over the ground: below a lamp, and on gloss in any light.

The ground is brightest where a lamp stands, and where it would mirror a light, so that uneven light on the ground is
evidence on its direction before any object is looked at. An explanation by a light from elsewhere is then unlikely,
however well it fits.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter

import numpy as np

from ashe_live.core.arrays import Float, directions_on_spiral
from ashe_live.light.ground.gloss import Gloss
from ashe_live.light.lamps.fall.fall_off import FallOff

PRIOR_NEARNESSES = (0.6, 1.3, 2.7, 5.5)  # 1/m, equally likely of a lamp
DIRECTIONS, LOWEST_Z = 40, 0.25  # of lamps, spread evenly over the hemisphere, without the lowest
SUNS, LOWEST_SUN_Z = 60, 0.08  # the same of suns, which gloss mirrors lower
SHARE = 0.8  # of the light that is the lamp's, where it is not known yet
# Deviance of a ground that is lit alike all over, from which on its light is evidence on a direction: chance exceeds it
# once in a thousand, with a lamp's three parameters.
UNEVEN_DEVIANCE = 16.3
INFORMATIVE_DEVIANCE = 30.0  # of a sun, from which on the ground is taken to be lit by a lamp, and shows its direction
# The fall of light counts as much less: what bends it, as walls do, turns its direction too.
TEMPERING = 0.25
MOST = 3.0  # of the log of a likelihood ratio, either way
# Grounds that are tried: a table's varnish, a worn one, stone, and the bumps of a rough ground; pale and dark.
ROUGHNESSES, ALBEDOS = (0.15, 0.3, 0.5, 0.8), (0.3, 0.08)
# Under a lamp: the mirror image of a smoother ground lies between the directions that are tried.
UNDER_LAMPS = (0.3, 0.5)
GLOSS_DEVIANCE = 6.0  # of a ground without gloss, that chance exceeds once in twenty with two parameters
EVERY = 4  # samples, of those that choose the gloss


def with_gloss(fall_off: FallOff) -> FallOff:
    """With the gloss by which a sun explains the ground's brightness best, from wherever it shines; or as it is.

    Where a lamp is likelier than any sun, with the gloss by which one explains it best: residuals of a wrong light, or
    of a dull ground, would be fitted by another lamp.
    """
    some, suns = fall_off.every(EVERY), _suns()
    directions = FallDirections(some)

    def least_cost(lights: Float, roughnesses: Sequence[float]) -> tuple[float, Gloss]:
        tried = [Gloss(alpha, albedo) for alpha in roughnesses for albedo in ALBEDOS]
        costs = [replace(some, gloss=each).worst_costs(lights, SHARE, directions.reference).min() for each in tried]
        return min(zip(map(float, costs), tried, strict=True), key=itemgetter(0))

    (even,) = some.worst_costs(np.zeros((1, 3)), SHARE, directions.reference)  # all suns light dull ground alike
    of_sun, by_sun = least_cost(suns, ROUGHNESSES)
    of_lamp = float(directions.of_lamps.min())
    if even - of_lamp > UNEVEN_DEVIANCE:
        of_glossy, by_lamp = least_cost(directions.lamps, UNDER_LAMPS)
        if of_lamp - of_glossy > GLOSS_DEVIANCE and of_sun - of_glossy > UNEVEN_DEVIANCE:
            return replace(fall_off, gloss=by_lamp)
    is_glossy = even - of_sun > GLOSS_DEVIANCE and of_sun < of_lamp
    return replace(fall_off, gloss=by_sun) if is_glossy else fall_off


@dataclass(frozen=True, eq=False)
class FallDirections:
    """The likelihood of lights' directions by how the ground is lit."""

    fall_off: FallOff

    def log_ratio(self, displacements: Float) -> float:
        """Log of how much likelier a light is that casts displacements (1 + k, 2) than one anywhere.

        0 where neither gloss nor the fall of light is evidence. displacements: at the marker's centre, of a sun and of
        lamps of each of PRIOR_NEARNESSES.
        """
        light, deviance = self.likeliest
        is_lamp = light[2] > 0
        if deviance < (INFORMATIVE_DEVIANCE if is_lamp else UNEVEN_DEVIANCE):
            return 0.0
        here = self._costs(np.column_stack([displacements, (0.0, *PRIOR_NEARNESSES)]))
        if is_lamp:
            ratio = _log_mean(here[1:]) - _log_mean(self.of_lamps)
        else:
            ratio = _log_mean(here[:1]) - _log_mean(self._of_suns)
        return float(np.clip(ratio, -MOST, MOST))

    @cached_property
    def likeliest(self) -> tuple[Float, float]:
        """The displacement and nearness (3,) of the likeliest light, and by how much light that is alike costs more."""
        # What gloss mirrors of a sun, and a lamp's spot with its mirror image, are alike.
        least = 0.0 if self.fall_off.gloss is None else UNEVEN_DEVIANCE
        is_lamp = self._of_suns.min() - self.of_lamps.min() > least
        costs, lights = (self.of_lamps, self.lamps) if is_lamp else (self._of_suns, self._suns)
        best = int(np.argmin(costs))
        (even,) = replace(self.fall_off, gloss=None).worst_costs(np.zeros((1, 3)), SHARE, self.reference)
        return lights[best], float(even - costs[best])

    @cached_property
    def reference(self) -> Float:
        """(2,) the middle of the lit ground in view, on the plane."""
        return np.asarray(self.fall_off.samples.places.mean(axis=0))

    @cached_property
    def lamps(self) -> Float:
        """(n, 3) lamps all over the hemisphere."""
        x, y, z = directions_on_spiral(DIRECTIONS, LOWEST_Z, 1.0).T
        displacements = np.column_stack([x / z, y / z])
        return np.array([[*(s + k * self.reference), k] for s in displacements for k in PRIOR_NEARNESSES])

    @cached_property
    def _suns(self) -> Float:
        """(n, 3) suns all over the hemisphere; one, where there is no gloss by which they differ."""
        return np.zeros((1, 3)) if self.fall_off.gloss is None else _suns()

    @cached_property
    def of_lamps(self) -> Float:
        """(n,) costs of these."""
        return self._costs(self.lamps)

    @cached_property
    def _of_suns(self) -> Float:
        """(n,) costs of these."""
        return self._costs(self._suns)

    def _costs(self, parameters: Float) -> Float:
        return self.fall_off.worst_costs(parameters, SHARE, self.reference)


def _suns() -> Float:
    """(n, 3) suns all over the hemisphere."""
    x, y, z = directions_on_spiral(SUNS, LOWEST_SUN_Z, 1.0).T
    return np.column_stack([x / z, y / z, np.zeros(SUNS)])


def _log_mean(costs: Float) -> float:
    """Log of the mean tempered likelihood of costs (n,), which are twice negative log likelihoods."""
    logs = -0.5 * TEMPERING * costs
    return float(logs.max() + math.log(np.exp(logs - logs.max()).mean()))
