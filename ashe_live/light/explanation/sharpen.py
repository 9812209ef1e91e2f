"""Explanations moved onto the steps of light in the picture at full resolution: the last and finest alignment."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter

import numpy as np

from ashe_live.light.edges.step_alignment import EdgeFit, aligned_with_steps, step_costs
from ashe_live.light.edges.step_costs import MISSED, StepCosts
from ashe_live.light.edges.steps import LightPicture
from ashe_live.light.explanation.alignment import COST_PER_PARAMETER, Alignment, measured
from ashe_live.light.explanation.explain import refined_by_tangents
from ashe_live.light.explanation.explanation import LIKELY_FAMILIES, Explanation
from ashe_live.light.explanation.light_covariance import lights_by_information
from ashe_live.light.explanation.normal_equations import PlacedBody, placed_in
from ashe_live.light.labels.costs import Costs
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.batches import for_alike, for_groups, for_known
from ashe_live.light.shape.body import LitBody, NearnessPrior
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.sight import Sight


@dataclass(frozen=True, slots=True, eq=False)
class _Sharp:
    """A body as it was moved onto the steps of light, and as it then lies in the region."""

    fit: EdgeFit
    placed: PlacedBody

    @property
    def criterion(self) -> float:
        """By the steps and by the pixels' unary costs, in units of what one more parameter costs."""
        return self.fit.criterion + self.placed.cost / COST_PER_PARAMETER


@dataclass(frozen=True, slots=True)
class Sharpener:
    """The steps of light in pictures of one scene, beginning with the picture that is explained."""

    pictures: Sequence[LightPicture]

    @staticmethod
    def of(views: Sequence[View]) -> "Sharpener":
        """Of views at full resolution."""
        return Sharpener([LightPicture.of(view) for view in views])

    def seen_from(self, views: Sequence[View]) -> "Sharpener":
        """With the poses of those of the views, at any size, that are of the same pictures."""
        return Sharpener([replace(picture, view=picture.view.seen_from(views)) for picture in self.pictures])

    def sharpened(self, several: Sequence[Explanation], near: NearnessPrior | None = None) -> list[Explanation]:
        """Each explanation by the body and the lights that agree best with the steps of light.

        All families that its labels allow are aligned, and the likeliest is kept, by the steps and by the pixels' unary
        costs, both in units of what one more parameter costs. An explanation is returned as it is if no body stays in
        view, or too little of a shadow. near: the prior on the nearness of their only lights, where that is not held.
        """
        return for_alike(partial(self._sharpened, near=near), several, _number_of_lights)

    def _sharpened(self, several: Sequence[Explanation], near: NearnessPrior | None) -> Iterator[Explanation]:
        """As `sharpened`, of explanations with the same number of lights."""
        fits = self._fits([[each.lit, *_other_bodies(each)] for each in several], several, near)
        pairs = zip(several, fits, strict=True)
        moved = for_groups(placed_in, [[(fit.lit, *_placing(each)) for fit in own] for each, own in pairs])
        sharp = [
            [_Sharp(*each) for each in zip(own, there, strict=True)] for own, there in zip(fits, moved, strict=True)
        ]
        best = [_likeliest(each) for each in sharp]
        alignments = for_known(measured, [None if one is None else one.placed for one in best])
        for explanation, one, alignment in zip(several, best, alignments, strict=True):
            if one is None or alignment is None:
                yield from self.measured([explanation])
                continue
            fit = one.fit
            # Where the body is a poor model, and its steps constrain little, the common tangents decide.
            yield refined_by_tangents(
                replace(
                    explanation,
                    alignment=alignment,
                    lights=lights_by_steps(fit, alignment),
                    steps=fit.mean_costs,
                    criterion=one.criterion,
                    nearness=fit.nearness,
                )
            )

    def best_fit(self, explanation: Explanation, near: NearnessPrior | None) -> EdgeFit | None:
        """The explanation's own body with its lights, moved; None where no steps are seen. near: as in `sharpened`."""
        (fits,) = self._fits([[explanation.lit]], [explanation], near)
        return next(iter(fits), None)

    def _fits(
        self, bodies: Sequence[Sequence[LitBody]], several: Sequence[Explanation], near: NearnessPrior | None
    ) -> list[list[EdgeFit]]:
        """Each explanation's bodies with their lights, moved, without those whose shadows show too few steps to
        determine their lights.
        """
        shifts = np.repeat([shifts_of(each) for each in several], [len(own) for own in bodies], axis=0)
        moved = for_groups(lambda lit: aligned_with_steps(lit, self.pictures, shifts, near), bodies)
        return [[fit for fit in own if fit is not None and fit.mean_cost < MISSED] for own in moved]

    def measured(self, explanations: Sequence[Explanation]) -> list[Explanation]:
        """The explanations where they stand, each with the costs of its steps."""

        def of_alike(several: Sequence[Explanation]) -> list[StepCosts]:
            shifts = np.array([shifts_of(each) for each in several])
            return step_costs([each.lit for each in several], self.pictures, shifts)

        costs = for_alike(of_alike, explanations, _number_of_lights)
        return [replace(each, steps=steps) for each, steps in zip(explanations, costs, strict=True)]


def lights_by_steps(fit: EdgeFit, alignment: Alignment, views_per_sample: float = 1.0) -> tuple[FittedLight, ...]:
    """The lights of an aligned body, with the covariance that the steps of light imply.

    alignment: of the same body; it says which shadows' ends are in view. views_per_sample: number of views over their
    effective sample size.
    """
    return lights_by_information(fit.lit, fit.information / views_per_sample, alignment.ends_in_view)


def _number_of_lights(explanation: Explanation) -> int:
    return len(explanation.lights)


def _other_bodies(explanation: Explanation) -> list[LitBody]:
    """Those of the likeliest families for the explanation's labels, with as many lights."""
    count = len(explanation.lit.lights)
    return [one for one in explanation.bodies if len(one.lights) == count][:LIKELY_FAMILIES]


def _placing(explanation: Explanation) -> tuple[Sight, Costs]:
    """Where a body of the explanation's is placed, and what its pixels cost."""
    return explanation.alignment.placed.sight, explanation.costs


def _likeliest(several: Sequence[_Sharp]) -> _Sharp | None:
    """The one with the lowest criterion; None where none is in view."""
    seen = [one for one in several if one.placed.is_in_view]
    return min(seen, key=attrgetter("criterion"), default=None)


def shifts_of(explanation: Explanation) -> list[float]:
    """Each light's shift of the log of brightness in its shadow; negative."""
    return [float(shift[0]) for shift in explanation.shifts]
