"""The search for what one view may show: fits to the likeliest splits of its unlit regions, the likeliest refined."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, partial

import numpy as np

from ashe_live.core.arrays import Mask
from ashe_live.core.caster import Caster
from ashe_live.core.light import StageClock
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.estimators.proposals import proposals_of, selected_for_fit
from ashe_live.light.estimators.refining import LogOdds, Refiner, leaves_no_doubt
from ashe_live.light.explanation.explain import Proposal, explained, explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.context import Context
from ashe_live.light.explanation.judgement.judge import Judge
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.searches.known_place import explanations_by_place, hints_of
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.glint import Glint, glint_in
from ashe_live.light.ground.lit_ground import SPECK_SHARE, LitGround, with_unlit_on_average
from ashe_live.light.ground.regions import Region, unlit_regions
from ashe_live.light.ground.shadow_shift import FINE, shadow_shifts, voted_for
from ashe_live.light.ground.sheet_shadow import SheetShadow, sheet_shadow_in
from ashe_live.light.lamps.hypotheses import LampHypotheses
from ashe_live.light.pixels.view import View

HINTS = 5  # number of lights in which a known object's place is searched
# Angle, and distance over a known object's size, within which an explanation by place is one that was found before.
FOUND_AGAIN_RAD, FOUND_AGAIN_SHARE = math.radians(1), 0.03


@dataclass(slots=True, eq=False)
class Trace:
    """Intermediate results, filled in by the stages in this order; None or empty for stages that were not reached."""

    view: View  # at the size at which the ground is modelled
    ground: LitGround | None = None
    sheet_shadow: SheetShadow | None = None
    glint: Glint | None = None
    unlit: Mask | None = None  # (h, w) of `view`: pixels that the lit ground does not explain
    regions: list[Region] = field(default_factory=list)
    proposals: list[Proposal] = field(default_factory=list)  # those that were fitted
    rough: list[Explanation] = field(default_factory=list)  # the proposals, fitted and aligned
    # What the judge chose from: the likeliest different ones, relabelled and refitted; then the other fitted ones.
    judged: list[Explanation] = field(default_factory=list)
    probabilities: list[float] = field(default_factory=list)  # of each of `judged` to be the right one


class ViewSearch:
    """Looks for explanations of one view, and keeps in its trace what it found on the way."""

    def __init__(self, view: SceneView, preset: ProxyPreset, judge: Judge, clock: StageClock) -> None:
        """Segments the view; explanations are looked for as they are asked for."""
        self.view, self.preset, self.judge, self.clock = view, preset, judge, clock
        self._sharpener = Sharpener.of([view.fine])
        coarse, ground = view.coarse, view.ground
        unlit = with_unlit_on_average(view.unlit(round(SPECK_SHARE * coarse.is_ground.size)), coarse)
        sheet_shadow, glint = sheet_shadow_in(view.fine), glint_in(coarse, ground)
        self.unlit = unlit if glint is None else unlit & ~glint.halo
        regions = unlit_regions(view.fine, self.unlit, ground, preset.region_px, preset.regions)
        self.trace = Trace(coarse, ground, sheet_shadow, glint, self.unlit, regions)
        clock.end("segment")

    def another(self, view: SceneView, preset: ProxyPreset) -> "ViewSearch":
        """The search of another view, or by another preset."""
        return ViewSearch(view, preset, self.judge, self.clock)

    @cached_property
    def explanations(self) -> tuple[list[Explanation], list[float]]:
        """The explanations of the view, the likeliest refined, and their log odds; none if nothing stands out."""
        rough = self.rough()
        if not rough:
            return [], []
        refiner = Refiner(self.view, self._sharpener, self.preset, self.lamps)
        found = refiner.refined_and_others(rough, self.log_odds_among(rough))
        self.clock.end("fit")
        caster = self.preset.caster
        if caster is not None and not leaves_no_doubt(found, self.log_odds_among(found)):
            found += self._found_by_place(caster, found, refiner)
            self.clock.end("fit")
        log_odds = list(map(self.log_odds_among(found), found))
        self.clock.end("judge")
        return found, log_odds

    def rough(self) -> list[Explanation]:
        """The explanations by fits to the likeliest splits; none if nothing stands out from the ground."""
        ground, preset, trace = self.view.ground, self.preset, self.trace
        proposals: list[Proposal] = []
        voted = partial(voted_for, ground=ground, count=preset.shifts, widths=(1.0, FINE))
        everywhere = voted(ground.colours[self.unlit])
        for region in trace.regions:
            # Its own pixels vote first, as others could outvote its shadow; then all, as shadows share their lights.
            own = voted(region.colours[region.unlit])
            shifts, paired = (shadow_shifts(votes) for votes in zip(own, everywhere, strict=True))
            proposals += proposals_of(region, ground, shifts, paired)
        self.clock.end("associate")
        trace.proposals = selected_for_fit(proposals, preset.tried, self.judge)
        trace.rough = self._fitted(preset)
        self.clock.end("fit")
        return trace.rough

    def _fitted(self, preset: ProxyPreset) -> list[Explanation]:
        """The explanations by fits to the selected splits, of the object of `preset` or any."""
        proposals, fit = self.trace.proposals, preset.first_fit
        suns = [each for each in explained(proposals, fit) if each] if proposals else []
        return self._sharpener.measured(self.lamps.likelier(suns, partial(explained_near, preset=fit)))

    @cached_property
    def lamps(self) -> LampHypotheses:
        """Those that the fall of light over the view's ground suggests."""
        return LampHypotheses.of(self.view.coarse, self.view.ground, self.unlit, self.preset.light)

    def log_odds_among(self, several: Sequence[Explanation]) -> LogOdds:
        """The log odds of an explanation, judged beside these several."""
        context = self.context_of(several)

        def log_odds(each: Explanation) -> float:
            return self.judge.log_odds(each, context) + self.lamps.agreement(each)

        return cache(log_odds)

    def context_of(self, several: Sequence[Explanation]) -> Context:
        """The context of an explanation of the view: these several, and what else shows the light."""
        return Context(several, self.trace.glint, self.trace.sheet_shadow)

    def _found_by_place(self, caster: Caster, found: Sequence[Explanation], refiner: Refiner) -> list[Explanation]:
        """Where the known object may stand in the lights that it, or any object of the picture, may show.

        found: explanations by the known object.
        """
        log_odds = self.log_odds_among(found)
        # The splits are the same whichever object is looked for.
        by_any = self._fitted(self.preset.assuming(self.preset.light))
        likeliest = sorted(by_any, key=self.log_odds_among(by_any), reverse=True)[:HINTS]
        hints = hints_of([*likeliest, *sorted(found, key=log_odds, reverse=True)], HINTS)
        placed = explanations_by_place(caster, hints, self.view, self.unlit, self.preset.region_px)
        likeliest = sorted(self._sharpener.measured(placed), key=log_odds, reverse=True)[: self.preset.refined + 1]
        sharp = refiner.refined_alone(likeliest)
        return [each for each in sharp if not any(_is_same(each, one) for one in found)]


def _is_same(one: Explanation, other: Explanation) -> bool:
    """Whether two explanations of one known object have it at one place in one light."""
    away = float(np.linalg.norm(one.proxy.foot_marker - other.proxy.foot_marker))
    near = angle_between(one.lights[0].to_light_marker, other.lights[0].to_light_marker)
    size = one.lit.body.frame.unit_m
    return near < FOUND_AGAIN_RAD and away < FOUND_AGAIN_SHARE * size and len(one.lights) == len(other.lights)
