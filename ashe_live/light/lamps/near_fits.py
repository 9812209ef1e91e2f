"""Explanations fitted again with their first light near, in all of their views."""

from dataclasses import replace

from ashe_live.light.explanation.explain import NearFit
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.lamps.sources import WHOLE_ERROR_SHARE
from ashe_live.light.shape.body import NearnessPrior
from ashe_live.light.views.joint.aligned import JointStart, costs_of_views, explained_in_views
from ashe_live.light.views.joint.refinement import joint_criterion, sharpened_in_views


def nearness_prior(by_fall: float) -> NearnessPrior:
    """What is known of a lamp's nearness, which is that by the fall of light (1/m), before outlines are seen."""
    return NearnessPrior(by_fall, WHOLE_ERROR_SHARE * by_fall)


def fitted_near(explanation: Explanation, nearness: float, fit: NearFit, sharpener: Sharpener) -> Explanation | None:
    """The explanation fitted again in all of its views with its first light at a nearness w / z (1/m).

    Steps of light move the nearness of a lamp, if that is the only light. None where the object or a shadow is then not
    in view. fit: of one view. sharpener: of all views, that of the answer first.
    """
    (again,) = fit([(explanation, nearness)])
    near = nearness_prior(nearness) if nearness > 0 and len(explanation.lights) == 1 else None
    return in_all_views(explanation, again, nearness, near, sharpener)


def in_all_views(
    explanation: Explanation,
    again: Explanation | None,
    nearness: float,
    near: NearnessPrior | None,
    sharpener: Sharpener,
) -> Explanation | None:
    """What was fitted `again` in one view at a nearness, moved onto the steps of light in all views of the explanation.

    near: of the nearness as the steps move it, None where it is held. Where there are several views, the body that
    explains all of them is tried as well, and need not be fitted again.
    """
    if not explanation.alignment.elsewhere:
        return None if again is None else Sharpener(sharpener.pictures[:1]).sharpened([again], near)[0]
    costs = costs_of_views(explanation)
    starts = [JointStart(explanation, explanation.lit.with_first_light_near(nearness), costs)]
    if again is not None:
        starts.append(JointStart(again, again.lit, costs))
    found = [each for each in explained_in_views(starts) if each is not None]
    if not found:
        return None
    best = min(found, key=joint_criterion)
    best = replace(best, joint=replace(best.joint, split=explanation.split))
    return sharpened_in_views(best, sharpener, near).joint
