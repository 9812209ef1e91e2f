"""A joint explanation made sharper in all views: its family, its light by tangents, then all by the steps of light."""

from collections.abc import Sequence
from dataclasses import replace

from ashe_live.light.explanation.alignment import COST_PER_PARAMETER, criterion
from ashe_live.light.explanation.explain import refined_by_tangents, refitted_bodies
from ashe_live.light.explanation.explanation import LIKELY_FAMILIES
from ashe_live.light.explanation.sharpen import Sharpener, lights_by_steps
from ashe_live.light.labels.relabel import relabelled
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.shape.body import NearnessPrior
from ashe_live.light.views.joint.aligned import (
    JointExplanation,
    JointStart,
    explained_in_views,
    explained_where_it_stands,
    pixels_cost,
    views_cost,
    views_per_sample,
)


def by_families(explanation: JointExplanation, preset: FitPreset) -> list[JointExplanation]:
    """The explanation with the body of each family that may explain all views, the likeliest first.

    Several families may fit one view's labels equally well.
    """
    costs = [each.costs for each in explanation.each]
    own = explanation.joint.lit.body.family.name
    bodies = [lit for lit in refitted_bodies(explanation.origin, preset) if lit.body.family.name != own]
    others = explained_in_views([JointStart(explanation.origin, lit, costs) for lit in bodies[:LIKELY_FAMILIES]])
    several = sorted([explanation, *(each for each in others if each is not None)], key=joint_criterion)
    lits = tuple(each.joint.lit for each in several)
    return [replace(each, joint=replace(each.joint, bodies=lits)) for each in several]


def refined_by_all_tangents(explanation: JointExplanation) -> JointExplanation:
    """The explanation with its light refined by the common tangents in each view in turn, which hold for any body.

    One view's tangents leave the light free within a plane through the camera; planes of different views intersect. The
    first view's pixels are labelled anew.
    """
    lights, splits = explanation.joint.lights, []
    for each in explanation.each:
        split = relabelled(each.region, each.materials, each.as_object, each.predicted)
        splits.append(split)
        if split.is_large_enough:
            lights = refined_by_tangents(replace(each, split=split, lights=lights)).lights
    return replace(explanation, joint=replace(explanation.joint, split=splits[0], lights=lights))


def with_steps(several: Sequence[JointExplanation], sharpener: Sharpener) -> list[JointExplanation]:
    """The explanations where they stand, each with its costs by the steps of light in all views."""
    return [replace(each, joint=_of_views(sharpener, each).measured([each.joint])[0]) for each in several]


def sharpened_in_views(
    explanation: JointExplanation, sharpener: Sharpener, near: NearnessPrior | None = None
) -> JointExplanation:
    """The explanation moved onto the steps of light in all views; as it is where they show none.

    sharpener: of all views at full resolution, that of the answer first. near: of its only light's nearness, where that
    is not held.
    """
    sharpener = _of_views(sharpener, explanation)
    best = sharpener.best_fit(explanation.joint, near)
    if best is None:
        return explanation
    seen = [each.costs for each in explanation.each]
    costs = [each.with_pose(each.region.view.seen_from(best.views).T_cam_marker) for each in seen]
    moved = explained_where_it_stands(JointStart(explanation.origin, best.lit, costs))
    if moved is None:
        return explanation
    as_one, before = views_per_sample(len(sharpener.pictures)), explanation.joint
    by_pixels = pixels_cost([each.alignment.placed for each in moved.each])
    joint = replace(
        moved.joint,
        split=before.split,
        lights=lights_by_steps(best, moved.joint.alignment, as_one),
        steps=best.mean_costs,
        bodies=before.bodies,
        criterion=(best.criterion + by_pixels / COST_PER_PARAMETER) / as_one,
        nearness=None if best.nearness is None else best.nearness.over(as_one),
    )
    return replace(moved, joint=joint)


def joint_criterion(explanation: JointExplanation) -> float:
    """As `alignment.criterion`, over all views: their unary costs, and one penalty per shape parameter."""
    placed = [each.alignment.placed for each in explanation.each]
    return criterion(placed[0]) + views_cost(placed) - placed[0].cost


def _of_views(sharpener: Sharpener, explanation: JointExplanation) -> Sharpener:
    """With the poses that the views were moved to along with the explanation's body."""
    return sharpener.seen_from([each.region.view for each in explanation.each])
