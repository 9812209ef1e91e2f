"""The answer: the likeliest direction of what a picture's looks found, and all that is stated of its lights."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ashe_live.core.arrays import Float, distinct
from ashe_live.core.light import Illumination
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.looking import Look
from ashe_live.light.estimators.preset import FIRST_FIT, ProxyPreset
from ashe_live.light.estimators.proposals import proposals_of
from ashe_live.light.estimators.view_search import Trace
from ashe_live.light.explanation.explain import Proposal, explained, explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.evidence import shadow_core
from ashe_live.light.explanation.judgement.judge import LEAST_PROBABILITY, Judge, likeliest_direction, recalibrated
from ashe_live.light.explanation.light_covariance import averaged
from ashe_live.light.explanation.penumbra import size_of
from ashe_live.light.ground.glint import glint_in
from ashe_live.light.ground.lit_ground import LitGround, lit_rgb
from ashe_live.light.ground.shadow_shift import shadow_ratio, shift_of_known_shadow
from ashe_live.light.lamps.kinds import AUTO, SUN
from ashe_live.light.lamps.lamp import PictureContext, stated

OTHERS_TRIED = 4  # number of splits of other regions that are fitted once one object's light is known


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """The explanation that all looks together make likeliest."""

    look: Look  # that found it
    explanation: Explanation
    confidence: float
    # All explanations with its direction, their probabilities beside them; itself first.
    alike: Sequence[tuple[Explanation, float]]


def chosen(looks: Sequence[Look], judge: Judge) -> Choice | None:
    """The likeliest explanation of the likeliest direction by the average of the looks; None where none was found."""
    average = judge.average(len(looks))
    several = [
        (look, each, weight * probability)
        for look, weight in zip(looks, average.weights, strict=True)
        for each, probability in zip(look.trace.judged, look.trace.probabilities, strict=True)
    ]
    if not several:
        return None
    probabilities = np.array([probability for *_, probability in several])
    directions, counts = zip(*((each.to_light_from_body, len(each.lights)) for _, each, _ in several), strict=True)
    group, share = likeliest_direction(probabilities, directions, counts)
    likeliest = sorted((several[i] for i in np.flatnonzero(group)), key=lambda each: each[2], reverse=True)
    look, best, _ = likeliest[0]
    confidence = recalibrated(share, average) * judge.probability_if_right(best)
    return Choice(look, best, confidence, [(each, probability) for _, each, probability in likeliest])


def illumination_of(
    choice: Choice, tracked: TrackedFrame, judge: Judge, preset: ProxyPreset
) -> tuple[Illumination, Explanation]:
    """What the choice says of the light in `tracked`, and its explanation by the lights as they are stated.

    A sun's explanation and a lamp's differ, as a lamp's body is aligned anew.
    """
    look, best = choice.look, choice.explanation
    trace, ground = look.trace, look.views[0].ground
    ratios = [shadow_ratio(ground, shift) for shift in _shifts_seen(best, ground)]
    scene = PictureContext(
        tracked=tracked,
        view=trace.view,
        ground=ground,
        unlit=look.unlit,
        fine_views=[view.fine for view in look.views],
        judged=_judged_beside(best, trace),
        find_others=partial(_other_objects, choice, judge),
        fit=partial(explained_near, preset=preset.fine_fit),
        glints=[glint for view in look.views if (glint := glint_in(view.coarse, view.ground)) is not None],
        judge=judge,
    )
    # A hull's shadow was compared with the whole plane: no body's border is left by which a lamp differs from a sun.
    kind = SUN if best.hull is not None and preset.light == AUTO else preset.light
    answer = stated(_with_mean_light(choice), choice.confidence, ratios[: len(best.lights)], scene, kind)
    # With two lights there is a third shift, that where both are blocked.
    pairs = zip(answer.lights, ratios, strict=False)
    lights = [replace(light, shadow_rgb_ratio=ratio) for light, ratio in pairs]
    if len(lights) == 1:
        lights = [lights[0].with_angular_size(size_of(answer.explanation, lights[0], tracked))]
    real_object = answer.explanation.real_object
    illumination = Illumination(
        tuple(lights), ambient_rgb_ratio=ratios[-1], ground_rgb=lit_rgb(ground), real_object=real_object
    )
    return illumination, answer.explanation


def _with_mean_light(choice: Choice) -> Explanation:
    """The explanation with its light moved to the mean of all suns that explain a single picture by its direction.

    Two lights, a lamp, a hull's light, and that of several views, which is a mean of its families, stay as they are.
    """
    best = choice.explanation
    if len(choice.look.views) > 1 or len(best.lights) > 1 or best.lights[0].is_lamp or best.hull is not None:
        return best
    suns = [(each, probability) for each, probability in choice.alike if not each.lights[0].is_lamp]
    directions, probabilities = zip(*((each.lights[0].to_light_marker, one) for each, one in suns), strict=True)
    return replace(best, lights=(averaged(best.lights[0], np.array(directions), np.array(probabilities)),))


def _judged_beside(best: Explanation, trace: Trace) -> list[tuple[Explanation, float]]:
    """The other explanations that a look has judged, with their log odds against none of them being right."""
    none = max(1 - sum(trace.probabilities), LEAST_PROBABILITY)
    pairs = zip(trace.judged, trace.probabilities, strict=True)
    return [(each, math.log(max(one, LEAST_PROBABILITY) / none)) for each, one in pairs if each is not best]


def _other_objects(choice: Choice, judge: Judge) -> list[tuple[Explanation, float]]:
    """Explanations of other objects than the chosen one, with their log odds: those found before, and new ones.

    Once an object and its light are known, so is the colour that shadows have everywhere in the picture.
    """
    best, trace, ground = choice.explanation, choice.look.trace, choice.look.views[0].ground
    shift = np.asarray(best.materials.shift)
    proposals = [
        proposal
        for region in trace.regions
        if region.window != best.region.window
        for proposal in proposals_of(region, ground, [shift], [])
        if proposal.split.undecided is None
    ]
    proposals.sort(key=lambda each: judge.split_score(each.region, each.materials, each.split), reverse=True)
    new = [
        each for each in explained(distinct(proposals, Proposal.is_like, OTHERS_TRIED), FIRST_FIT) if each is not None
    ]
    others = [each for each in trace.judged if each is not best]
    return [(each, judge.log_odds(each)) for each in [*others, *new] if len(each.lights) == 1]


def _shifts_seen(best: Explanation, ground: LitGround) -> tuple[Float, ...]:
    """The shifts measured inside the final shadow, as the vote also counted penumbrae and contact shadows.

    Of two lights, the shifts of the vote.
    """
    if best.materials.lights == 2:
        return best.materials.shifts
    colours = best.region.colours[shadow_core(best.region, best.predicted)]
    return (shift_of_known_shadow(colours, ground, best.materials.shift),)
