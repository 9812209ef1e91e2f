"""The light as the mean over the families of bodies that explain all views nearly as well as the likeliest one.

From a few views, bodies of several families explain an object that is of none of them alike, with lights some degrees
apart on both sides of the truth.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from ashe_live.light.explanation.light_covariance import averaged
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.pixels.areas import shrunk
from ashe_live.light.shape.predicted import Predicted
from ashe_live.light.views.joint.aligned import JointExplanation, JointStart, explained_in_views, towards_light
from ashe_live.light.views.joint.refinement import joint_criterion, refined_by_all_tangents, sharpened_in_views

# By pixels: families less probable than this are not moved onto the steps of light, nor more than so many beside one.
LEAST_PROBABILITY, MOST_OTHERS = 0.05, 2
# The cost per pixel of the outlines is higher in the true light than in the best one, as voxels and labels are off by
# chance: by 0.25 in the median of takes. Over 1.39, the median of a chi-squared variable of two degrees of freedom.
CHANCE = 0.18


def log_likelihoods_by_pixels(costs: Sequence[float], best: Sequence[Predicted]) -> Float:
    """(n,) log likelihoods, up to a constant, of explanations whose pixels cost `costs` in all views ((31a) of
    docs/maths).

    best: what the cheapest one predicts in each view. Costs of neighbouring pixels are not independent: the sample
    size is the number of pixels on its outlines.
    """
    outline_px = sum(int(np.count_nonzero(each.whole & ~shrunk(each.whole, 1))) for each in best)
    return np.asarray(-0.5 * np.array(costs) / (CHANCE * max(outline_px, 1)))


def probabilities_by_pixels(families: Sequence[JointExplanation]) -> Float:
    """(n,) probabilities of n families, the likeliest first, by what all views' pixels and their parameters cost."""
    behind = [joint_criterion(each) - joint_criterion(families[0]) for each in families]
    weights = np.exp(log_likelihoods_by_pixels(behind, [one.predicted for one in families[0].each]))
    return np.asarray(weights / weights.sum())


def probabilities_by_steps(families: Sequence[JointExplanation]) -> Float:
    """(n,) probabilities of n families that were moved onto the steps of light, by their criteria.

    A parameter's penalty counts as a unit of twice the log likelihood, and not as the logarithm of the sample size that
    it is: what no family's model shows costs all of them more than noise does.
    """
    criteria = np.array([each.joint.criterion for each in families])
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    return np.asarray(weights / weights.sum())


def sharpened_families(
    explanation: JointExplanation, families: Sequence[JointExplanation], sharpener: Sharpener
) -> list[JointExplanation]:
    """The explanation, and by other families that its pixels leave, moved onto the steps of light; the likeliest first.

    families: the likeliest first, as some of the views were explained by; none but the explanation's own where there
    are none. sharpener: of all views at full resolution. Where the explanation's own body shows no steps, it stays as
    it is, alone.
    """
    moved = sharpened_in_views(refined_by_all_tangents(explanation), sharpener)
    if math.isinf(moved.joint.criterion) or not families:
        return [moved]
    own, costs = _family(explanation), [each.costs for each in explanation.each]
    left = [
        one
        for one, probability in zip(families, probabilities_by_pixels(families), strict=True)
        if probability > LEAST_PROBABILITY and _family(one) != own
    ]
    starts = [JointStart(explanation.origin, one.joint.lit, costs) for one in left[:MOST_OTHERS]]
    aligned = [one for one in explained_in_views(starts) if one is not None]
    others = [sharpened_in_views(refined_by_all_tangents(one), sharpener) for one in aligned]
    several = [moved, *(replace(one, joint=replace(one.joint, bodies=explanation.joint.bodies)) for one in others)]
    return sorted((one for one in several if math.isfinite(one.joint.criterion)), key=lambda one: one.joint.criterion)


def with_average_light(
    explanation: JointExplanation, families: Sequence[JointExplanation], overdispersion: float
) -> JointExplanation:
    """The explanation with its light moved to the mean of the families' lights.

    families: moved onto the steps of light, the likeliest, which is its own, first. overdispersion: the factor that
    covariances are multiplied by later, which must not multiply what families differ by. Two lights, a lamp and a
    hull's light stay as they are. Families whose lights are farther apart than GOOD_RAD are other answers, and are left
    out.
    """
    joint, light = explanation.joint, explanation.joint.lights[0]
    if len(families) < 2 or len(joint.lights) > 1 or light.is_lamp or joint.hull is not None:
        return explanation
    probabilities = probabilities_by_steps(families)
    directions = np.array([towards_light(each) for each in families])
    near = directions @ directions[0] > math.cos(GOOD_RAD)
    moved = averaged(light, directions[near], probabilities[near], 1 / overdispersion)
    return replace(explanation, joint=replace(joint, lights=(moved,)))


def _family(explanation: JointExplanation) -> str:
    return explanation.joint.lit.body.family.name
