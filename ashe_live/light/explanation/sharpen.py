"""Explanations moved onto the steps of light in the picture at full resolution: the last and finest alignment."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.light.edges.alignment import EdgeFit, aligned_with_steps, step_costs
from ashe_live.light.edges.step_costs import MISSED
from ashe_live.light.edges.steps import LightPicture
from ashe_live.light.explanation.alignment import COST_PER_PARAMETER, Alignment, measured, placed_in
from ashe_live.light.explanation.explain import refined_by_tangents
from ashe_live.light.explanation.explanation import LIKELY_FAMILIES, Explanation
from ashe_live.light.labels.costs import Costs
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody, NearnessPrior
from ashe_live.light.shape.directions import (
    FittedLight,
    corrected_for_cut_shadow,
    fitted_lights,
    with_hemisphere_prior,
)


@dataclass(frozen=True, slots=True)
class Sharpener:
    """The steps of light in pictures of one scene, that which is explained first."""

    pictures: Sequence[LightPicture]

    @staticmethod
    def of(views: Sequence[View]) -> "Sharpener":
        """Of views at full resolution."""
        return Sharpener([LightPicture.of(view) for view in views])

    def sharpened(self, explanation: Explanation, near: NearnessPrior | None = None) -> Explanation:
        """The explanation by the body and the lights that agree best with the steps of light.

        Of the families that its labels allow, each is aligned, and the likeliest is kept, by the steps and by the
        pixels' unary costs, both in units of what one more parameter costs. The explanation as it is where no body
        stays in view, or too little of a shadow. near: of its only light's nearness, where that is not held.
        """
        placed = explanation.alignment.placed
        others = [one for one in explanation.bodies if len(one.lights) == len(placed.lit.lights)]
        fits = self._fits([placed.lit, *others[:LIKELY_FAMILIES]], explanation, near)
        costs = Costs(explanation.region, explanation.materials, explanation.as_object)
        moved = placed_in([(fit.lit, placed.sight, costs) for fit in fits]) if fits else []
        seen = [(fit, one) for fit, one in zip(fits, moved, strict=True) if one.is_in_view]
        if not seen:
            (as_it_is,) = self.measured([explanation])
            return as_it_is
        criteria = [fit.criterion + body.cost / COST_PER_PARAMETER for fit, body in seen]
        best, body = seen[int(np.argmin(criteria))]
        (alignment,) = measured([body])
        lights = lights_by_steps(best, alignment)
        # Where the body is a poor model, and its steps tell little, the common tangents decide.
        found = replace(
            explanation,
            alignment=alignment,
            lights=lights,
            steps=best.mean_costs,
            criterion=min(criteria),
            nearness=best.nearness,
        )
        return refined_by_tangents(found)

    def best_fit(self, explanation: Explanation, near: NearnessPrior | None = None) -> EdgeFit | None:
        """The explanation's own body with its lights, moved; None where no steps are seen. near: as in `sharpened`."""
        return next(iter(self._fits([explanation.alignment.placed.lit], explanation, near)), None)

    def _fits(
        self, bodies: Sequence[LitBody], explanation: Explanation, near: NearnessPrior | None = None
    ) -> list[EdgeFit]:
        """The bodies with their lights, moved, without those whose shadows show too few steps to tell their lights."""
        shifts = np.repeat([_shifts(explanation)], len(bodies), axis=0)
        fits = aligned_with_steps(bodies, self.pictures, shifts, near)
        return [fit for fit in fits if fit is not None and fit.mean_cost < MISSED]

    def measured(self, explanations: Sequence[Explanation]) -> list[Explanation]:
        """The explanations where they stand, each with the costs of its steps."""
        found = list(explanations)
        for count in {len(each.lights) for each in explanations}:
            members = [i for i, each in enumerate(explanations) if len(each.lights) == count]
            bodies = [explanations[i].alignment.placed.lit for i in members]
            shifts = np.array([_shifts(explanations[i]) for i in members])
            for i, costs in zip(members, step_costs(bodies, self.pictures, shifts), strict=True):
                found[i] = replace(explanations[i], steps=costs)
        return found


def lights_by_steps(fit: EdgeFit, alignment: Alignment, views_as_one: float = 1.0) -> tuple[FittedLight, ...]:
    """The lights of an aligned body, with the covariance that the steps of light imply.

    alignment: of the same body, by which shadows' ends are in view. views_as_one: how many views tell as much as one.
    """
    information = with_hemisphere_prior(fit.information / views_as_one, fit.lit.lights_in_body_frame)
    lights = fitted_lights(fit.lit.lights, np.asarray(np.linalg.inv(information)))
    return tuple(
        corrected_for_cut_shadow(light, seen) for light, seen in zip(lights, alignment.ends_in_view, strict=True)
    )


def _shifts(explanation: Explanation) -> list[float]:
    """Each light's shift of the log of brightness in its shadow; negative."""
    return [float(shift[0]) for shift in explanation.materials.shifts[: len(explanation.lights)]]
