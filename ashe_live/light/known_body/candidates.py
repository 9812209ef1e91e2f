"""Where a light may be: the likeliest directions of the scan, moved onto the edges of their shadows."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.found_light import FoundLight
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.outline.by_edges import by_edges
from ashe_live.light.known_body.outline.confirmed import confirmed
from ashe_live.light.known_body.outline.fit import ShadowFit, fitted
from ashe_live.light.known_body.outline.odds import edge_log_odds
from ashe_live.light.known_body.outline.profiles import EdgeImages
from ashe_live.light.known_body.rims import LEAST_DARKENING
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.templates import Templates
from ashe_live.light.shape.light_points import at_infinity

# The number of directions from which fits start, at most; and with those counted that turn out to be no light, or whose
# shadow should be seen and is not.
TRIED, MOST_TRIED = 3, 8
APART_RAD = math.radians(12)  # between two starts, at least
TRIED_WITHIN = 12.0  # log odds by which a start may be less likely than one that explains the picture
MOST_MOVED_RAD = math.radians(15)  # by a fit: what moves farther has found other edges
LAMP_NEARNESS = 3.0  # 1/m, w / z of a lamp from which a fit starts
# The part of the visible edges that shows a step: a fit with less has found others, one with more needs no rival.
LEAST_CLEAR, CLEAR = 0.5, 0.8
MOST_IN_VIEW = 0.25  # part of a shadow's outline that may be in view although none of its edges is found
# Displacements s = (x, y) / z that are tried around a template's, along it and across, over 1/2 + |s|: first as far as
# the next template; then finer and along it alone, as the scan hardly constrains how long shadows are that leave the
# picture.
AROUND = 0.05 * np.array([(along, across) for along in (-2, -1, 0, 1, 2) for across in (-1, 0, 1)])
ALONG = 0.035 * np.array([(along, 0) for along in range(-8, 4)])
TEMPLATES_APART = 0.1  # between displacements of neighbouring templates, over 1 + |s|, roughly


class _Starts:
    """The directions from which fits start, the likeliest first, as long as another is worth its time."""

    def __init__(self, lights: Float, log_odds: Float) -> None:
        """lights: (m, 4). log_odds: (m,) by which they are likely; -inf where none is to be tried."""
        self._lights, self._log_odds, self._left = lights, log_odds, log_odds.copy()
        self._spent, self._least = 0, -math.inf

    def __iter__(self) -> Iterator[int]:
        """Their numbers among the lights, no two of them within APART_RAD."""
        for _ in range(MOST_TRIED):
            number = int(self._left.argmax())
            if self._spent == TRIED or self._left[number] == -np.inf or self._left[number] < self._least:
                return
            self._left[self._lights[:, :3] @ self._lights[number, :3] > math.cos(APART_RAD)] = -np.inf
            yield number

    def spend(self) -> None:
        """Counts the last one as one of those TRIED."""
        self._spent += 1

    def explained_by(self, number: int) -> None:
        """This one explains the picture: none is tried that is less likely by more than TRIED_WITHIN."""
        self._least = max(self._least, float(self._log_odds[number]) - TRIED_WITHIN)


@dataclass(frozen=True, slots=True, eq=False)
class _Start:
    """A light from which a fit begins."""

    light: Float  # (4,)
    darkening: float  # part of the table's light that it would give
    log_likelihood: float


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """The directions of the scan in which another light may be, beside those that are known."""

    seen: Seen
    beside: MarginalLikelihood  # of what is seen, beside the known lights
    images: EdgeImages  # likewise
    score: Float  # (m,) log likelihood of each direction; -inf where none is looked for
    steps: Float  # (m,) log odds of each by its shadow's steps of light in the map: with the score, the order of trial
    least: float = -math.inf  # none is tried whose score is below this both with its steps and without
    least_around: float = -math.inf  # no edges are looked for where even the likeliest direction around scores less

    def refined(self) -> tuple[list[FoundLight], list[Float]]:
        """The likeliest different directions, each moved onto its shadow's edges where these are seen; and lights (4,)
        that are ruled out.

        Ruled out are those whose shadow, or whose light on the body's sides, should be seen and is not, and edges that
        no light casts: some other thing is dark there.
        """
        starts = _Starts(self.seen.templates.lights, self.score + self.steps)
        found: list[FoundLight] = []
        ruled_out: list[Float] = []
        for number in starts:
            template = self.seen.templates.lights[number]
            if max(self.score[number], self.score[number] + self.steps[number]) < self.least:
                starts.spend()
                continue
            start = self._start(number)
            if start.darkening < LEAST_DARKENING or start.log_likelihood < self.least_around:
                continue
            if any(_is_clear(one) and _finds_again(self.seen, start.light, one) for one in found):
                continue
            fit, darkening = self._fit(number, start)
            if fit is not None and self._is_none(fit, darkening):
                ruled_out.append(template)
            elif fit is not None:
                starts.spend()
                found.append(FoundLight(fit.light, fit.covariance[:2, :2], fit, darkening))
                if _is_clear(found[-1]):  # else map and score were another thing's
                    starts.explained_by(number)
            elif self.images.shown(template) <= MOST_IN_VIEW:
                starts.spend()
                starts.explained_by(number)
                found.append(mean_near(self.seen.templates, self.score, self._darkenings, template))
            else:
                ruled_out.append(template)
        return found, ruled_out

    def _is_none(self, fit: ShadowFit, darkening: float) -> bool:
        """Whether there is no such light, although some edges are seen where those of its shadow would be."""
        if self.seen.observed.sides.deny(fit.light, darkening):
            return True
        if fit.light[3] >= 0:
            return False
        edges = by_edges(self.images, fit, darkening)
        return edges is not None and edges.is_beyond_suns

    @property
    def _darkenings(self) -> Float:
        """(m,) part of the table's light that a light in each direction would give."""
        return self.beside.everywhere.darkenings[:, -1]

    def _start(self, number: int) -> _Start:
        """Where a fit starts near a template, with darkening and log likelihood of the best light around."""
        template = self.seen.templates.lights[number]
        nearby = _nearby(self.seen, template, self.beside)
        # If only steps in the picture speak for this one, there may be a stain where map and sides are best nearby.
        return replace(nearby, light=template) if self.score[number] < 0 else nearby

    def _fit(self, number: int, start: _Start) -> tuple[ShadowFit | None, float]:
        """The fit from a start near a template, and the darkening that it was made with."""
        fit = _moved_onto_edges(self.images, start.light, start.darkening)
        if fit is None and self.steps[number] >= 0 and self.score[number] >= 0:
            # The map is misled by its stains, and may have led away from what is there.
            own = float(self._darkenings[number])
            template = self.seen.templates.lights[number]
            at_template = _moved_onto_edges(self.images, template, own)
            if at_template is not None and at_template.clear > CLEAR:
                return at_template, own
        return fit, start.darkening


def _is_clear(found: FoundLight) -> bool:
    """Whether so many of its shadow's edges are steps that no rival is needed."""
    return found.fit is not None and found.fit.clear > CLEAR


def _finds_again(seen: Seen, start: Float, found: FoundLight) -> bool:
    """Whether a fit from a light (4,) would end at one that was found, whose edges are clear."""
    return bool(normalised(start[:3]) @ found.sun_alike(seen.body.height_m) > math.cos(APART_RAD))


def _moved_onto_edges(images: EdgeImages, start: Float, darkening: float) -> ShadowFit | None:
    """The fit near a sun `start` (4,): as a sun, or as a lamp where no sun explains the edges; None if neither does."""
    if darkening <= 0:
        return None
    image = images.showing(start)
    lamp = np.append(start[:2] / start[2] * (1 - LAMP_NEARNESS * image.height_m), (1.0, LAMP_NEARNESS))
    best: ShadowFit | None = None
    for light, is_lamp in ((start, False), (lamp, True)):
        fit = fitted(image, light, darkening, with_nearness=is_lamp)
        fit = None if fit is None else confirmed(fit, images, darkening)
        is_near = fit is not None and normalised(fit.light[:3]) @ normalised(light[:3]) > math.cos(MOST_MOVED_RAD)
        if fit is not None and is_near and fit.clear > LEAST_CLEAR and edge_log_odds(fit) > edge_log_odds(best):
            best = fit
        if best is not None and best.clear > CLEAR:
            break
    return best


def _nearby(seen: Seen, template: Float, beside: MarginalLikelihood) -> _Start:
    """The likeliest light around a template (4,)."""
    s = template[:2] / template[2]
    for offsets in (AROUND, ALONG):
        length = max(math.hypot(*s), 1e-9)
        around = s + (0.5 + length) * offsets @ (np.array([s, (-s[1], s[0])]) / length)
        lights = at_infinity(np.column_stack([around, np.ones(len(around))]))
        scan = beside.scanned(seen.lit(lights))
        best = int(scan.log_likelihood.argmax())
        s = around[best]
    return _Start(lights[best], float(scan.darkenings[best, -1]), float(scan.log_likelihood[best]))


def mean_near(templates: Templates, score: Float, darkenings: Float, light: Float) -> FoundLight:
    """The mean of the directions near a light (4,), whose edges are hidden: each is as likely as its score says."""
    near = templates.lights[:, :3] @ normalised(light[:3]) > math.cos(2 * APART_RAD)
    weight = templates.solid_angle[near] * np.exp(score[near] - score[near].max())
    weight /= weight.sum()
    # Directions are averaged, as displacements are long-tailed towards the horizon.
    mean = normalised(weight @ templates.lights[near, :3])
    mean = np.append(mean / mean[2], 0.0)
    away = templates.lights[near, :2] / templates.lights[near, 2:3] - mean[:2]
    # No finer than the templates lie.
    apart = TEMPLATES_APART * (1 + math.hypot(*mean[:2]))
    covariance = (weight[:, None] * away).T @ away + apart**2 * np.eye(2)
    return FoundLight(mean, covariance, None, float(weight @ darkenings[near]))
