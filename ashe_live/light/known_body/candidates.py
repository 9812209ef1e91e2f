"""Where a light may be: the likeliest directions of the scan, moved onto the edges of their shadows."""

import math

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.fit import fitted, room_of
from ashe_live.light.known_body.found_light import FoundLight
from ashe_live.light.known_body.scan import shadows_of
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.shape.light_points import at_infinity

TRIED, APART_RAD, TRIED_WITHIN = 3, math.radians(12), 12.0  # starts of a fit; within so much log likelihood of the best
MOST_MOVED_RAD = math.radians(15)  # by a fit: what moves farther has found other edges
# Around a template, displacements that lie nearer than the next one: of its length and a half.
NEARBY = 0.09 * np.array([(x, y) for x in (-1.0, -0.5, 0.0, 0.5, 1.0) for y in (-1.0, -0.5, 0.0, 0.5, 1.0)])
TEMPLATES_APART = 0.1  # in s = (x, y) / z, over 1 + |s|, roughly


def refined(seen: Seen, score: Float, lights: Float, clear: Mask, also: Float32) -> list[tuple[float, FoundLight]]:
    """The likeliest different directions of lights (m, 4), moved onto the shadow's edges, with their scores before.

    score: (m,) log likelihood of each. clear: (h, w) table on which edges may be seen. also: as in Seen.scan.
    """
    found: list[tuple[float, FoundLight]] = []
    chosen: list[Float] = []
    room = room_of(clear)
    for index in np.argsort(-score, kind="stable"):
        if score[index] < score.max() - TRIED_WITHIN or len(chosen) == TRIED:
            break
        start = lights[index]
        if any(start[:3] @ other > math.cos(APART_RAD) for other in chosen):
            continue
        chosen.append(start[:3])
        likelihood, start, darkening = _nearby(seen, start, also)
        fit = fitted(seen.body, start, darkening, seen.light, room, seen.view) if darkening > 0 else None
        if fit is not None and normalised(fit.light[:3]) @ normalised(start[:3]) > math.cos(MOST_MOVED_RAD):
            light = FoundLight(fit.light, fit.covariance, fit, darkening)
        else:
            light = FoundLight(start, _spread(score, lights, start), None, darkening)
        found.append((likelihood, light))
    return found


def _nearby(seen: Seen, template: Float, also: Float32) -> tuple[float, Float, float]:
    """The likeliest light (4,) around a template (4,), with its log likelihood and its part of the table's light."""
    s = template[:2] / template[2]
    around = s + (0.5 + float(np.hypot(*s))) * NEARBY
    lights = at_infinity(np.column_stack([around, np.ones(len(around))]))
    scan = seen.scan(shadows_of(seen.body, lights), also)
    score = scan.log_likelihood + seen.by_shading(lights)
    best, share = np.unravel_index(int(score.argmax()), score.shape)
    return float(score[best, share]), lights[best], float(scan.darkening[best].max())


def _spread(score: Float, lights: Float, start: Float) -> Float:
    """(2, 2) covariance of s by the templates near `start` (4,), each as likely as its score says."""
    near = lights[:, :3] @ normalised(start[:3]) > math.cos(2 * APART_RAD)
    weight = np.exp(score[near] - score[near].max())
    s = lights[near, :2] / lights[near, 2:3] - start[:2] / start[2]
    spread = (weight[:, None] * s).T @ s / weight.sum()
    # No finer than the templates lie.
    apart = TEMPLATES_APART * (1 + float(np.hypot(*start[:2])) / start[2])
    return np.asarray(spread + apart**2 * np.eye(2))
