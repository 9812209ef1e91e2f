"""Whether a direction agrees with the fall of light over the ground, in pictures that a lamp lights.

The ground is brightest where a lamp stands, so that an uneven ground tells which way the light comes from before any
object is looked at. What explains the picture by a light from elsewhere is then unlikely, however well it fits.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ashe_live.core.arrays import Float, directions_on_spiral
from ashe_live.light.lamps.fall_off import FallOff

NEARNESSES = (0.6, 1.3, 2.7, 5.5)  # 1/m, equally likely of a lamp
DIRECTIONS, LOWEST_Z = 40, 0.25  # spread evenly over the hemisphere, without the lowest
SHARE = 0.8  # of the light that is the lamp's, where it is not known yet
LAMP_DEVIANCE = 30.0  # of a sun, from which on the ground is taken to be lit by a lamp
# The fall of light counts as much less: what bends it, as walls and sheen do, turns its direction too.
TEMPERING = 0.25
MOST = 3.0  # of the log of a likelihood ratio, either way


@dataclass(frozen=True, eq=False)
class FallDirections:
    """The likelihood of lamps' directions by the fall of light."""

    fall_off: FallOff

    def log_ratio(self, displacements: Float) -> float:
        """Log of how much likelier a lamp is that casts displacements (k, 2) than one anywhere; 0 if there is no lamp.

        displacements: at the marker's centre, for each of NEARNESSES.
        """
        if not self._is_lamp:
            return 0.0
        here = self._costs(np.column_stack([displacements, NEARNESSES]))
        return float(np.clip(_log_mean(here) - _log_mean(self._anywhere), -MOST, MOST))

    @cached_property
    def likeliest(self) -> tuple[Float, float]:
        """The displacement and nearness (3,) of the likeliest lamp of all, and the deviance of a sun beside it."""
        (sun,) = self._costs(np.zeros((1, 3)))
        best = int(np.argmin(self._anywhere))
        return self._lamps[best], float(sun - self._anywhere[best])

    @property
    def _is_lamp(self) -> bool:
        return self.likeliest[1] > LAMP_DEVIANCE

    @cached_property
    def _lamps(self) -> Float:
        """(n, 3) lamps all over the hemisphere."""
        x, y, z = directions_on_spiral(DIRECTIONS, LOWEST_Z, 1.0).T
        displacements = np.column_stack([x / z, y / z])
        return np.array([[*(s + k * self.reference), k] for s in displacements for k in NEARNESSES])

    @cached_property
    def _anywhere(self) -> Float:
        """(n,) costs of these."""
        return self._costs(self._lamps)

    @cached_property
    def reference(self) -> Float:
        """(2,) the middle of the lit ground in view, on the plane."""
        return np.asarray(self.fall_off.places.mean(axis=0))

    def _costs(self, parameters: Float) -> Float:
        return self.fall_off.worst_costs(parameters, SHARE, self.reference)


def _log_mean(costs: Float) -> float:
    """Log of the mean tempered likelihood of costs (n,), which are twice negative log likelihoods."""
    logs = -0.5 * TEMPERING * costs
    return float(logs.max() + math.log(np.exp(logs - logs.max()).mean()))
