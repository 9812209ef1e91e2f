"""Makes explanations: from a split of a region's pixels into object and shadow to a body and lights that fit it.

An explanation is a hypothesis of what a region shows: a body, its lights, and the labels that follow from both.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, distinct
from ashe_live.light.explanation.alignment import Alignment, Start, aligned, criterion
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.light_covariance import lights_of, relative_misfit
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import Materials, object_cost
from ashe_live.light.labels.relabel import relabelled
from ashe_live.light.labels.two_lights import are_two_shadows
from ashe_live.light.outline_fit.fit import Masks, fit_bodies
from ashe_live.light.outline_fit.preset import FitPreset
from ashe_live.light.outline_fit.tangents import lights_refined_by_tangents
from ashe_live.light.shape.batches import for_known
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.directions import fitted_lights, information_on_displacement
from ashe_live.light.shape.layout import nearness_of
from ashe_live.light.shape.outlines.silhouettes import observe_outlines
from ashe_live.light.shape.predicted import predicted_of
from ashe_live.light.shape.sight import Sight

DIRECTIONS = 16  # in which outlines are observed when only their tangents are needed
LOWEST_Z = 0.03  # of a unit vector towards a light, for it to be a fit's start: lower lights' shadows are too long
FEW_PX = 20  # a silhouette of no more pixels does not show an object's colours
END_IN_VIEW = 0.5  # fraction of a shadow's far end that must be in the picture for its length to be known
# Fraction of its pixels in which an explanation must differ from a likelier one for it to be refined too.
DIFFERING_SHARE = 0.04
# Explanations of two regions are of one object in one light within this angle, and this fraction of its size.
ONE_OBJECT_RAD, ONE_OBJECT_SHARE = math.radians(3), 0.2


# Fits explanations anew, each with its first light held at a nearness: `explained_near` with some preset.
NearFit = Callable[[Sequence[tuple["Explanation", float]]], list["Explanation | None"]]


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """A hypothesis before its fit: a region divided into an object and its shadow."""

    region: Region
    materials: Materials
    split: Split
    start: Float | None = None  # (l, 4) lights, marker frame, as a further start of the fit
    as_object: Float32 | None = None  # (h, w) unary cost of the object, if an earlier fit has learned its colours
    nearness: float = 0.0  # 1/m, w / z at which the first light is held: 0 for one at infinity

    def is_like(self, other: "Proposal") -> bool:
        """Whether both split one region in nearly the same way."""
        return self.region is other.region and self.split.is_like(other.split)


@dataclass(frozen=True, slots=True, eq=False)
class FittedProposal:
    """A hypothesis with bodies that fit it, to be aligned with the picture."""

    proposal: Proposal
    bodies: Sequence[LitBody]  # the likeliest first
    sight: Sight  # whose centre lies near the bodies


def proposal_of(lit: LitBody, region: Region, materials: Materials) -> FittedProposal:
    """The hypothesis that a region shows this body in these lights, its colours learned in its silhouette."""
    seen = predicted_of(lit, region.view)
    as_object = object_cost(region, seen.body & region.is_ground)
    split = relabelled(region, materials, as_object, seen)
    return FittedProposal(Proposal(region, materials, split, as_object=as_object), [lit], Sight.of(region.view))


def explained(proposals: Sequence[Proposal], preset: FitPreset) -> list[Explanation | None]:
    """Fits bodies with lights to each proposal and aligns them with the picture; None where no light can be fitted."""
    masks = [_masks(proposal) for proposal in proposals]
    fits = fit_bodies(masks, preset)
    fitted = [
        None if fit is None else FittedProposal(one, fit.bodies, fit.sight)
        for one, fit in zip(proposals, fits, strict=True)
    ]
    return for_known(aligned_explanations, fitted)


def refitted_bodies(explanation: Explanation, preset: FitPreset) -> list[LitBody]:
    """The best body of every family for an explanation's labels, the likeliest first; none if they allow no fit."""
    start = explanation.lit.lights
    nearness = float(nearness_of(start)[0])
    proposal = Proposal(explanation.region, explanation.materials, explanation.split, start, nearness=nearness)
    (fit,) = fit_bodies([_masks(proposal)], preset)
    return [] if fit is None else fit.bodies


def aligned_explanations(several: Sequence[FittedProposal]) -> list[Explanation | None]:
    """Aligns the bodies of each proposal with the picture; None where the cheapest of them is not in view."""
    starts = [Start(one.bodies, one.sight, _costs(one.proposal, one.bodies[0])) for one in several]
    return [_explanation(one, found) for one, found in zip(several, aligned(starts), strict=True)]


def explained_near(several: Sequence[tuple[Explanation, float]], preset: FitPreset) -> list[Explanation | None]:
    """Explanations fitted anew, each with its first light held at a nearness w / z (1/m); None where no fit is in view.

    A lamp's shadow widens with height as no sun's does, so that a sun's fit has found another body: all families are
    searched again.
    """
    proposals = [
        Proposal(each.region, each.materials, each.split, each.lit.lights, each.as_object, nearness)
        for each, nearness in several
    ]
    return [None if found is None else refined_by_tangents(found) for found in explained(proposals, preset)]


def refined(roughs: Sequence[Explanation], preset: FitPreset) -> list[Explanation | None]:
    """Relabels each explanation's pixels by its own prediction, fits again, and keeps the cheaper of the two.

    A right explanation survives this. None for one whose new labels no longer allow a fit.
    """
    fines = for_known(partial(explained, preset=preset), [_relabelled(rough) for rough in roughs])
    return [None if fine is None else _better(rough, fine) for rough, fine in zip(roughs, fines, strict=True)]


def refined_by_tangents(explanation: Explanation) -> Explanation:
    """The explanation with its light refined by the common tangents of object and shadow, which hold for any shape.

    Where the fitted body is a poor model, the tangents decide. Two lights are left as they are, as labels do not show
    how far each shadow extends where the two overlap. So is a light whose shadow's far end is outside the picture, as a
    tangent would touch the shadow at the picture's edge.
    """
    split, alignment = explanation.split, explanation.alignment
    if len(explanation.lights) > 1 or alignment.ends_in_view[0] < END_IN_VIEW:
        return explanation
    view, unreliable = explanation.region.view, explanation.region.unreliable
    outlines = observe_outlines(split.object_mask, split.shadows, unreliable, DIRECTIONS, split.undecided)
    if outlines is None:
        return explanation
    body = alignment.placed.lit.body
    spheroids = body.spheroids if relative_misfit(alignment) < 1 else None
    # The labels may be newer than those that the body was fitted to, with another centre.
    P = Sight(view.camera, view.T_cam_marker, outlines.centre_px).P(body.frame)
    (light,) = explanation.lights
    in_body_frame = body.frame.lights(light.light[None])
    lights, covariance = lights_refined_by_tangents(
        P, outlines, in_body_frame, information_on_displacement(light), spheroids
    )
    (refined_light,) = fitted_lights(body.frame.lights_marker(lights), covariance)
    return replace(explanation, lights=(replace(refined_light, unseen_end=light.unseen_end),))


def explanation_criterion(explanation: Explanation) -> float:
    """The explanation's criterion under its own unary costs: those of the region's pixels, and of its parameters."""
    return criterion(replace(explanation.alignment.placed, cost=explanation.costs.of(explanation.predicted)))


def different(explanations: Iterable[Explanation], count: int | None = None) -> list[Explanation]:
    """The first `count` explanations, without those that are like an earlier one."""
    return distinct(explanations, are_alike, count)


def are_alike(one: Explanation, other: Explanation) -> bool:
    """Whether two explanations say the same: of one region, whose pixels they label alike; of two, where they overlap.

    To see an object in two regions does not make its light likelier.
    """
    if one.region is not other.region:
        return one.is_like(other, ONE_OBJECT_SHARE, ONE_OBJECT_RAD)
    a, b = one.predicted, other.predicted
    differing = np.count_nonzero((a.body != b.body) | (a.shadow != b.shadow))
    return bool(differing < DIFFERING_SHARE * np.count_nonzero(a.whole | b.whole))


def are_of_one_object(one: Explanation, other: Explanation) -> bool:
    """Whether two explanations are of what one region shows, or of what stands in one place in two regions."""
    return one.region is other.region or one.stands_as(other, ONE_OBJECT_SHARE)


def _masks(proposal: Proposal) -> Masks:
    region, split = proposal.region, proposal.split
    return Masks(
        split.object_mask,
        split.shadows,
        Sight.of(region.view),
        unreliable=region.unreliable,
        undecided=split.undecided,
        start=proposal.start,
        nearness=proposal.nearness,
    )


def _better(rough: Explanation, fine: Explanation) -> Explanation:
    """The one with the lower criterion by the rough one's colours; the rough one then gets the newer labels."""
    return fine if criterion(fine.alignment.placed) < explanation_criterion(rough) else replace(rough, split=fine.split)


def _relabelled(last: Explanation) -> Proposal | None:
    """A proposal with the pixels relabelled by the last body; None where two lights' shadows have merged into one."""
    split = relabelled(last.region, last.materials, last.as_object, last.predicted)
    if last.materials.lights == 2 and not are_two_shadows(split.parts):
        return None
    lit = last.lit
    start = lit.lights if min(to_light[2] for to_light in lit.to_lights_marker) > LOWEST_Z else None
    nearness = float(nearness_of(lit.lights)[0])
    return Proposal(last.region, last.materials, split, start, as_object=last.as_object, nearness=nearness)


def _costs(proposal: Proposal, likeliest: LitBody) -> Costs:
    """The unary costs for the alignment; unknown colours of the object are learned from the likeliest body."""
    region, as_object = proposal.region, proposal.as_object
    if as_object is None:
        as_object = _cost_of_object(proposal, predicted_of(likeliest, region.view).body & region.unlit)
    return Costs(region, proposal.materials, as_object)


def _explanation(fitted: FittedProposal, alignment: Alignment | None) -> Explanation | None:
    """The aligned body with its lights, and the object's unary cost as learned from the body's silhouette."""
    if alignment is None:
        return None
    proposal, region = fitted.proposal, fitted.proposal.region
    as_object = _cost_of_object(proposal, alignment.placed.predicted.body & region.is_ground)
    return Explanation(
        region,
        proposal.materials,
        proposal.split,
        alignment,
        lights=lights_of(alignment),
        as_object=as_object,
        bodies=tuple(fitted.bodies),
    )


def _cost_of_object(proposal: Proposal, seen: Mask) -> Float32:
    """(h, w) the object's unary cost by the colours in `seen`, or in the split's object where `seen` is too small."""
    mask = seen if np.count_nonzero(seen) > FEW_PX else proposal.split.object_mask
    return object_cost(proposal.region, mask, proposal.materials)
