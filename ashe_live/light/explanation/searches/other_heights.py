"""Bodies of another height that cast the same shadow, tried where the steps of light show that a body's top is wrong.

An object's lit top may have its ground's colours, so that the labels lack it: a black tin with a pale lid. Then the
fitted body is too low, and so is its light. Stretched together with its light, a body casts the same shadow, and only
its outline above moves; from there it is moved onto the steps of light once more.
"""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ashe_live.light.edges.step_alignment import EdgeFit, aligned_with_steps
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener, shifts_of
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import object_cost
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.shape.predicted import predicted_of

# That are tried, over the fitted one: alignment reaches from each about half way to the next.
HEIGHTS = (0.75, 1.3, 1.6)
# Mean squared distance of an outline from the steps of light, in sigmas, of a right one; and how many times as far from
# them as its shadow's a body's must be for its height to be doubted.
ONE_SIGMA, FARTHER = 1.0, 2.0


def with_other_heights(
    sharp: Sequence[Explanation],
    sharpener: Sharpener,
    preset: FitPreset,
    refine: Callable[[Sequence[Explanation]], list[Explanation]],
    log_odds: Callable[[Explanation], float],
) -> list[Explanation]:
    """The explanations, each replaced by that of another height which is likelier, if the steps of light ask for one.

    sharp: aligned with these steps. preset, refine: fit a body to the new labels, and move it onto the steps again.
    log_odds: by which explanations are judged.
    """
    found = dict(_of_other_heights(sharp, sharpener, preset))
    better = zip(found, refine(list(found.values())), strict=True) if found else ()
    kept = list(sharp)
    for i, new in better:
        if new.steps.show_shadow and log_odds(new) > log_odds(kept[i]):
            kept[i] = new
    return kept


def _of_other_heights(
    sharp: Sequence[Explanation], sharpener: Sharpener, preset: FitPreset
) -> Iterator[tuple[int, Explanation]]:
    """The explanations by another height that lie on the steps better, with the numbers of those they came from."""
    for number, one in enumerate(sharp):
        # A wrong top does not show in the shadow.
        if len(one.lights) == 1 and one.steps.body > max(FARTHER * one.steps.shadow, ONE_SIGMA):
            fit = _better_fit(one, sharpener)
            new = None if fit is None else _relearned(one, fit, preset)
            if new is not None:
                yield number, new


def _better_fit(one: Explanation, sharpener: Sharpener) -> EdgeFit | None:
    """The stretched body that lies best on the steps of light; None where none does better than by chance."""
    lit = one.lit
    bodies = [lit, *(each for each in map(lit.stretched, HEIGHTS) if each is not None)]
    if len(bodies) == 1:  # a ball, or a known caster
        return None
    own, *others = aligned_with_steps(bodies, sharpener.pictures, np.array([shifts_of(one)] * len(bodies)))
    best = min((fit for fit in others if fit is not None), key=lambda fit: fit.criterion, default=None)
    if own is None or best is None or best.criterion > own.criterion - math.log(len(bodies)):
        return None
    return best


def _relearned(one: Explanation, fit: EdgeFit, preset: FitPreset) -> Explanation | None:
    """The explanation by the labels that the fit predicts, with the object's colours as they are there."""
    region = one.region
    seen = predicted_of(fit.lit, region.view)
    split = Split(seen.body, seen.shadow)
    if not split.is_large_enough:
        return None
    as_object = object_cost(region, seen.body & region.is_ground)
    (new,) = explained([Proposal(region, one.materials, split, fit.lit.lights, as_object)], preset)
    return new
