"""The light as the mean over the families of bodies that explain all views nearly as well as the likeliest one.

From a few views, bodies of several families explain an object that is of none of them alike, with lights some degrees
apart on both sides of the truth. The mean of a posterior has the least expected squared error, and what its members
differ by is part of its uncertainty (Hoeting et al., "Bayesian model averaging", 1999).
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised, tangent_basis
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from ashe_live.light.shape.layout import nearness_of
from ashe_live.light.views.by_pixels import log_likelihoods_by_pixels
from ashe_live.light.views.joint import JointExplanation, towards_light
from ashe_live.light.views.joint_refinement import joint_criterion


def family_probabilities(families: Sequence[JointExplanation]) -> Float:
    """(n,) of n families, the likeliest first, by what all views' pixels and their parameters cost."""
    behind = [joint_criterion(each) - joint_criterion(families[0]) for each in families]
    weights = np.exp(log_likelihoods_by_pixels(behind, [one.predicted for one in families[0].each]))
    return np.asarray(weights / weights.sum())


def with_average_light(
    explanation: JointExplanation, families: Sequence[JointExplanation], overdispersion: float
) -> JointExplanation:
    """The explanation with its light moved by as much as the mean of the families' lights is from its own family's.

    families: the likeliest first, which is its own, before it was moved onto steps of light. overdispersion: the factor
    that covariances are multiplied by later, which must not multiply what families differ by. Two lights, a lamp and a
    hull's light stay as they are. Families whose lights are farther apart than GOOD_RAD are other answers, and are left
    out.
    """
    joint, light = explanation.joint, explanation.joint.lights[0]
    if not families or len(joint.lights) > 1 or nearness_of(light.light) or joint.hull is not None:
        return explanation
    probabilities = family_probabilities(families)
    directions = np.array([towards_light(each) for each in families])
    near = directions @ directions[0] > math.cos(GOOD_RAD)
    if light.to_light_marker @ directions[0] < math.cos(GOOD_RAD):
        return explanation  # a start that alignment has turned into another answer; it has no families
    weights = probabilities[near] / probabilities[near].sum()
    offsets = (directions[near] - directions[0]) @ tangent_basis(directions[0]).T  # (n, 2), rad
    mean = weights @ offsets
    spread = np.einsum("n,ni,nj->ij", weights, offsets - mean, offsets - mean)
    towards = normalised(light.to_light_marker + mean @ tangent_basis(light.to_light_marker))
    moved = replace(
        light,
        light=np.append(towards, light.light[3]),
        covariance_rad2=light.covariance_rad2 + spread / overdispersion,
    )
    return replace(explanation, joint=replace(joint, lights=(moved,)))
