"""Other objects in the picture: each has a shadow in the same light, so that two of them locate a lamp.

What explains another object may be wrong, and then gives a direction from anywhere on the hemisphere; if it is right,
its direction is where the light that is known so far puts it. That decides whether it counts. The covariance of its
direction is that of its own evidence: to agree with a place that is known roughly makes no direction more exact.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import itemgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.lamps.lamp_borders import lamp_borders
from ashe_live.light.lamps.place import Place
from ashe_live.light.lamps.sources import SeenObject
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.directions import direction_by_displacement
from ashe_live.light.shape.layout import lamp_parameters
from ashe_live.light.shape.predicted import predicted_of

LEAST_PROBABILITY = 0.7  # of another object's explanation
MOST = 3  # number of other objects that are used
OVERLAP = 0.1  # most of the smaller one's pixels that two different objects with their shadows share
HEMISPHERE = 2 * math.pi  # steradians
LARGEST_LOG_ODDS = 50.0  # whose exponential is still a number


def companions(
    first: SeenObject,
    place: Place,
    candidates: Sequence[tuple[Explanation, float]],
    covariance_of: Callable[[Explanation, float], Float],
    view: View,
) -> list[SeenObject]:
    """The other objects, those that are likeliest right first, whose light agrees with what is known of it.

    place: where the light is, as far as that is known without them. candidates: explanations with their log odds.
    covariance_of: (2, 2) rad^2 of an explanation's first light, if it is right with some probability. view: the picture
    in whose pixels objects are compared.
    """
    rated = []
    for explanation, log_odds in candidates:
        if len(explanation.lights) == 1:
            odds = log_odds + _agreement(place, explanation, covariance_of(explanation, 1.0))
            rated.append((explanation, _probability(odds), _probability(log_odds)))
    taken = [_silhouette(first.explanation, view)]
    found: list[SeenObject] = []
    for explanation, probability, alone in sorted(rated, key=itemgetter(1), reverse=True):
        if probability < LEAST_PROBABILITY or len(found) == MOST:
            break
        here = _silhouette(explanation, view)
        if here.any() and not any(_share(here, other) > OVERLAP for other in taken):
            taken.append(here)
            spread = covariance_of(explanation, alone)
            found.append(replace(first, explanation=explanation, probability=alone, covariance_rad2=spread))
    return found


def _probability(log_odds: float) -> float:
    return float(1 / (1 + math.exp(-np.clip(log_odds, -LARGEST_LOG_ODDS, LARGEST_LOG_ODDS))))


def _agreement(place: Place, explanation: Explanation, covariance_rad2: Float) -> float:
    """Log of how much likelier the explanation's direction is if its light is that at `place` than if it is any."""
    at = lamp_parameters(explanation.lights[0].light)
    # By how much the displacement misses, beside what another nearness would change of it.
    line = np.column_stack([np.eye(2), -lamp_borders(explanation)[0].by_nearness])
    by_displacement = direction_by_displacement(at[:2]) @ line
    offset = by_displacement @ (at - place.mean)
    spread = by_displacement @ place.covariance @ by_displacement.T + covariance_rad2
    squared = float(offset @ np.linalg.solve(spread, offset))
    return math.log(HEMISPHERE / (2 * math.pi * math.sqrt(np.linalg.det(spread)))) - 0.5 * squared


def _silhouette(explanation: Explanation, view: View) -> Mask:
    """(h, w) the object with its shadow."""
    return predicted_of(explanation.lit, view).whole & view.is_ground


def _share(one: Mask, other: Mask) -> float:
    """The pixels in both, as a fraction of the smaller one's."""
    smaller = min(int(np.count_nonzero(one)), int(np.count_nonzero(other)))
    return int(np.count_nonzero(one & other)) / max(smaller, 1)
