"""The lights that a known body stands in, from its shadows and its lit sides, with the odds of each."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.facets import Facets, facets_of
from ashe_live.light.known_body.fit import FEWEST, POINTS_A_SAMPLE, EdgeFit, fitted, room_of, without
from ashe_live.light.known_body.scan import SKY_SHARES, relative_light, scanned, shadows_of, templates_of
from ashe_live.light.known_body.shading import shading_log_likelihood
from ashe_live.light.known_body.shadow_edges import POINTS, shadow_edges
from ashe_live.light.known_body.table import BRIGHTEST, CELLS_A_HEIGHT, SIDE, Table, linear_picture, table_around
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import predicted

BESIDE_HEIGHTS = 1.2  # how far from the body's foot the table counts as beside it
BESIDE_PX = 2  # of the body, whose rim is neither table nor shadow
TRIED, APART_RAD, TRIED_WITHIN = 3, math.radians(12), 12.0  # starts of a fit; within so much log likelihood of the best
MOST_MOVED_RAD = math.radians(15)
# Around a template, displacements that lie nearer than the next one: of its length and a half.
NEARBY = 0.09 * np.array([(x, y) for x in (-1.0, -0.5, 0.0, 0.5, 1.0) for y in (-1.0, -0.5, 0.0, 0.5, 1.0)])
NEAR_RAD = math.radians(10)
# A further light must explain so much more, take so much of the table's light, and show its shadow's edges.
MOST_LIGHTS, LEAST_SCORE, LEAST_MORE = 3, 1.0, 8.0
LEAST_DARKENING, LEAST_CLEAR, MOST_MISFIT_PX = 0.06, 0.75, 0.7
# Odds before the picture is seen, that there is no light which casts a shadow.
LOG_NONE = math.log(0.5)
BEYOND_PX = 3.0  # from a shadow's edge to where it is dark, or lit, but for the penumbra
SHOWN, CHANCE, HIDDEN_EDGES = 0.85, 0.3, 0.8
# Of the reach, the robust scatter of what is no edge; what places say by lying near is worth no more than so much.
ANYWHERE, MOST_NEAR, MOST_LOG_ODDS = 0.16, 1.2, 12.0
# A light that gives less of the table's light casts no shadow to speak of; one that gives less, a pale one.
PALEST, PALE = 0.12, 0.2
DARK_ELSEWHERE = 6.0  # log likelihood


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A picture of a known body, prepared once for all that looks at it."""

    view: View
    body: Proxy
    picture: Float32  # (h, w, 3) linear light, B, G, R
    light: Float32  # (h, w) its mean over the channels
    clear: Mask  # (h, w) bare table, not beside the body
    table: Table
    relative: Float32  # (n, n, 3) R, G, B: the table's light over the lit table's
    brightness: Float32  # (n, n) its mean over the channels, clipped against what is no table
    facets: Facets

    @staticmethod
    def of(view: View, body: Proxy) -> "Seen | None":
        """None where next to nothing of the table is in view."""
        picture = linear_picture(view)
        table = table_around(view, body, picture)
        if table is None:
            return None
        kernel = np.ones((2 * BESIDE_PX + 1,) * 2, np.uint8)
        clear = cv2.erode(view.is_ground.astype(np.uint8), kernel) > 0
        light = np.asarray(cv2.transform(picture, np.full((1, 3), 1 / 3)), dtype=np.float32)
        relative = relative_light(table)
        brightness = np.minimum(relative.mean(axis=2), BRIGHTEST).astype(np.float32)
        facets = facets_of(view, body, picture)
        return Seen(view, body, picture, light, clear, table, relative, brightness, facets)

    @property
    def beside_body(self) -> float:
        """The brightest of the table near the body over the open table's light."""
        middle, reach = SIDE // 2, round(BESIDE_HEIGHTS * CELLS_A_HEIGHT)
        near = np.s_[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1]
        values = self.relative[near][self.table.seen[near]]
        return float(np.percentile(values.mean(axis=1), 90)) if len(values) else 1.0

    @property
    def lit_rgb(self) -> Float:
        """(3,) linear light of the lit table, R, G, B."""
        seen = self.table.light_rgb[self.table.seen] / np.maximum(self.relative[self.table.seen], 1e-6)
        return np.asarray(np.median(seen, axis=0), dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class FoundLight:
    """A light of a known body."""

    light: Float  # (4,) homogeneous, marker frame
    covariance: Float  # (2, 2) of s = (x, y) / z
    fit: EdgeFit | None  # None where the shadow's edges are hidden: the direction is that of a template
    darkening: float  # part of the table's light that it gives


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a picture of a known body says of its lights."""

    lights: tuple[FoundLight, ...]  # the strongest first
    confidence: float  # probability that the first one is within 10 degrees of the truth
    log_likelihood: float  # of the first one over none
    is_dark_elsewhere: bool  # something darkens the table that is not its shadow


def lights_of(seen: Seen) -> Found | None:
    """None where nothing says that there is a light."""
    templates = templates_of(seen.body)
    weight = seen.table.seen.astype(np.float32)
    nothing = np.zeros((0, weight.size), np.float32)
    scan = scanned(seen.brightness, weight, templates.shadows, templates.hidden_sky, nothing)
    by_shading = _by_shading(seen, templates.lights)
    total = scan.log_likelihood + by_shading
    prior = np.log(templates.solid_angle[:, None] / len(SKY_SHARES))
    none = LOG_NONE + float(_by_shading_alone(seen))
    best = total.max(axis=1)
    candidates = _refined(seen, best, templates.lights, seen.clear, nothing)
    if not candidates:
        return None
    scored = [
        (max(likelihood, _log_likelihood(seen, each, nothing, templates.hidden_sky)) + _edge_log_odds(each.fit), each)
        for likelihood, each in candidates
    ]
    likelihood, first = max(scored, key=lambda pair: pair[0])
    posterior = np.exp((total + prior) - max(float((total + prior).max()), none))
    sum_of_all = posterior.sum() + math.exp(none - max(float((total + prior).max()), none))
    near = templates.lights[:, :3] @ normalised(first.light[:3]) > math.cos(NEAR_RAD)
    confidence = float(posterior[near].sum() / sum_of_all)
    step = float(darkenings_rgb(seen, [first])[0].mean())
    confidence = _with_edges(confidence, first.fit, step) if step > PALEST else 0.0
    found = [first]
    while len(found) < MOST_LIGHTS:
        further = _further(seen, found, weight)
        if further is None:
            break
        found = _refitted(seen, [*found, further])
    found.sort(key=lambda each: -each.darkening)
    return Found(tuple(found), confidence, likelihood, likelihood > DARK_ELSEWHERE)


def _with_edges(confidence: float, fit: EdgeFit | None, step: float) -> float:
    """A probability of a direction, after a look at the edges that its shadow should have.

    step: part of the light that is lost across them. Pale ones speak against it only, as stains have edges, too.
    """
    if fit is None:
        return HIDDEN_EDGES * confidence
    most = MOST_LOG_ODDS if step > PALE else 0.0
    for_it = confidence * math.exp(float(np.clip(_edge_log_odds(fit), -MOST_LOG_ODDS, most)))
    return for_it / (for_it + 1 - confidence)


def _edge_log_odds(fit: EdgeFit | None) -> float:
    """What the shadow's edges say for it.

    Each independent place shows a step with the probability SHOWN where there is an edge and CHANCE where there is
    none; and an edge is found near where it is predicted, what is none anywhere within reach.
    """
    if fit is None:
        return 0.0
    places = fit.seen * POINTS / POINTS_A_SAMPLE
    near = float(np.clip(math.log(ANYWHERE / max(fit.misfit_share, 1e-6)), -MOST_NEAR, MOST_NEAR))
    shown = fit.clear * (math.log(SHOWN / CHANCE) + near)
    return places * (shown + (1 - fit.clear) * math.log((1 - SHOWN) / (1 - CHANCE)))


def darkenings_rgb(seen: Seen, found: Sequence[FoundLight]) -> Float:
    """(l, 3) part of the table's light, R, G, B, that each light gives: its shadow beside the lit table, at its edges.

    Where too little of a shadow's edges is seen, by least squares over the map.
    """
    by_map = _by_map(seen, [each.light for each in found])
    several = []
    for number, one in enumerate(found):
        lit = seen.clear.copy()
        for other in [*found[:number], *found[number + 1 :]]:
            lit &= ~predicted(seen.body, other.light[None], seen.view).shadow
        step = _step_rgb(seen, one, lit)
        several.append(by_map[number] if step is None else step)
    return np.array(several)


def _step_rgb(seen: Seen, one: FoundLight, lit: Mask) -> Float | None:
    """(3,) R, G, B: the light that is lost across the shadow's edges, over that beyond them; None where few are seen.

    lit: (h, w) table that no other shadow reaches.
    """
    edges = shadow_edges(seen.body, one.light, seen.view)
    if edges is None or one.fit is None:
        return None
    away = BEYOND_PX + 2.2 * (one.fit.size_rad or 0.0) * edges.by_size
    ends = [edges.points_px + sign * away[:, None] * edges.normals_px for sign in (-1, 1)]
    height, width = lit.shape
    columns, rows = np.round(np.moveaxis(np.array(ends), 2, 0)).astype(int)
    inside = ((columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)).all(axis=0)
    columns, rows = columns[:, inside], rows[:, inside]
    kept = lit[rows, columns].all(axis=0)
    if np.count_nonzero(kept) < FEWEST:
        return None
    dark, bright = seen.picture[rows[:, kept], columns[:, kept]].astype(np.float64)[..., ::-1]
    return np.asarray(1 - np.median(dark / np.maximum(bright, 1e-4), axis=0)).clip(0.0, 1.0)


def _by_map(seen: Seen, lights: Sequence[Float]) -> Float:
    templates = templates_of(seen.body)
    shadows = shadows_of(seen.body, np.array(lights))
    ones = np.ones((1, shadows.shape[1]), np.float32)
    varied = np.concatenate([ones, templates.hidden_sky[None], shadows])
    w = seen.table.seen.reshape(-1).astype(np.float32)
    normal = ((varied * w) @ varied.T).astype(np.float64) + 1e-6 * np.eye(len(varied))
    values = np.minimum(seen.relative, BRIGHTEST).reshape(-1, 3)
    level, _, *dark = np.linalg.solve(normal, (varied * w) @ values)
    return np.asarray(-np.array(dark) / np.maximum(level, 1e-3)).clip(0.0, 1.0)


def _by_shading(seen: Seen, lights: Float) -> Float:
    to_lights = lights[:, :3] / np.linalg.norm(lights[:, :3], axis=1, keepdims=True)
    return shading_log_likelihood(seen.facets, seen.lit_rgb, to_lights, SKY_SHARES.astype(np.float64))


def _by_shading_alone(seen: Seen) -> float:
    """Log likelihood of the facets' light under the sky alone."""
    return float(shading_log_likelihood(seen.facets, seen.lit_rgb, np.array([(0.0, 0.0, 1.0)]), np.ones(1))[0, 0])


def _refined(seen: Seen, score: Float, lights: Float, clear: Mask, also: Float32) -> list[tuple[float, FoundLight]]:
    """The likeliest different directions, moved onto the shadow's edges, with their scores before."""
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
    hidden_sky = templates_of(seen.body).hidden_sky
    scan = scanned(seen.brightness, seen.table.seen.astype(np.float32), shadows_of(seen.body, lights), hidden_sky, also)
    score = scan.log_likelihood + _by_shading(seen, lights)
    best, share = np.unravel_index(int(score.argmax()), score.shape)
    return float(score[best, share]), lights[best], float(scan.darkening[best].max())


def _spread(score: Float, lights: Float, start: Float) -> Float:
    """(2, 2) covariance of s by the templates near `start` (4,), each as likely as its score says."""
    near = lights[:, :3] @ normalised(start[:3]) > math.cos(2 * APART_RAD)
    weight = np.exp(score[near] - score[near].max())
    s = lights[near, :2] / lights[near, 2:3] - start[:2] / start[2]
    spread = (weight[:, None] * s).T @ s / weight.sum()
    # No finer than the templates lie.
    return np.asarray(spread + (0.1 * (1 + float(np.hypot(*start[:2])) / start[2])) ** 2 * np.eye(2))


def _log_likelihood(seen: Seen, one: FoundLight, also: Float32, hidden_sky: Float32) -> float:
    shadows = shadows_of(seen.body, one.light[None])
    scan = scanned(seen.brightness, seen.table.seen.astype(np.float32), shadows, hidden_sky, also)
    return float((scan.log_likelihood + _by_shading(seen, one.light[None])).max())


def _further(seen: Seen, known: Sequence[FoundLight], weight: Float32) -> FoundLight | None:
    """Another light, whose shadow the map shows beside those of the lights that are known."""
    templates = templates_of(seen.body)
    also = shadows_of(seen.body, np.array([each.light for each in known]))
    scan = scanned(seen.brightness, weight, templates.shadows, templates.hidden_sky, also)
    none = _without_another(seen, weight, also, templates.hidden_sky)
    score = scan.log_likelihood.max(axis=1) - none
    for each in known:
        to_light = normalised(each.light[:3])
        score = np.where(templates.lights[:, :3] @ to_light > math.cos(APART_RAD), -np.inf, score)
    if not score.max() > LEAST_SCORE:
        return None
    clear = _clear_of(seen, known)
    best, likeliest = LEAST_MORE, None
    for _, one in _refined(seen, score, templates.lights, clear, also):
        is_clear = one.fit is not None and one.fit.clear > LEAST_CLEAR and one.fit.misfit_px < MOST_MISFIT_PX
        shadow = shadows_of(seen.body, one.light[None])
        with_it = scanned(seen.brightness, weight, shadow, templates.hidden_sky, also).log_likelihood.max()
        more = float(with_it) - none + _edge_log_odds(one.fit)
        if is_clear and one.darkening > LEAST_DARKENING and more > best:
            best, likeliest = more, one
    return likeliest


def _without_another(seen: Seen, weight: Float32, also: Float32, hidden_sky: Float32) -> float:
    """What a scan says of a shadow that is nowhere: by the sky's share alone."""
    empty = np.zeros((1, weight.size), np.float32)
    return float(scanned(seen.brightness, weight, empty, hidden_sky, also).log_likelihood.max())


def _clear_of(seen: Seen, others: Sequence[FoundLight]) -> Mask:
    """The bare table without what lies near the edges of other lights' shadows."""
    clear = seen.clear
    for other in others:
        edges = shadow_edges(seen.body, other.light, seen.view)
        if edges is not None:
            size = (other.fit.size_rad or 0.0) if other.fit is not None else 0.0
            clear = without(clear, edges, 3.0 + 2 * size * float(np.percentile(edges.by_size, 90)))
    return clear


def _refitted(seen: Seen, found: Sequence[FoundLight]) -> list[FoundLight]:
    """Each light fitted again, beside the others' shadows."""
    dark = darkenings_rgb(seen, found).mean(axis=1)
    fitted_again = []
    for number, (one, darkening) in enumerate(zip(found, dark, strict=True)):
        clear = _clear_of(seen, [*found[:number], *found[number + 1 :]])
        fit = fitted(seen.body, one.light, float(darkening), seen.light, room_of(clear), seen.view)
        if fit is None or normalised(fit.light[:3]) @ normalised(one.light[:3]) < math.cos(APART_RAD):
            fitted_again.append(FoundLight(one.light, one.covariance, one.fit, float(darkening)))
        else:
            fitted_again.append(FoundLight(fit.light, fit.covariance, fit, float(darkening)))
    return fitted_again
