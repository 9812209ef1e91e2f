"""One body and its lights, aligned with the borders in several views at once.

The normal equations of the views add up, as their borders are measured independently; what a body's model cannot show
is an error that they share (docs/maths, "Several views").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between, project
from ashe_live.light.explanation.alignment import EARLY_LOSS_FACTOR, SEARCH_RANGES, Alignment, measured
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from ashe_live.light.explanation.light_covariance import lights_of
from ashe_live.light.explanation.normal_equations import (
    NormalEquations,
    PlacedBody,
    added_up,
    cost_of_moves,
    normal_equations,
    placed_in,
    pose_equations,
    with_pose_moved,
)
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.outline_fit.search import damped_steps
from ashe_live.light.shape.batches import for_alike, for_groups
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.sight import Sight

# Correlation between views of a border's errors: the ground's texture along it, the body's model and the systematic
# errors of poses are the same in all of them.
SHARED = 0.3
RANGES = SEARCH_RANGES[1:]  # a body that was aligned in one view is nearly right in the others


@dataclass(frozen=True, slots=True, eq=False)
class JointExplanation:
    """An explanation of several views by one body and its lights."""

    joint: Explanation  # in the first view, with the misfit, the clarity and the information of all
    each: tuple[Explanation, ...]  # in each view, the first one included
    origin: Explanation  # of one view, with the labels from which it began


@dataclass(frozen=True, slots=True, eq=False)
class JointStart:
    """A body with its lights, to be aligned in several views."""

    origin: Explanation  # of one view, whose labels they were found from
    lit: LitBody
    costs: Sequence[Costs]  # of the pixels around it in each view, the first one first


def towards_light(explanation: JointExplanation) -> Float:
    """(3,) unit vector, marker frame, towards the light, or the first of two."""
    return explanation.joint.lights[0].to_light_marker


def costs_of_views(explanation: Explanation) -> list[Costs]:
    """What the pixels cost in each view that an explanation was aligned in, the first one first."""
    return [one.costs for one in (explanation.alignment.placed, *explanation.alignment.elsewhere)]


def explained_in_views(several: Sequence[JointStart]) -> list[JointExplanation | None]:
    """Each body aligned with the borders in all its views; None where it is not in the first view."""
    moved = for_alike(_aligned, several, lambda start: len(start.lit.lights))
    return [explained_where_it_stands(start) for start in moved]


def in_each_view(joint: Explanation) -> JointExplanation:
    """An explanation of several views, with what it is in each of them."""
    found = explained_where_it_stands(JointStart(joint, joint.lit, costs_of_views(joint)))
    assert found is not None  # as it was aligned where it stands
    return replace(found, joint=joint)


def turned_from(several: Sequence[JointStart], found: Sequence[JointExplanation | None]) -> list[JointExplanation]:
    """The starts that alignment has turned into another answer, or lost, judged where they stand.

    found: of each start, what it was aligned to. Where a shadow is a sliver, views that show little of it may pull it
    onto what is more clearly dark.
    """
    turned = []
    for start, one in zip(several, found, strict=True):
        if one is None or _apart_rad(start.lit, one.joint.lit) > GOOD_RAD:
            turned.append(explained_where_it_stands(start))
    return [each for each in turned if each is not None]


def explained_where_it_stands(start: JointStart) -> JointExplanation | None:
    """The explanation of a start that is not moved; None where it is not in the first view."""
    placed = placed_in([(start.lit, _sight(start.lit, costs), costs) for costs in start.costs])
    if not placed[0].is_in_view:
        return None
    alignments = measured([one for one in placed if one.is_in_view])
    joint = _together(alignments)
    lights = lights_of(joint)
    each = []
    for alignment in (joint, *alignments):
        seen, costs = alignment.placed.predicted, alignment.placed.costs
        ground = costs.region.is_ground
        split = Split(seen.body & ground, seen.shadow & ground, None, seen.parts)
        each.append(Explanation(costs.region, costs.materials, split, alignment, lights, costs.as_object))
    # How much the light depends on the family is known from one view, until all views have chosen it.
    together = replace(each[0], bodies=start.origin.bodies)
    return JointExplanation(together, tuple(each[1:]), start.origin)


def pixels_cost(placed: Sequence[PlacedBody]) -> float:
    """The unary costs of all views' pixels."""
    return sum(one.cost for one in placed)


def views_cost(placed: Sequence[PlacedBody]) -> float:
    """The unary costs of all views' pixels, and those of how far the views' poses have been moved."""
    return pixels_cost(placed) + cost_of_moves(placed)


def views_per_sample(count: int) -> float:
    """The number of views over their effective sample size, as they share errors."""
    return 1 + SHARED * (count - 1)


def _aligned(several: Sequence[JointStart]) -> list[JointStart]:
    """The cheapest state of each body and its views along Gauss-Newton steps of their normal equations, added up."""
    here = _placed(several)
    best, least = list(here), [views_cost(placed) for placed in here]
    for number, share in enumerate(RANGES):
        flat = [one for placed in here for one in placed if one.is_in_view]
        if not flat:
            break
        loss_factor = 1.0 if number == len(RANGES) - 1 else EARLY_LOSS_FACTOR
        equations = normal_equations(flat, share, loss_factor)
        at, moved = 0, []
        for placed, start in zip(here, several, strict=True):
            end = at + sum(one.is_in_view for one in placed)
            moved.append(_stepped(start, placed, equations, range(at, end)))
            at = end
        here = _placed(moved)
        for i, placed in enumerate(here):
            if (cost := views_cost(placed)) < least[i]:
                best[i], least[i] = placed, cost
    return [
        replace(start, lit=placed[0].lit, costs=[one.costs for one in placed])
        for start, placed in zip(several, best, strict=True)
    ]


def _stepped(start: JointStart, placed: Sequence[PlacedBody], equations: NormalEquations, own: range) -> JointStart:
    """The start after one step of its body, and of the poses of the views that show it: `own` ones of `equations`."""
    lit, costs = placed[0].lit, [one.costs for one in placed]
    if not own:
        return replace(start, lit=lit, costs=costs)
    normal = added_up(equations.normal[own.start : own.stop], lit.body.family, lit.layout)
    gradient = equations.gradient[own.start : own.stop].sum(axis=0)
    in_view = [i for i, one in enumerate(placed) if one.is_in_view]
    poses = [(i, pose_equations(placed[i], equations, number)) for i, number in zip(in_view, own, strict=True)]
    for _, pose in poses:
        if pose is not None:
            normal, gradient = pose.marginalised(normal, gradient)
    step = damped_steps(normal[None], gradient[None])[0]
    for i, pose in poses:
        if pose is not None:
            costs[i] = with_pose_moved(costs[i], pose.step(step))
    return replace(start, lit=lit.moved(step), costs=costs)


def _placed(several: Sequence[JointStart]) -> list[list[PlacedBody]]:
    return for_groups(placed_in, [[(one.lit, _sight(one.lit, costs), costs) for costs in one.costs] for one in several])


def _sight(lit: LitBody, costs: Costs) -> Sight:
    """The sight of a view, its pixels counted from the body frame's origin."""
    view = costs.region.view
    origin_px = project(view.camera, view.T_cam_marker, np.array([[*lit.body.frame.origin_marker, 0.0]]))[0]
    return Sight(view.camera, view.T_cam_marker, origin_px if np.isfinite(origin_px).all() else np.zeros(2))


def _apart_rad(one: LitBody, other: LitBody) -> float:
    """The largest angle between a light of one and the same light of the other."""
    pairs = zip(one.to_lights_marker, other.to_lights_marker, strict=True)
    return max(angle_between(a, b) for a, b in pairs)


def _together(alignments: Sequence[Alignment]) -> Alignment:
    """The first alignment with the information of all, and with their mean misfit and clarity.

    Misfits are relative to the object's size in each view.
    """
    first = alignments[0]
    relative = [(one.misfit_px / one.placed.object_px) ** 2 for one in alignments]
    lit = first.placed.lit
    normal = added_up(np.array([one.normal for one in alignments]), lit.body.family, lit.layout)
    return replace(
        first,
        normal=normal / views_per_sample(len(alignments)),
        misfit_px=math.sqrt(float(np.mean(relative))) * first.placed.object_px,
        clear_body=float(np.mean([one.clear_body for one in alignments])),
        clear_shadow=float(np.mean([one.clear_shadow for one in alignments])),
        clear_shadows=tuple(np.mean([one.clear_shadows for one in alignments], axis=0).tolist()),
        ends_in_view=tuple(np.max([one.ends_in_view for one in alignments], axis=0).tolist()),
        elsewhere=tuple(one.placed for one in alignments[1:]),
    )
