"""Explanations of several views that repeat another one: of the same body in the same light, or of the same pixels."""

import math
from collections.abc import Sequence
from operator import itemgetter

import numpy as np

from ashe_live.core.arrays import Mask, distinct
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from ashe_live.light.shape.predicted import predicted_of
from ashe_live.light.views.joint.aligned import JointExplanation, towards_light

# Of the pixels that either of two explanations takes for the object, those that both do; of shadows too.
SAME_SHARE = 0.5
ALIKE_SHARE = 0.3  # of a body's size: the most distance between the feet of two bodies that count as alike
ALIKE_RAD = math.radians(2.0)  # the largest angle between their lights


def distinct_explanations(several: Sequence[JointExplanation]) -> list[JointExplanation]:
    """The explanations in order, without those whose body and lights are like an earlier one's."""
    return distinct(several, lambda one, other: one.joint.is_like(other.joint, ALIKE_SHARE, ALIKE_RAD))


def show_the_same(one: JointExplanation, other: JointExplanation) -> bool:
    """Whether the bodies and their shadows, in the first view's picture around `one`, are mostly the same pixels."""
    region = one.joint.region
    pairs = zip(_silhouettes(one), _silhouettes(other, one), strict=True)
    return all(_shared(a & region.is_ground, b & region.is_ground) > SAME_SHARE for a, b in pairs)


def counted_once(several: Sequence[tuple[JointExplanation, float]]) -> list[tuple[JointExplanation, float]]:
    """Explanations with their log odds, the likeliest first, without those that repeat a likelier one.

    From several labels, of any view, alignment comes to much the same body with much the same light. To be found more
    than once makes an answer no likelier: the evidence for it is in the same pixels.
    """

    def is_repeated(each: tuple[JointExplanation, float], likelier: tuple[JointExplanation, float]) -> bool:
        are_near = towards_light(likelier[0]) @ towards_light(each[0]) > math.cos(GOOD_RAD)
        return bool(are_near) and show_the_same(likelier[0], each[0])

    return distinct(sorted(several, key=itemgetter(1), reverse=True), is_repeated)


def _silhouettes(explanation: JointExplanation, where: JointExplanation | None = None) -> tuple[Mask, Mask]:
    """(h, w) each: body and shadow in the region of the explanation, or of another one."""
    joint = explanation.joint
    if where is None and joint.hull is not None:
        return joint.split.object_mask, joint.split.shadow_mask
    seen = joint.predicted
    if where is not None:
        seen = predicted_of(joint.lit, where.joint.region.view)
    return seen.body, seen.shadow


def _shared(one: Mask, other: Mask) -> float:
    """The intersection of two masks over their union; 0 for none."""
    return int(np.count_nonzero(one & other)) / max(int(np.count_nonzero(one | other)), 1)
