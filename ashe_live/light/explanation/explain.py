"""Explanations: from what a split says of a region's pixels to a body and lights that suit the picture."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.explanation.alignment import Alignment, Start, aligned, criterion
from ashe_live.light.explanation.evidence import Explanation
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import Materials, object_cost
from ashe_live.light.labels.relabel import relabelled
from ashe_live.light.labels.two_lights import are_two
from ashe_live.light.outline_fit.fit import FitFailure, FitPreset, Masks, fit_bodies
from ashe_live.light.outline_fit.search import information_on_lights
from ashe_live.light.outline_fit.tangents import sharpened_lights
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.directions import (
    FittedLight,
    above_the_ground,
    fitted_lights,
    information_on_slant,
    with_end_in_view,
)
from ashe_live.light.shape.predicted import predicted
from ashe_live.light.shape.sight import Sight
from ashe_live.light.shape.silhouettes import observe_outlines

EDGE_SIGMA_PX = 0.7
DIRECTIONS = 16  # in which outlines are looked at for their tangents alone
LOWEST_Z = 0.03  # of a direction whose displacement can be started from
FEW_PX = 20
# Errors of neighbouring borders are correlated: the number of borders over their effective sample size. And the misfit,
# as a share of the object's size, at which a body's own model error doubles the variance of its borders. Both measured,
# so that 68 % of the errors lie within sigma (docs/accuracy.md).
BORDERS_PER_SAMPLE, WRONG_BODY_SHARE = 2.3, 0.007
END_IN_VIEW = 0.5  # share of a shadow's far end that must be in the picture for its length to be known
# Share of its pixels in which an explanation must differ from another to be worth more work.
DIFFERING_SHARE = 0.04


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """A region taken for an object and its shadow."""

    region: Region
    materials: Materials
    split: Split
    start: Float | None = None  # (l, 4) lights from which a fit may begin as well
    as_object: Float32 | None = None  # (h, w) unary cost of the object's colours, where they are known better

    def is_like(self, other: "Proposal") -> bool:
        """Whether both split one region in nearly the same way."""
        return self.region is other.region and self.split.is_like(other.split)


def explained(proposals: Sequence[Proposal], preset: FitPreset) -> list[Explanation | None]:
    """What follows from each; None where no light does."""
    masks = [
        Masks(
            proposal.split.object_mask,
            proposal.split.shadows,
            Sight.of(proposal.region.view),
            proposal.region.unreliable,
            EDGE_SIGMA_PX,
            proposal.split.undecided,
            proposal.start,
        )
        for proposal in proposals
    ]
    fits = fit_bodies(masks, preset)
    pairs = zip(proposals, fits, strict=True)
    found = iter(suited([(one, fit.bodies, fit.sight) for one, fit in pairs if not isinstance(fit, FitFailure)]))
    return [None if isinstance(fit, FitFailure) else next(found) for fit in fits]


def suited(several: Sequence[tuple[Proposal, Sequence[LitBody], Sight]]) -> list[Explanation | None]:
    """For each proposal what the picture makes of bodies in a sight, the likeliest first; None if not in view."""
    starts = [Start(bodies, sight, _costs(proposal, bodies[0])) for proposal, bodies, sight in several]
    return [_explanation(each[0], found) for each, found in zip(several, aligned(starts), strict=True)]


def finer(roughs: Sequence[Explanation], preset: FitPreset) -> list[Explanation]:
    """Each with its pixels labelled by what has been found, and fitted to the labels: whichever suits better.

    What is right explains its own labels; an explanation of which nothing is left then is none.
    """
    pairs = [(rough, proposal) for rough in roughs if (proposal := _relabelled(rough)) is not None]
    fines = explained([proposal for _, proposal in pairs], preset)
    return [_better(rough, fine) for (rough, _), fine in zip(pairs, fines, strict=True) if fine is not None]


def sharpened(explanation: Explanation) -> Explanation:
    """With what its labels' common tangents say of the light, which needs no body: decisive where that is wrong.

    Not of two lights: where their shadows overlap, labels do not tell how far each of them goes. Nor of a shadow whose
    far end is not in the picture: a tangent would touch it where the picture ends.
    """
    split, alignment = explanation.split, explanation.alignment
    if len(explanation.lights) > 1 or alignment.ends_in_view[0] < END_IN_VIEW:
        return explanation
    view, unreliable = explanation.region.view, explanation.region.unreliable
    outlines = observe_outlines(
        split.object_mask, split.shadows, unreliable, DIRECTIONS, EDGE_SIGMA_PX, split.undecided
    )
    if isinstance(outlines, str):
        return explanation
    body = alignment.placed.lit.body
    spheroids = body.spheroids if _wrongness(alignment) < 1 else None
    # The labels may be later ones than those that the body was fitted to.
    P = Sight(view.camera, view.T_cam_marker, outlines.centre_px).P(body.place)
    (light,) = explanation.lights
    own = body.place.lights(light.point)
    sharp = sharpened_lights(P, outlines, own, information_on_slant(light), EDGE_SIGMA_PX, spheroids)
    return replace(explanation, lights=fitted_lights(*sharp))


def price(explanation: Explanation) -> float:
    """The explanation's criterion under its own unary costs: those of the region's pixels, and of its parameters."""
    costs = Costs(explanation.region, explanation.materials, explanation.as_object)
    return criterion(replace(explanation.alignment.placed, cost=costs.of(explanation.predicted)))


def are_alike(one: Explanation, other: Explanation) -> bool:
    """Whether two explanations of one region say nearly the same of its pixels."""
    if one.region is not other.region:
        return False
    a, b = one.predicted, other.predicted
    differing = np.count_nonzero((a.body != b.body) | (a.shadow != b.shadow))
    return bool(differing < DIFFERING_SHARE * np.count_nonzero(a.whole | b.whole))


def _better(rough: Explanation, fine: Explanation) -> Explanation:
    """Whichever costs less, with what the rough one says of the object's colours; and with the later labels."""
    return fine if criterion(fine.alignment.placed) < price(rough) else replace(rough, split=fine.split)


def _relabelled(last: Explanation) -> Proposal | None:
    """What a body makes of the labels that led to it; None where two lights' shadows have become one."""
    split = relabelled(last.region, last.materials, last.as_object, last.predicted)
    if last.materials.lights == 2 and not are_two(split.parts):
        return None
    lit = last.alignment.placed.lit
    start = lit.lights if min(towards[2] for towards in lit.to_lights_marker) > LOWEST_Z else None
    return Proposal(last.region, last.materials, split, start, last.as_object)


def _costs(proposal: Proposal, likeliest: LitBody) -> Costs:
    """What pixels cost before the alignment."""
    region, own = proposal.region, proposal.as_object
    if own is None:
        seen = predicted(likeliest.body.proxy, likeliest.lights, region.view)
        own = _cost_of_object(region, seen.body & region.unlit, proposal.split)
    return Costs(region, proposal.materials, own)


def _explanation(proposal: Proposal, alignment: Alignment | None) -> Explanation | None:
    """The aligned body, its lights, and what is then known of its colours."""
    if alignment is None:
        return None
    region, split = proposal.region, proposal.split
    own = _cost_of_object(region, alignment.placed.predicted.body & region.is_ground, split)
    return Explanation(region, proposal.materials, split, alignment, _lights(alignment), own)


def _cost_of_object(region: Region, seen: Mask, split: Split) -> Float32:
    """By the colours of what is seen of the object; of the split's, where that is hardly anything."""
    return object_cost(region, seen if np.count_nonzero(seen) > FEW_PX else split.object_mask)


def _lights(alignment: Alignment) -> tuple[FittedLight, ...]:
    covariance = np.asarray(np.linalg.inv(_information(alignment)))
    lights = fitted_lights(alignment.placed.lit.lights, covariance)
    return tuple(with_end_in_view(light, share) for light, share in zip(lights, alignment.ends_in_view, strict=True))


def _information(alignment: Alignment) -> Float:
    """(split, split) on the lights: little where the body is a wrong one."""
    lit = alignment.placed.lit
    information = information_on_lights(alignment.normal, lit.layout)
    return above_the_ground(information / (BORDERS_PER_SAMPLE * (1 + _wrongness(alignment) ** 2)), lit.lights)


def _wrongness(alignment: Alignment) -> float:
    return alignment.missed_px / (WRONG_BODY_SHARE * alignment.placed.object_px)
