"""Lamps in the place of suns: an explanation's labels fitted with a near light, and the evidence that it is one.

A lamp's shadow widens with height. By a sun it is that of another body, if of any: the direction is wrong, and the
outlines miss their steps of light. Two independent sources of evidence decide whether a light is near: the outlines,
fitted anew by either light, and the fall of light over the ground.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.explanation.alignment import COST_PER_PARAMETER, criterion
from ashe_live.light.explanation.explain import NearFit
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.shadow_shift import shadow_ratio
from ashe_live.light.lamps.fall.fall_directions import PRIOR_NEARNESSES, FallDirections
from ashe_live.light.lamps.fall.fall_off import FallOff
from ashe_live.light.lamps.fall.lit_samples import clear_of
from ashe_live.light.lamps.kinds import SUN
from ashe_live.light.lamps.near_fits import fitted_near, in_all_views, nearness_prior
from ashe_live.light.lamps.sources import shadow_middle, share_of
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import lamp_parameters, light_parameters, nearness_of

NEARNESSES = (0.4, 0.6, 0.9, 1.3, 1.9, 2.7, 3.9, 5.5, 7.7)  # 1/m, of the lamps that are tried; each 1.4 times the last
# Factors on the likeliest of them by the fall of light, to which bodies are fitted; in several views all lead to one.
AROUND, AROUND_IN_VIEWS = (0.7, 1.0, 1.4), (1.0,)
# Deviances of a sun by the fall of light (twice the log of a likelihood ratio) from which on bodies are fitted to
# lamps: to refined explanations, and to rough ones.
WORTH_FITTING, WORTH_FITTING_ROUGH = 4.0, 20.0
# The outlines' deviance counts so much at most: another local minimum of the fit may change it by any amount. Several
# views show a shadow's parallax, by which no other body in a sun's light passes for a lamp's.
MOST_BY_OUTLINES, MOST_IN_VIEWS = 20.0, 40.0
PARAMETER_DEVIANCE = 3.5  # of one shape parameter in the outlines' criterion: the log of their effective sample size
# Deviances of a sun above which a light is a lamp. By both sources together it takes LAMP_DEVIANCE, if LEAST_BY_FALL of
# it is by the fall of light and the outlines are not as much against a lamp as they may be. Where the outlines are, or
# were not compared, it takes ALONE_DEVIANCE, as uneven ground may contribute more than its model allows.
LAMP_DEVIANCE, LEAST_BY_FALL, ALONE_DEVIANCE = 33.0, 13.0, 60.0
# The same by both in several views, whose outlines' deviance is scaled by their dispersion: of the suns in 27 takes the
# surest has 15. Neither may favour the sun.
DEVIANCE_IN_VIEWS, LEAST_IN_VIEWS = 20.0, 0.0


@dataclass(frozen=True, slots=True, eq=False)
class LampEvidence:
    """An explanation by a lamp in the place of a sun, and by how much the sun is less likely."""

    lamp: Explanation | None  # None where the fall of light asks for none
    by_fall: float  # deviance of the sun by the fall of light, if unevenness is at its worst
    by_outlines: float  # the same by the outlines, limited; 0 where these were not compared
    in_views: bool = False  # whether outlines are those of several views

    @property
    def deviance(self) -> float:
        """Of the sun, by both."""
        return self.by_fall + self.by_outlines

    @property
    def is_lamp(self) -> bool:
        """Whether the light is surely no sun."""
        if self.in_views:
            both = min(self.by_fall, self.by_outlines) > LEAST_IN_VIEWS and self.deviance > DEVIANCE_IN_VIEWS
        else:
            outlines_allow_it = self.by_outlines != 0 and self.by_outlines > -MOST_BY_OUTLINES
            both = outlines_allow_it and self.by_fall > LEAST_BY_FALL and self.deviance > LAMP_DEVIANCE
        return self.lamp is not None and (both or self.deviance > ALONE_DEVIANCE)


NO_LAMP = LampEvidence(None, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class LampHypotheses:
    """The fall of light over the ground of a view, by which lamps are tried in the place of suns."""

    fall_off: FallOff | None  # None where too little lit ground is seen, or lights are taken for suns: no lamp is tried
    ground: LitGround

    @staticmethod
    def of(view: View, ground: LitGround, unlit: Mask, kind: str) -> "LampHypotheses":
        """Of the view that `ground` was fitted to, beside what is `unlit` (h, w); kind: one of KINDS."""
        return LampHypotheses(None if kind == SUN else FallOff.of(view, ground, clear_of(unlit)), ground)

    def evidence(self, sun: Explanation, fit: NearFit, sharpener: Sharpener) -> LampEvidence:
        """The explanation, whose lights are at infinity and moved onto steps of light, by the likeliest lamp.

        fit: of one view. sharpener: of all views that are explained, that of the answer first.
        """
        nearness, deviance = self._by_fall(sun)
        worth, around = (LEAST_IN_VIEWS, AROUND_IN_VIEWS) if _is_in_views(sun) else (WORTH_FITTING, AROUND)
        if nearness == 0 or deviance < worth:
            return NO_LAMP
        tried, prior = [factor * nearness for factor in around], nearness_prior(nearness)
        fits = zip(tried, fit([(sun, each) for each in tried]), strict=True)
        lamps = [in_all_views(sun, again, held, prior, sharpener) for held, again in fits]
        found = [self._compared(sun, lamp) for lamp in lamps if lamp is not None]
        return max(found, key=attrgetter("deviance"), default=NO_LAMP)

    @cached_property
    def _directions(self) -> FallDirections | None:
        return None if self.fall_off is None else FallDirections(self.fall_off)

    def agreement(self, explanation: Explanation) -> float:
        """Log of how much likelier a direction is than any by how the ground is lit; 0 where that is alike all over."""
        if self._directions is None:
            return 0.0
        lit = explanation.lit
        return self._directions.log_ratio(light_parameters(lit.first_light_near((0.0, *PRIOR_NEARNESSES))))

    def decided(self, explanation: Explanation, fit: NearFit, sharpener: Sharpener) -> Explanation:
        """The explanation, moved onto steps of light, by a lamp if that is sure, else by a sun.

        A lamp's own nearness is tried beside that which the fall of light asks for in the sun's direction: a sun's
        direction is not the lamp's, and the fall of light changes with it.
        """
        if not explanation.lights[0].is_lamp:
            return _decided(explanation, self.evidence(explanation, fit, sharpener))
        nearness = float(nearness_of(explanation.lights[0].light))
        sun, lamp = (fitted_near(explanation, each, fit, sharpener) for each in (0.0, nearness))
        if sun is None:
            return explanation
        several = [self.evidence(sun, fit, sharpener)]
        if lamp is not None and self.fall_off is not None:
            several.append(self._compared(sun, lamp))
        return _decided(sun, max(several, key=attrgetter("deviance")))

    def likelier(self, suns: Sequence[Explanation], fit: NearFit) -> list[Explanation]:
        """Each rough explanation, or in its place a lamp's where the fall of light asks for one and outlines agree."""
        by_fall = [self._by_fall(each) for each in suns]
        near = [i for i, (_, deviance) in enumerate(by_fall) if deviance >= WORTH_FITTING_ROUGH]
        likelier = list(suns)
        lamps = fit([(suns[i], by_fall[i][0]) for i in near]) if near else []
        for i, lamp in zip(near, lamps, strict=True):
            if lamp is None:
                continue
            as_sun, as_lamp = (criterion(each.alignment.placed) / COST_PER_PARAMETER for each in (suns[i], lamp))
            if by_fall[i][1] + _limited(as_sun - as_lamp) > 0:
                likelier[i] = lamp
        return likelier

    def _by_fall(self, sun: Explanation) -> tuple[float, float]:
        """The nearness of a lamp in the direction that the body sees, by the fall of light, and a sun's deviance."""
        if self.fall_off is None or len(sun.lights) > 1:
            return 0.0, 0.0
        costs = self._costs(sun, sun.lit.first_light_near((0.0, *NEARNESSES)))
        best = int(np.argmin(costs[1:]))
        return NEARNESSES[best], float(costs[0] - costs[1 + best])

    def _compared(self, sun: Explanation, lamp: Explanation) -> LampEvidence:
        (as_sun,), (as_lamp,) = (self._costs(each, each.lights[0].light[None]) for each in (sun, lamp))
        return LampEvidence(lamp, float(as_sun - as_lamp), _by_outlines(sun, lamp), _is_in_views(lamp))

    def _costs(self, explanation: Explanation, lights: Float) -> Float:
        """(n,) of the fall of light in each of the lights (n, 4) in the place of the explanation's first one."""
        assert self.fall_off is not None
        share = share_of(shadow_ratio(self.ground, np.asarray(explanation.materials.shift)))
        return self.fall_off.worst_costs(lamp_parameters(lights), share, shadow_middle(explanation))


def _decided(sun: Explanation, evidence: LampEvidence) -> Explanation:
    if evidence.lamp is None:
        return sun
    return evidence.lamp if evidence.is_lamp else replace(sun, sun_by_outlines=evidence.by_outlines)


def _by_outlines(sun: Explanation, lamp: Explanation) -> float:
    """The deviance of the sun by the outlines; 0 where one was not measured.

    What a lamp's body misses of the steps of light in all views is its model's error, by which any two bodies differ:
    there the deviance is scaled by that dispersion.
    """
    if not _is_in_views(lamp):
        return _limited(sun.criterion - lamp.criterion)
    dispersion = max(lamp.steps.body, lamp.steps.shadow, 1.0)
    return _limited((sun.criterion - lamp.criterion) / dispersion, MOST_IN_VIEWS)


def _is_in_views(explanation: Explanation) -> bool:
    return bool(explanation.alignment.elsewhere)


def _limited(parameters: float, most: float = MOST_BY_OUTLINES) -> float:
    """The deviance of a difference of criteria, in penalties of one parameter; 0 where one was not measured."""
    deviance = PARAMETER_DEVIANCE * parameters
    return min(max(deviance, -most), most) if math.isfinite(deviance) else 0.0
