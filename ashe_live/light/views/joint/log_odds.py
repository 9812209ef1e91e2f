"""Log odds that an explanation is right, by what several views together say for and against it."""

import math
from collections.abc import Mapping, Sequence

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import angle_between, view_direction
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.context import Context, context_features
from ashe_live.light.explanation.judgement.evidence import of_steps_and_families
from ashe_live.light.explanation.judgement.judge import (
    GOOD_RAD,
    LEAST_PROBABILITY,
    Judge,
    best_direction,
    explanation_features,
    probabilities_of,
)
from ashe_live.light.ground.lit_ground import OFF_PLANE
from ashe_live.light.ground.regions import Region
from ashe_live.light.pixels.areas import areas_by_size, grown
from ashe_live.light.views.joint.aligned import JointExplanation
from ashe_live.light.views.plane import where_in

JUDGED = 4  # number of views whose appearance is judged: further ones only repeat what these show
PIXELS_PER_SAMPLE = 40.0  # pixels over their effective sample size: colours and errors of poses are alike over patches
# The most log odds for and against an explanation. Right labels do not prove the body right, and are found under a sky
# without a sun as well; but where labels are wrong, the explanation surely is.
MOST_FOR, MOST_AGAINST = 0.5, 3.0
# The same against labels of one view, of whose shadow it is not known how much the body hides in the other views.
MOST_AGAINST_ONE_VIEW = 1.0
LEAST_SEEN = 0.05  # weight of a view that shows nothing of body or shadow
# The most that pixels which shear count against a shadow, beside the sum over it: parts of the object that its fitted
# body lacks shear there, too.
MOST_AGAINST_SHEARING = 1.0
# Views nearer to each other than this hide much the same of the plane: what an object hides in one of them alone is a
# strip a quarter as wide as the object is high.
ASIDE_RAD = math.radians(15.0)
LEAST_OTHER_PX = 20  # of another object in a region: smaller ones are specks
BESIDE_PX = 1  # width of the rim of what a body hides, in which colours are mixed


def joint_features(explanation: JointExplanation, context: Context) -> Mapping[str, float]:
    """The features of an explanation of several views: the mean over the first JUDGED views of what each shows.

    Each view is weighted by how much of body and shadow its picture shows. Steps of light and the light's covariance
    are those of all views together. context: what else the first view shows, and what was found in any.
    """
    judged = explanation.each[:JUDGED]
    of_views = [explanation_features(each) for each in judged]
    weights = [max(share_seen(each), LEAST_SEEN) for each in judged]
    means = {name: float(np.average([each[name] for each in of_views], weights=weights)) for name in of_views[0]}
    joint = explanation.joint
    return {**means, **of_steps_and_families(joint), **context_features(joint, context)}


def joint_log_odds(explanation: JointExplanation, judge: Judge, context: Context) -> float:
    """Log odds that the explanation is right rather than none of those tried."""
    joint = explanation.joint
    shadow = joint.predicted.shadow & ~_hidden_elsewhere(explanation)
    support = joint_support(joint.region, joint.predicted.body, shadow)
    # Labels are evidence on a body only as far as its picture shows it.
    seen = float(np.mean([share_seen(each) for each in explanation.each]))
    return judge.log_odds_of(joint_features(explanation, context)) + seen * support


def no_less_sure(
    directions: Sequence[Float], log_odds: Sequence[float], alone: Sequence[Float], alone_log_odds: Sequence[float]
) -> list[float]:
    """The log odds, raised until the likeliest direction is as likely as one view alone found it.

    directions: (3,) each, unit vectors, towards the lights by which all views were explained, with their log odds.
    alone: the same of the first view. Views that confirm a direction make it no less likely. As the first view is one
    of all, the larger probability counts, and not the product of their odds (the cautious rule for evidence that is not
    distinct: Denoeux, 2008). Where the likeliest directions differ, that of all views stands.
    """
    if not log_odds or not alone_log_odds:
        return list(log_odds)
    index, share = best_direction(probabilities_of(log_odds), directions)
    first, first_share = best_direction(probabilities_of(alone_log_odds), alone)
    near = np.array(directions) @ directions[index] > math.cos(GOOD_RAD)
    if share >= first_share or alone[first] @ directions[index] < math.cos(GOOD_RAD):
        return list(log_odds)
    odds, share = np.exp(log_odds), min(first_share, 1 - LEAST_PROBABILITY)
    raised = math.log(share / (1 - share) * (1 + odds[~near].sum()) / odds[near].sum())
    return [each + raised * is_near for each, is_near in zip(log_odds, near.tolist(), strict=True)]


def share_seen(explanation: Explanation) -> float:
    """The smaller one of the body's and its shadows' fractions, by area, that lie on ground in the region's picture."""
    body, *shadows = explanation.alignment.placed.hulls_px
    ground = explanation.region.is_ground
    return min(_share_on(ground, hull) for hull in (body, *shadows))


def _share_on(ground: Mask, hull_px: Float | None) -> float:
    """The fraction of a convex hull's area (m, 2) that lies on `ground` (h, w); 0 for no hull."""
    if hull_px is None:
        return 0.0
    inside = np.zeros(ground.shape, np.uint8)
    cv2.fillConvexPoly(inside, np.round(hull_px).astype(np.int32), 1)
    area = max(cv2.contourArea(hull_px.astype(np.float32)), 1.0)
    return min(np.count_nonzero(ground & (inside > 0)) / area, 1.0)


def _hidden_elsewhere(explanation: JointExplanation) -> Mask:
    """(h, w) of the first view's region: what is hidden in the others, where these show nothing of the plane.

    It is hidden by the body and, in views from far enough aside, by whatever else stands there.
    """
    first, *others = explanation.each
    hidden = np.zeros(first.predicted.body.shape, np.bool_)
    for other in others:
        before = other.predicted.body
        if angle_between(*(view_direction(each.region.view.T_cam_marker) for each in (first, other))) > ASIDE_RAD:
            before = before | _other_objects(other)
        hidden |= where_in(grown(before, BESIDE_PX), other.region.view, first.region.view)
    return hidden


def _other_objects(explanation: Explanation) -> Mask:
    """(h, w) of the region: areas that surely stand there, and are neither the body nor mostly in its shadow's place.

    An area that mostly is in the shadow's place may be the object itself, whose dark side was taken for a shadow.
    """
    seen, on_plane = explanation.predicted, explanation.region.on_plane
    found = np.zeros(seen.body.shape, np.bool_)
    if on_plane is not None:
        for area in areas_by_size((on_plane < OFF_PLANE) & ~seen.body, LEAST_OTHER_PX):
            if np.count_nonzero(area & seen.shadow) < 0.5 * np.count_nonzero(area):
                found |= area
    return found


def plane_support(region: Region, body: Mask, shadow: Mask) -> float:
    """Log odds by which other views confirm that the shadow (h, w) lies on the plane and the body (h, w) does not.

    For labels of one view. 0 where there are no other views, or these are no evidence.
    """
    return _support(_on_plane(region, shadow), _on_plane(region, body), MOST_AGAINST_ONE_VIEW)


def joint_support(region: Region, body: Mask, shadow: Mask) -> float:
    """As `plane_support`, of an explanation by all views; shadow: without what the body hides in others.

    Pixels in the shadow's place that shear in nearly all views count by themselves: the ground around them must not
    make up for them.
    """
    shearing = max(_on_plane(region, shadow, OFF_PLANE), -MOST_AGAINST_SHEARING)
    of_shadow = min(_on_plane(region, shadow), MOST_FOR) + shearing
    return _support(of_shadow, _on_plane(region, body), MOST_AGAINST)


def _support(of_shadow: float, of_body: float, most_against: float) -> float:
    """The log odds that a shadow is on the plane, and that a body is, each within bounds, for and against.

    They are bounded separately: that the object surely stands there must not make a shadow of another standing object.
    """
    return float(np.clip(of_shadow, -most_against, MOST_FOR) + np.clip(-of_body, -most_against, MOST_FOR))


def _on_plane(region: Region, mask: Mask, below: float = math.inf) -> float:
    """Log odds by other views that the pixels of `mask` (h, w) whose own are below `below` lie on the plane."""
    if region.on_plane is None:
        return 0.0
    odds = region.on_plane[mask & region.is_ground]
    return float(odds[odds < below].sum()) / PIXELS_PER_SAMPLE
