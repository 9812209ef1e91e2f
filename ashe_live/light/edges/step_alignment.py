"""Bodies and their lights moved onto the steps of light in a picture, and which family explains these best.

Gauss-Newton steps with Geman and McClure's weights from a start that is right to a few pixels, much as in
`explanation.alignment`, whose borders come from unary costs instead (docs/maths, "Steps of light").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.edges.measured_steps import MeasuredSteps, measured_steps
from ashe_live.light.edges.moved_views import moved_view
from ashe_live.light.edges.nearness import NearnessBySteps, without_offset
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE
from ashe_live.light.edges.step_costs import FEWEST_STEPS, MISSED, StepCosts, mean_costs
from ashe_live.light.edges.steps import LightPicture
from ashe_live.light.outline_fit.search import damped_steps, information_on_lights, prior_information
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody, NearnessPrior
from ashe_live.light.shape.family import padded
from ashe_live.light.shape.layout import ParameterLayout

REACHES_PX = (4.0, 3.0, 2.0, 2.0, 2.0)  # within which steps are looked for: what the start may be off, then less
EARLY_LOSS_FACTOR = 3.0  # on the scale of Geman and McClure's loss, in the rounds whose reach still shrinks
FEWEST_SAMPLES = 3.0  # effective sample size of a criterion, at least: the logarithm of one is no penalty


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFit:
    """A body with its lights, as aligned with the steps of light in a picture."""

    lit: LitBody
    normal: Float  # (split + q, split + q) matrix of the normal equations: the information on theta
    cost: float  # squared distances of its outlines from the steps, in sigmas, each MISSED at most
    count: int  # points at which a step should be seen
    mean_costs: StepCosts  # the same on average, of each kind of outline
    shadow_steps: int  # points of the shadow's outline at which one is; of two lights' shadows, of that with fewer
    views: Sequence[View] = ()  # of the pictures, with the poses that they were moved to along with the only body
    as_lamp: tuple[Float, Float] | None = None  # normal matrix and gradient with the nearness, where that was free

    @property
    def mean_cost(self) -> float:
        """Mean squared distance of the outlines from the steps, in sigmas; MISSED where a shadow is hidden."""
        return self.cost / self.count if self.shadow_steps >= FEWEST_STEPS else MISSED

    @property
    def information(self) -> Float:
        """(split, split) on the lights, whatever the shape; less where steps are missed by more than their sigmas."""
        return information_on_lights(self.normal, self.lit.layout) / self._points_per_sample

    @property
    def nearness(self) -> NearnessBySteps | None:
        """The first light's nearness by the steps, where that was free."""
        return None if self.as_lamp is None else NearnessBySteps.of(*self.as_lamp).over(self._points_per_sample)

    @property
    def _points_per_sample(self) -> float:
        return BORDERS_PER_SAMPLE * max(self.mean_cost, 1.0)

    @property
    def criterion(self) -> float:
        """The Bayesian information criterion, in units of a shape parameter's penalty; lower is likelier.

        That penalty is the logarithm of the effective sample size.
        """
        samples = max(self.count / BORDERS_PER_SAMPLE, FEWEST_SAMPLES)
        return self.mean_cost * samples / math.log(samples) + len(self.lit.body.shape)


def aligned_with_steps(
    several: Sequence[LitBody], pictures: Sequence[LightPicture], shifts: Float, near: NearnessPrior | None = None
) -> list[EdgeFit | None]:
    """Each body moved onto the steps of light around its outlines; None where it does not stay in view.

    several: n nearly right bodies of l lights each. pictures: of one scene, whose normal equations are summed. shifts:
    (n, l) logs of how much darker the ground is in each light's shadow than out of it, negative. near: of the nearness
    of one light each, where that is not held.
    """
    here, pictures = list(several), list(pictures)
    moves = len(several) == 1 and len(pictures) > 1
    for reach in REACHES_PX:
        seen = _Seen([measured_steps(here, picture, shifts, reach) for picture in pictures], near, moves)
        steps, poses = seen.steps(EARLY_LOSS_FACTOR if reach > REACHES_PX[-1] else 1.0)
        here = [lit.moved(step, near is not None) for lit, step in zip(here, steps, strict=True)]
        pictures = [
            picture if pose is None else replace(picture, view=moved_view(picture.view, pose))
            for picture, pose in zip(pictures, poses, strict=True)
        ]
    seen = _Seen([measured_steps(here, picture, shifts, REACHES_PX[-1]) for picture in pictures], near, moves)
    return seen.fits([picture.view for picture in pictures])


def step_costs(several: Sequence[LitBody], pictures: Sequence[LightPicture], shifts: Float) -> list[StepCosts]:
    """The mean costs of bodies where they stand; arguments as for `aligned_with_steps`."""
    seen = _Seen([measured_steps(several, picture, shifts, REACHES_PX[0]) for picture in pictures])
    return [mean_costs(*each) for each in zip(*seen.costs(), strict=True)]


@dataclass(frozen=True, slots=True)
class _Seen:
    """The steps of light around n bodies in all pictures."""

    views: Sequence[MeasuredSteps]
    near: NearnessPrior | None = None
    moves: bool = False  # whether the views' poses move with the only body

    def equations(self, loss_factor: float, with_nearness: bool = False, offset: bool = False) -> tuple[Float, Float]:
        """As `MeasuredSteps.equations`, of all pictures, with the shape's prior; the offset is marginalised out."""
        equations = [view.equations(loss_factor, with_nearness, offset) for view in self.views]
        normal, gradient = (np.sum(each, axis=0) for each in zip(*equations, strict=True))
        if offset:
            normal, gradient = without_offset(normal, gradient)
        bodies, diagonal = self.views[0].bodies, np.arange(normal.shape[1])
        layout = ParameterLayout(len(bodies[0].lights), with_nearness)
        normal[:, diagonal, diagonal] += padded([prior_information(one.body.family, layout) for one in bodies])
        return normal, gradient

    def steps(self, loss_factor: float) -> tuple[Float, list[Float | None]]:
        """(n, split + q) damped Gauss-Newton steps of theta; (6,) those of each view's pose, None where it stays."""
        normal, gradient = self.equations(loss_factor, self.near is not None)
        if self.near is not None:
            at = ParameterLayout(1, with_nearness=True).split - 1
            information, towards = self.near.applied(self.views[0].bodies)
            normal[:, at, at] += BORDERS_PER_SAMPLE * information
            gradient[:, at] += BORDERS_PER_SAMPLE * towards
        poses = [view.pose(loss_factor, self.near is not None) if self.moves else None for view in self.views]
        for pose in poses:
            if pose is not None:
                normal, gradient = pose.marginalised(normal, gradient)
        steps = damped_steps(normal, gradient)
        return steps, [None if pose is None else pose.step(steps[0]) for pose in poses]

    def costs(self) -> tuple[Float, Float, Float]:
        """As `MeasuredSteps.costs`, of all pictures, with the steps of the shadow that has the fewest (n,)."""
        cost, count, steps = (np.sum(each, axis=0) for each in zip(*(view.costs() for view in self.views), strict=True))
        return cost, count, steps.min(axis=1)

    def fits(self, views: Sequence[View]) -> list[EdgeFit | None]:
        """Of every body; None for one that is in view nowhere. views: of the pictures."""
        normals, _ = self.equations(1.0)
        free = None if self.near is None else self.equations(1.0, with_nearness=True, offset=True)
        in_view = np.any([view.is_in_view for view in self.views], axis=0)
        found: list[EdgeFit | None] = []
        for i, (lit, cost, count, steps) in enumerate(zip(self.views[0].bodies, *self.costs(), strict=True)):
            size = lit.layout.split + len(lit.body.shape)
            costs = mean_costs(cost, count, steps)
            as_lamp = None if free is None else (free[0][i, : size + 1, : size + 1], free[1][i, : size + 1])
            fit = EdgeFit(
                lit=lit,
                normal=normals[i, :size, :size],
                cost=float(cost.sum()),
                count=int(count.sum()),
                mean_costs=costs,
                shadow_steps=int(steps),
                views=views,
                as_lamp=as_lamp,
            )
            found.append(fit if in_view[i] else None)
        return found
