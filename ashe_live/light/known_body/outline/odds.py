"""The odds of a light by the edges that its shadow should have."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.outline.edges import POINTS
from ashe_live.light.known_body.outline.fit import ShadowFit
from ashe_live.light.known_body.outline.profiles import BY_NONE, BY_STEP, POINTS_A_SAMPLE

HIDDEN = 0.8  # factor of a probability whose edges cannot be seen
ANYWHERE = 0.16  # robust scatter of what is no edge, over the reach in which it is looked for
MOST_NEAR = 1.2  # log odds that one place may gain or lose by lying near to where it is predicted
MOST_LOG_ODDS = 12.0  # of all places together


@dataclass(frozen=True, slots=True)
class ShadowDepths:
    """How deep a shadow has to be for its edges to count: parts of the table's light that it lacks."""

    least: float  # what lacks less is no shadow
    pale: float  # where less is lacking, edges only count against the shadow, as stains have edges, too


OF_ONLY_LIGHT = ShadowDepths(least=0.12, pale=0.2)


def edge_log_odds(fit: ShadowFit | None) -> float:
    """What the shadow's edges say for a light; 0 where they are hidden.

    Each independent place shows a step with the probability SHOWN where there is an edge and CHANCE where there is
    none; and an edge is found near where it is predicted, what is none anywhere within reach.
    """
    if fit is None:
        return 0.0
    return float(log_odds_of_places(fit.seen * POINTS, fit.clear, fit.misfit_share))


def log_odds_of_places(points: float, clear: Float | float, misfit_share: Float | float) -> Float:
    """`edge_log_odds`, (n,) or one, of outlines of which so many points are seen.

    clear: (n,) the parts that show steps; misfit_share: (n,) how far these are off, over the reach.
    """
    near = np.clip(np.log(ANYWHERE / np.maximum(misfit_share, 1e-6)), -MOST_NEAR, MOST_NEAR)
    return np.asarray(points / POINTS_A_SAMPLE * (clear * (BY_STEP + near) + (1 - clear) * BY_NONE))


def with_edges(
    confidence: float,
    fit: ShadowFit | None,
    depth: float,
    depths: ShadowDepths = OF_ONLY_LIGHT,
    most: float = math.inf,
) -> float:
    """The probability of a direction, after a look at the edges that its shadow should have.

    confidence: the same before that look. fit: to these edges; None where they are hidden. depth: the part of the
    table's light that the shadow lacks. most: the log odds that edges may add, at most.
    """
    if depth <= depths.least:
        return 0.0
    if fit is None:
        return HIDDEN * confidence
    most = min(most, MOST_LOG_ODDS) if depth > depths.pale else min(most, 0.0)
    for_it = confidence * math.exp(float(np.clip(edge_log_odds(fit), -MOST_LOG_ODDS, most)))
    return for_it / (for_it + (1 - confidence))  # in this order no rounding takes it beyond 1
