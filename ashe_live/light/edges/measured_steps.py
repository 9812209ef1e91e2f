"""The steps of light around bodies in one picture, as they enter the normal equations of their alignment."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask, once_for_each
from ashe_live.light.edges.moved_views import PoseEquations
from ashe_live.light.edges.outline_points import (
    POINTS_PER_OUTLINE,
    OutlinePoints,
    are_in_view,
    derivatives_by_theta,
    evenly_spaced,
    sizes_px,
)
from ashe_live.light.edges.step_costs import MISSED
from ashe_live.light.edges.steps import LightPicture, steps_across
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.predicted import lit_outlines
from ashe_live.light.shape.sight import Sight

# Scale of Geman and McClure's loss: at least, and as a fraction of the object's size.
OUTLIER_PX, OUTLIER_SHARE = 0.75, 0.0125
BESIDE_BODY_PX = 2.0  # the shadow's outline cannot be seen nearer to the object
SHAPE_ERROR_SHARE = 0.004  # sigma of a real object's outline from the nearest member of a family, of its size
NOWHERE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

Scalar = TypeVar("Scalar", bound=np.generic)


@dataclass(frozen=True, eq=False)
class MeasuredSteps:
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
        weight, by_theta = self.weight(loss_factor), self._by_theta(with_nearness)
        if offset:
            by_theta = np.insert(by_theta, by_theta.shape[1], np.arange(by_theta.shape[2]) < POINTS_PER_OUTLINE, axis=1)
        gradient = (by_theta @ (weight * self.offset_px)[..., None])[..., 0]
        return (by_theta * weight[:, None]) @ by_theta.swapaxes(1, 2), gradient

    def pose(self, loss_factor: float, with_nearness: bool) -> PoseEquations | None:
        """Of the only body; None where it is not in view, or the view's pose is exact."""
        if not self.is_in_view[0]:
            return None
        by_theta, weight = self._by_theta(with_nearness)[0], self.weight(loss_factor)[0]
        places = self.places.points.reshape(-1, 2), self.places.normals.reshape(-1, 2)
        return PoseEquations.of(self.bodies[0], self.view, places, by_theta, weight, self.offset_px[0])

    @once_for_each
    def _by_theta(self, with_nearness: bool) -> Float:
        """(n, split + q, r) derivatives by theta of the points' outward movement; 0 for a body that is not in view."""
        by_theta = derivatives_by_theta(self.bodies, self.sights, self.places, with_nearness)
        return np.where(self.is_in_view[:, None, None], by_theta, 0.0)

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


def measured_steps(bodies: Sequence[LitBody], picture: LightPicture, shifts: Float, reach_px: float) -> MeasuredSteps:
    """The steps within `reach_px` of the outlines of n bodies of l lights each; shifts (n, l): of their shadows, as for
    `alignment.aligned_with_steps`.
    """
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
    return MeasuredSteps(
        bodies=bodies,
        is_in_view=in_view,
        offset_px=steps.offset_px.reshape(n, -1),
        information=information.reshape(n, -1),
        should_be_seen=should_be_seen.reshape(n, -1),
        places=places,
        sights=sights,
        object_px=sizes_px(outlines),
        view=picture.view,
    )


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
