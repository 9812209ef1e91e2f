"""The explanations that are judged: the likeliest refined and moved onto the steps of light, the others as they are."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from ashe_live.core.arrays import without
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.explanation.explain import are_alike, different, explained_near, refined, refined_by_tangents
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, is_settled
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.searches.first_shadow import with_shadows_searched
from ashe_live.light.explanation.searches.other_heights import with_other_heights
from ashe_live.light.explanation.searches.second_light import is_part_of, with_lights_counted
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.lamps.hypotheses import LampHypotheses

# The log odds of an explanation to be right.
LogOdds = Callable[[Explanation], float]


@dataclass(frozen=True, slots=True, eq=False)
class Refiner:
    """Refines explanations of one view."""

    view: SceneView
    sharpener: Sharpener  # of the view at full resolution
    preset: ProxyPreset
    lamps: LampHypotheses  # that the view's ground suggests

    def refined_and_others(self, rough: Sequence[Explanation], log_odds: LogOdds) -> list[Explanation]:
        """The likeliest different explanations, refined, with lights counted and lamps decided; then the others.

        The others are judged as well, as they are what else the picture may show. Where all of them leave doubt,
        shadows are searched for by the objects' shapes.
        """
        sharp, others = self._refined_apart(rough, log_odds)
        judged = [*sharp, *others]
        if leaves_no_doubt(judged, log_odds) and not _is_by_a_doubtful_light(judged, rough, log_odds):
            return judged
        return self._with_shadows_searched(judged, [each for each in sharp if len(each.lights) > 1], log_odds)

    def _refined_apart(
        self, rough: Sequence[Explanation], log_odds: LogOdds
    ) -> tuple[list[Explanation], list[Explanation]]:
        """The likeliest, refined; and the other rough ones, with those that refinement could not fit or has turned into
        another answer.
        """
        ranked = sorted(rough, key=log_odds, reverse=True)
        chosen = different(ranked, self.preset.refined)
        fines = [None if one is None else refined_by_tangents(one) for one in refined(chosen, self.preset.fine_fit)]
        turned = [one for one, fine in zip(chosen, fines, strict=True) if fine is None or _differ(one, fine)]
        # They are compared with the rough ones by their steps of light, among others, which must be measured alike.
        measured = self.sharpener.measured([fine for fine in fines if fine is not None])
        found = with_lights_counted(measured, rough, self.view, self.preset.region_px, log_odds)
        others = different(without(ranked, chosen))
        others = turned + [each for each in others if not any(are_alike(each, one) for one in [*chosen, *found])]
        others = [each for each in others if not any(is_part_of(one, each) for one in found)]
        sharp = self._sharp_and_decided(found)
        return with_other_heights(sharp, self.sharpener, self.preset.fine_fit, self.refined_alone, log_odds), others

    def _with_shadows_searched(
        self, judged: Sequence[Explanation], by_two: Sequence[Explanation], log_odds: LogOdds
    ) -> list[Explanation]:
        """The explanations with shadows searched for by the objects' shapes, which may have a second light as well.

        by_two: those of `judged` that are by two lights.
        """
        view, region_px = self.view, self.preset.region_px
        searched = with_shadows_searched(judged, view, region_px, self.refined_alone, log_odds)
        new = without(searched, judged)
        likeliest = max(searched, key=log_odds, default=None)
        # Also what takes the place of one of two lights, of which the second may be the artefact of a worse body.
        tried = [each for each in new if each is likeliest or any(is_part_of(both, each) for both in by_two)]
        counted = [with_lights_counted([one], [], view, region_px, log_odds) for one in tried]
        several = [each for found_of_one in counted for each in found_of_one if len(each.lights) > 1]
        both = self._sharp_and_decided(several)
        return [*both, *(each for each in searched if not any(is_part_of(one, each) for one in both))]

    def refined_alone(self, several: Sequence[Explanation]) -> list[Explanation]:
        """Each explanation relabelled, fitted anew and moved onto the steps of light, as a sun's or a lamp's."""
        fits = zip(several, refined(several, self.preset.fine_fit), strict=True)
        return self._sharp_and_decided([one if fine is None else refined_by_tangents(fine) for one, fine in fits])

    def _sharp_and_decided(self, several: Sequence[Explanation]) -> list[Explanation]:
        near_fit = partial(explained_near, preset=self.preset.fine_fit)
        sharpened = self.sharpener.sharpened(several)
        return [self.lamps.decided(each, near_fit, self.sharpener) for each in sharpened]


def leaves_no_doubt(judged: Sequence[Explanation], log_odds: LogOdds) -> bool:
    """Whether the explanations make one direction so likely that nothing more is looked for."""
    return is_settled(list(map(log_odds, judged)), [each.lights[0].to_light_marker for each in judged])


def _is_by_a_doubtful_light(judged: Sequence[Explanation], rough: Sequence[Explanation], log_odds: LogOdds) -> bool:
    """Whether the likeliest has two lights, and those that were found before the second one left doubt.

    The second one's shadow then makes the pair likely, but may be the only shadow, and what was taken for the first
    one's a dark part of the object.
    """
    return len(max(judged, key=log_odds).lights) > 1 and not leaves_no_doubt(rough, log_odds)


def _differ(one: Explanation, other: Explanation) -> bool:
    """Whether the answers by two explanations could not both be good."""
    return angle_between(one.lights[0].to_light_marker, other.lights[0].to_light_marker) > GOOD_RAD
