"""The estimator `proxy`: fits a simple body and a light to a real object and its shadow.

segment -> associate -> fit -> judge, each of pure functions in files of their own: `ground` and `regions` find what the
lit ground does not explain; `shift` and `associate` propose which of it is shadow of which object; `fit` finds bodies
and lights that explain both outlines, `alignment` moves the likeliest to the picture's own borders, and `explain` goes
round once more with the pixels labelled by it; `judge` says how far to believe the best explanation, or that there is
nothing to believe.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.stages import StageClock
from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.light.explanation.evidence import Explanation, shadow_core
from ashe_live.light.explanation.explain import Proposal, are_alike, explained, finer, sharpened
from ashe_live.light.explanation.judge import LEAST_CONFIDENCE, best_of, lights_of, likeliest, log_odds, promise
from ashe_live.light.explanation.no_answer import (
    NO_SHADOW,
    NOTHING_THERE,
    TOO_LITTLE_GROUND,
    fault_of_exposure,
    fault_of_scene,
)
from ashe_live.light.explanation.penumbra import angular_size
from ashe_live.light.explanation.second_light import with_their_lights
from ashe_live.light.ground.lit_ground import GroundSteps, LitGround, fit_lit_ground, lit_rgb, unlit_mask
from ashe_live.light.ground.regions import Region, unlit_regions
from ashe_live.light.ground.shadow_shift import FINE, shadow_ratio, shadow_shifts, shift_within
from ashe_live.light.labels.associate import distinct, doubted, splits
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.labels.two_lights import are_two, likeliest_pairs, materials_of_two, parted, savings
from ashe_live.light.outline_fit import fit as fitting
from ashe_live.light.pixels.view import View

# Of the coarse picture: smaller things are specks.
LEAST_SHARE = 0.0005


@dataclass(frozen=True, slots=True)
class ProxySteps:
    """How much work the estimator spends: the numbers that the presets differ in."""

    coarse_width_px: int  # at which the ground is modelled and unlit regions are found
    fine_width_px: int  # no region is looked at more finely than in a frame of this width
    region_px: int  # size at which a region is looked at
    regions: int
    shifts: int  # of a shadow's colour that are tried; as many are found more finely, to be paired
    pairs: int  # of those that are tried, one for each of two lights
    shadows_per_shift: int
    tried: int  # how many of the splits are fitted, those that look best
    pairs_tried: int  # and how many of those into two lights' shadows
    refined: int  # how many of the fits are worked out, the best ones
    rounds: int  # of relabelling by the fit and fitting to the labels
    ground: GroundSteps
    first_fit: fitting.FitPreset
    fine_fit: fitting.FitPreset


FAST = ProxySteps(
    coarse_width_px=240,
    fine_width_px=480,
    region_px=90,
    regions=2,
    shifts=5,
    pairs=1,
    shadows_per_shift=2,
    tried=4,
    pairs_tried=1,
    refined=2,
    rounds=1,
    ground=GroundSteps(12, 8, 1),
    first_fit=fitting.FAST,
    fine_fit=fitting.FAST,
)
BALANCED = ProxySteps(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=3,
    shifts=8,
    pairs=1,
    shadows_per_shift=2,
    tried=6,
    pairs_tried=1,
    refined=2,
    rounds=1,
    ground=GroundSteps(),
    first_fit=fitting.FAST,
    fine_fit=fitting.BALANCED,
)
ACCURATE = ProxySteps(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=4,
    shifts=12,
    pairs=1,
    shadows_per_shift=2,
    tried=16,
    pairs_tried=1,
    refined=4,
    rounds=1,
    ground=GroundSteps(),
    first_fit=fitting.FAST,
    fine_fit=fitting.BALANCED,
)


PRESETS = {"fast": FAST, "balanced": BALANCED, "accurate": ACCURATE}


class ProxyEstimator:
    """Answers with one light or two, their covariances and confidence, or with a reason."""

    name = "proxy"

    def __init__(self, steps: ProxySteps = BALANCED) -> None:
        self._steps = steps

    def estimate(self, tracked: TrackedFrame) -> LightEstimate:
        """As Estimator.estimate; the masks have the size at which the explained region was looked at."""
        if tracked.marker is None:
            raise ValueError("a frame without a marker has no marker frame to answer in")
        clock = StageClock()
        steps = self._steps
        fine = View.of(tracked, steps.fine_width_px)
        coarse = fine.scaled(steps.coarse_width_px)

        def none(reason: str, body: Mask | None = None, shadow: Mask | None = None) -> LightEstimate:
            reason = fault_of_exposure(coarse) or reason
            return LightEstimate(self.name, tracked.frame.index, (), reason, body, shadow, clock.timing_ms())

        ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, steps.ground)
        if ground is None:
            clock.end("segment")
            return none(TOO_LITTLE_GROUND)
        unlit = unlit_mask(ground, coarse.is_ground, round(LEAST_SHARE * coarse.is_ground.size))
        regions = unlit_regions(fine, unlit, ground, steps.region_px, steps.regions)
        clock.end("segment")
        if not regions:
            return none(NOTHING_THERE)

        shifts = shadow_shifts(ground, unlit, steps.shifts)
        paired = shadow_shifts(ground, unlit, steps.shifts, FINE)
        proposals = [proposal for region in regions for proposal in self._proposals(region, ground, shifts, paired)]
        clock.end("associate")
        rough = [each for each in explained(self._tried(proposals), steps.first_fit) if each]
        refined = self._promising(rough)
        for _ in range(steps.rounds):
            refined = finer(refined, steps.fine_fit)
        refined = with_their_lights(refined, rough, fine, coarse, ground, steps.region_px)
        refined = [sharpened(explanation) for explanation in refined]
        clock.end("fit")
        if not refined:
            return none(NO_SHADOW)
        best, confidence = best_of(refined)
        clock.end("judge")
        if confidence < LEAST_CONFIDENCE:
            told = likeliest(refined)
            return none(fault_of_scene(told), *_masks_of(told))
        ratios = [shadow_ratio(ground, shift) for shift in _shifts_seen(best, ground)]
        # Of two lights there is a third shift, where both are blocked.
        answers = zip(lights_of(best, confidence, tracked), ratios, strict=False)
        lights = [replace(light, shadow_rgb_ratio=ratio) for light, ratio in answers]
        if len(lights) == 1:
            lights = [replace(lights[0], angular_size_rad=_angular_size(best))]
        return LightEstimate(
            self.name,
            tracked.frame.index,
            tuple(lights),
            None,
            *_masks_of(best),
            clock.timing_ms(),
            caster=best.proxy,
            ambient_rgb_ratio=ratios[-1],
            ground_rgb=lit_rgb(ground),
        )

    def _proposals(
        self, region: Region, ground: LitGround, shifts: list[Float], paired: list[Float]
    ) -> Iterator[Proposal]:
        alone = [materials_of(region, ground, shift) for shift in shifts]
        pairs = likeliest_pairs(region, ground, paired, self._steps.pairs)
        single = {i: materials_of(region, ground, paired[i]) for i in sorted({i for pair in pairs for i in pair})}
        both = (materials_of_two(region, ground, single[i], single[j]) for i, j in pairs)
        together = [materials for materials in both if materials is not None]
        for materials in alone + together:
            for whole in splits(region, ground, materials, self._steps.shadows_per_shift):
                split = replace(whole, parts=parted(materials, whole.shadow_mask))
                if materials.lights == 2:
                    if are_two(split.parts):
                        yield Proposal(region, materials, split)
                    continue
                yield Proposal(region, materials, split)
                doubtful = doubted(split)
                if doubtful is not None:
                    yield Proposal(region, materials, doubtful)

    def _tried(self, proposals: list[Proposal]) -> list[Proposal]:
        """Those that look best and differ, of one light, and those of two."""
        alone = [proposal for proposal in proposals if proposal.materials.lights == 1]
        together = [proposal for proposal in proposals if proposal.materials.lights == 2]
        alone.sort(key=lambda one: promise(one.region, one.materials, one.split), reverse=True)
        together.sort(key=lambda one: savings(one.region, one.materials, one.split), reverse=True)
        return distinct(alone, Proposal.is_like, self._steps.tried) + together[: self._steps.pairs_tried]

    def _promising(self, explanations: list[Explanation]) -> list[Explanation]:
        """The likeliest ones that differ from each other."""
        return distinct(sorted(explanations, key=log_odds, reverse=True), are_alike, self._steps.refined)


def _masks_of(explanation: Explanation) -> tuple[Mask, Mask]:
    """(h, w) of the whole frame at the region's scale: object, shadow."""
    region, split = explanation.region, explanation.split
    return region.in_frame(split.object_mask), region.in_frame(split.shadow_mask)


def _shifts_seen(best: Explanation, ground: LitGround) -> tuple[Float, ...]:
    """The shifts that the shadows show now that they are known: voted for were also penumbrae and darkest parts."""
    if best.materials.lights == 2:
        return best.materials.shifts
    seen = shift_within(best.region.colours[shadow_core(best.region, best.predicted)], ground)
    return best.materials.shifts if seen is None else (seen,)


def _angular_size(best: Explanation) -> float | None:
    towards = best.lights[0].to_light_marker
    return angular_size(best.proxy, towards, best.materials.share, best.predicted, best.region.view)
