"""Bodies and their lights moved onto the steps of light in a picture, and which family explains these best.

Gauss-Newton steps with Geman and McClure's weights from a start that is right to a few pixels, much as in
`explanation.alignment`, whose borders come from unary costs instead (docs/maths.md, "Steps of light").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.edges.moved_views import POINTS_PER_SAMPLE, PoseEquations, moved_view
from ashe_live.light.edges.nearness import NearnessBySteps, without_offset
from ashe_live.light.edges.outline_points import (
    POINTS_PER_OUTLINE,
    OutlinePoints,
    are_in_view,
    derivatives_by_theta,
    evenly_spaced,
    sizes_px,
)
from ashe_live.light.edges.step_costs import FEWEST_STEPS, MISSED, StepCosts, mean_costs
from ashe_live.light.edges.steps import LightPicture, steps_across
from ashe_live.light.outline_fit.search import damped_steps, information_on_lights, prior_information
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody, NearnessPrior
from ashe_live.light.shape.family import padded
from ashe_live.light.shape.layout import Layout
from ashe_live.light.shape.predicted import lit_outlines
from ashe_live.light.shape.sight import Sight

REACHES_PX = (4.0, 3.0, 2.0, 2.0, 2.0)  # within which steps are looked for: what the start may be off, then less
# Scale of Geman and McClure's loss in the last rounds: at least, and as a fraction of the object's size; and the factor
# on it in the rounds whose reach still shrinks.
OUTLIER_PX, OUTLIER_SHARE, EARLY_LOSS_FACTOR = 0.75, 0.0125, 3.0
BESIDE_BODY_PX = 2.0  # the shadow's outline cannot be seen nearer to the object
SHAPE_ERROR_SHARE = 0.004  # sigma of a real object's outline from the nearest member of a family, of its size
FEWEST_SAMPLES = 3.0  # effective sample size of a criterion, at least: the logarithm of one is no penalty
NOWHERE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

Scalar = TypeVar("Scalar", bound=np.generic)


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
        """What the steps tell of the first light's nearness, where that was free."""
        return None if self.as_lamp is None else NearnessBySteps.of(*self.as_lamp).over(self._points_per_sample)

    @property
    def _points_per_sample(self) -> float:
        return POINTS_PER_SAMPLE * max(self.mean_cost, 1.0)

    @property
    def criterion(self) -> float:
        """The Bayesian information criterion, in units of a shape parameter's penalty; lower is likelier.

        That penalty is the logarithm of the effective sample size.
        """
        samples = max(self.count / POINTS_PER_SAMPLE, FEWEST_SAMPLES)
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
        seen = _Seen([_measured(here, picture, shifts, reach) for picture in pictures], near, moves)
        steps, poses = seen.steps(EARLY_LOSS_FACTOR if reach > REACHES_PX[-1] else 1.0)
        here = [lit.moved(step, near is not None) for lit, step in zip(here, steps, strict=True)]
        pictures = [
            picture if pose is None else replace(picture, view=moved_view(picture.view, pose))
            for picture, pose in zip(pictures, poses, strict=True)
        ]
    seen = _Seen([_measured(here, picture, shifts, REACHES_PX[-1]) for picture in pictures], near, moves)
    return seen.fits([picture.view for picture in pictures])


def step_costs(several: Sequence[LitBody], pictures: Sequence[LightPicture], shifts: Float) -> list[StepCosts]:
    """The mean costs of bodies where they stand; arguments as of `aligned_with_steps`."""
    seen = _Seen([_measured(several, picture, shifts, REACHES_PX[0]) for picture in pictures])
    return [mean_costs(*each) for each in zip(*seen.costs(), strict=True)]


@dataclass(frozen=True, slots=True, eq=False)
class _Measured:
    """The steps of light around n bodies in one picture, as they enter the normal equations."""

    bodies: Sequence[LitBody]
    is_in_view: Mask  # (n,)
    offset_px: Float  # (n, r) of the r = (1 + l) p points of a body's outlines
    information: Float  # (n, r) 0 where there is no step, and everywhere for a body that is not in view
    should_be_seen: Mask  # (n, r) points where a step must be, if the body is right; none of a body not in view
    places: OutlinePoints  # the r points, outline by outline
    sights: Sequence[Sight]  # (n,) about the bodies' middles
    object_px: Float  # (n,) the object's size: the square root of its silhouette's area
    view: View  # that the picture is

    def weight(self, loss_factor: float) -> Float:
        """(n, r) the information, reduced for outliers."""
        scale_px = loss_factor * np.maximum(OUTLIER_PX, OUTLIER_SHARE * self.object_px)[:, None]
        return np.asarray(self.information / (1 + (self.offset_px / scale_px) ** 2) ** 2)

    def equations(self, loss_factor: float, with_nearness: bool, offset: bool) -> tuple[Float, Float]:
        """(n, t, t) normal matrices without the prior on the shape, (n, t) gradients towards the steps.

        offset: with a last parameter, the pixels by which all steps around the object itself are too far out.
        """
        weight = self.weight(loss_factor)
        by_theta = derivatives_by_theta(self.bodies, self.sights, self.places, with_nearness)
        if offset:
            by_theta = np.insert(by_theta, by_theta.shape[1], np.arange(by_theta.shape[2]) < POINTS_PER_OUTLINE, axis=1)
        by_theta = np.where(self.is_in_view[:, None, None], by_theta, 0.0)
        gradient = (by_theta @ (weight * self.offset_px)[..., None])[..., 0]
        return (by_theta * weight[:, None]) @ by_theta.swapaxes(1, 2), gradient

    def pose(self, loss_factor: float, with_nearness: bool) -> PoseEquations | None:
        """Of the only body; None where it is not in view, or the view's pose is exact."""
        if not self.is_in_view[0]:
            return None
        by_theta = derivatives_by_theta(self.bodies, self.sights, self.places, with_nearness)[0]
        places = self.places.points.reshape(-1, 2), self.places.normals.reshape(-1, 2)
        return PoseEquations.of(
            self.bodies[0], self.view, places, by_theta, self.weight(loss_factor)[0], self.offset_px[0]
        )

    def costs(self) -> tuple[Float, Float, Float]:
        """(n, 1 + l) of each outline: squared distances in sigmas, each MISSED at most, and the number of points that
        these are of; (n, l) of each shadow's points that have a step.
        """
        variance = 1 / np.maximum(self.information, 1e-9) + (SHAPE_ERROR_SHARE * self.object_px[:, None]) ** 2
        squares = np.where(self.information > 0, np.minimum(self.offset_px**2 / variance, MISSED), MISSED)

        def by_outline(values: Float | Mask) -> Float:
            return np.asarray(values.reshape(len(self.bodies), -1, POINTS_PER_OUTLINE).sum(axis=2, dtype=np.float64))

        steps = by_outline(self.information > 0)[:, 1:]
        return by_outline(squares * self.should_be_seen), by_outline(self.should_be_seen), steps


@dataclass(frozen=True, slots=True)
class _Seen:
    """The steps of light around n bodies in all pictures."""

    views: Sequence[_Measured]
    near: NearnessPrior | None = None
    moves: bool = False  # whether the views' poses move with the only body

    def equations(self, loss_factor: float, with_nearness: bool = False, offset: bool = False) -> tuple[Float, Float]:
        """As `_Measured.equations`, of all pictures, with the prior on the shape, and the offset marginalised out."""
        equations = [view.equations(loss_factor, with_nearness, offset) for view in self.views]
        normal, gradient = (np.sum(each, axis=0) for each in zip(*equations, strict=True))
        if offset:
            normal, gradient = without_offset(normal, gradient, POINTS_PER_SAMPLE)
        bodies, diagonal = self.views[0].bodies, np.arange(normal.shape[1])
        layout = Layout(len(bodies[0].lights), with_nearness)
        normal[:, diagonal, diagonal] += padded([prior_information(one.body.family, layout) for one in bodies])
        return normal, gradient

    def steps(self, loss_factor: float) -> tuple[Float, list[Float | None]]:
        """(n, split + q) damped Gauss-Newton steps of theta; (6,) those of each view's pose, None where it stays."""
        normal, gradient = self.equations(loss_factor, self.near is not None)
        if self.near is not None:
            at = Layout(1, with_nearness=True).split - 1
            information, towards = self.near.applied(self.views[0].bodies)
            normal[:, at, at] += POINTS_PER_SAMPLE * information
            gradient[:, at] += POINTS_PER_SAMPLE * towards
        poses = [view.pose(loss_factor, self.near is not None) if self.moves else None for view in self.views]
        for pose in poses:
            if pose is not None:
                lost, drawn = pose.marginalised()
                normal, gradient = normal - lost, gradient - drawn
        steps = damped_steps(normal, gradient)
        return steps, [None if pose is None else pose.step(steps[0]) for pose in poses]

    def costs(self) -> tuple[Float, Float, Float]:
        """As `_Measured.costs`, of all pictures, with the steps of the shadow that has the fewest (n,)."""
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
                lit, normals[i, :size, :size], float(cost.sum()), int(count.sum()), costs, int(steps), views, as_lamp
            )
            found.append(fit if in_view[i] else None)
        return found


def _measured(bodies: Sequence[LitBody], picture: LightPicture, shifts: Float, reach_px: float) -> _Measured:
    sight = Sight.of(picture.view)
    hulls = lit_outlines(bodies, [sight] * len(bodies))
    in_view = np.array([are_in_view(each) for each in hulls])
    # What is not in view takes the place of a triangle somewhere, so that the batch keeps its shape.
    shown = [
        hull if is_shown and hull is not None else NOWHERE
        for each, is_shown in zip(hulls, in_view, strict=True)
        for hull in each
    ]
    places, n = evenly_spaced(shown), len(bodies)
    # Its own outline may rise or fall; out of a shadow the ground is brighter.
    rises = np.column_stack([np.full(n, np.nan), -shifts]).ravel()
    steps = steps_across(picture.linear_bgr, places, reach_px, rises)
    should_be_seen = _by_outline(picture.is_reliable_at(places.points), n) & _visible(places, n)
    should_be_seen &= in_view[:, None, None]
    landed = places.points + steps.offset_px[..., None] * places.normals
    is_usable = should_be_seen & _by_outline(picture.is_reliable_at(landed), n)
    outlines = _by_outline(places.points, n)[:, 0]
    sights = [Sight(sight.camera, sight.T_cam_marker, outline.mean(axis=0)) for outline in outlines]
    information = np.where(is_usable, _by_outline(steps.information, n), 0.0)
    offset, told, seen = steps.offset_px.reshape(n, -1), information.reshape(n, -1), should_be_seen.reshape(n, -1)
    return _Measured(bodies, in_view, offset, told, seen, places, sights, sizes_px(outlines), picture.view)


def _by_outline(values: NDArray[Scalar], n: int) -> NDArray[Scalar]:
    """(n, 1 + l, p, ...) from (n (1 + l), p, ...): of each body its own outline, then those of its shadows."""
    return values.reshape(n, -1, *values.shape[1:])


def _visible(places: OutlinePoints, n: int) -> Mask:
    """(n, 1 + l, p) whether points of the n bodies' shadows show a step that is theirs alone; True for bodies' own.

    Not where the body hides them, nor in another light's shadow, out of which light rises by another ratio.
    """
    points, normals = _by_outline(places.points, n), _by_outline(places.normals, n)
    count = points.shape[1]
    seen = np.ones(points.shape[:3], dtype=np.bool_)
    for number in range(1, count):
        for other in (each for each in range(count) if each != number):
            # A point is outside of a convex outline if it is so of one of its tangents.
            reached = np.einsum("npk,nik->npi", points[:, number], normals[:, other])
            reached -= np.einsum("nik,nik->ni", points[:, other], normals[:, other])[:, None]
            seen[:, number] &= reached.max(axis=2) > BESIDE_BODY_PX
    return seen
