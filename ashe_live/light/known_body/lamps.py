"""Lamps near a known body: its shadow grows with the height that casts it, and fans out, which tells their distance."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.light.known_body.found_light import FoundLight, room_beside
from ashe_live.light.known_body.outline.fit import fitted
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.table import height_of

# Standard deviation of the body's width over its height, as paper is folded by hand: a body wider by a hundredth
# throws the shadow of a lamp whose w / z is larger by a hundredth over that height.
FOLDED = 0.017
LEAST_SIGMAS = 4.0  # standard errors by which the nearness of a lamp must differ from that of a sun, 0
MOST_MISFIT_PX, LESS_CLEAR = 0.7, 0.05  # of a lamp's edges, and part of the edges that it may explain less than a sun


def as_lamps(seen: Seen, found: Sequence[FoundLight]) -> list[FoundLight]:
    """The lights, those as lamps whose distance is told; others as uncertain as they are if they may be lamps."""
    return [_as_lamp(seen, one, [other for other in found if other is not one]) for one in found]


def _as_lamp(seen: Seen, one: FoundLight, others: Sequence[FoundLight]) -> FoundLight:
    if one.fit is None:
        return one
    room = room_beside(seen, others)
    fit = fitted(seen.body, one.light, one.darkening, seen.light, room, seen.view, with_nearness=True)
    if fit is None or fit.misfit_px > MOST_MISFIT_PX or fit.clear < one.fit.clear - LESS_CLEAR:
        return replace(one, light=one.light * (1, 1, 1, 0))
    covariance = fit.covariance + np.diag([0.0, 0.0, (FOLDED / height_of(seen.body)) ** 2])
    if fit.light[3] > LEAST_SIGMAS * math.sqrt(covariance[2, 2]):
        return replace(one, light=fit.light, covariance=covariance, fit=fit)
    return replace(one, light=one.light * (1, 1, 1, 0), covariance=fit.covariance[:2, :2])
