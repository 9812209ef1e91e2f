"""Normal equations of bodies' parameters, by the borders that pictures show near their predicted outlines.

The views' poses, by which several pictures see one body, are moved along with it (docs/maths, "Poses that move").
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.edges.moved_views import PoseEquations, moved_view, pose_cost
from ashe_live.light.edges.outline_points import OutlinePoints, are_in_view, derivatives_by_theta, evenly_spaced
from ashe_live.light.explanation.borders import PIXELS_PER_SAMPLE, Borders, borders_at
from ashe_live.light.labels.costs import Costs
from ashe_live.light.outline_fit.search import damped_steps, prior_information
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.family import Family, padded
from ashe_live.light.shape.layout import ParameterLayout
from ashe_live.light.shape.predicted import Predicted, lit_outlines, painted
from ashe_live.light.shape.sight import Sight

LEAST_RANGE_PX = 3.0  # in which a border is searched on either side of the outline
OUTLIER_SHARE, OUTLIER_PX = 0.03, 0.75  # scale of Cauchy's loss in the last round: of the object's size, and at least
LEAST_OBJECT_PX = 30  # area that the size of smaller silhouettes is counted by


@dataclass(frozen=True, slots=True, eq=False)
class PlacedBody:
    """A body in a picture, and the region's total unary cost with it there."""

    lit: LitBody
    sight: Sight  # pixels are counted from near the object, which keeps the derivatives well conditioned
    costs: Costs
    hulls_px: list[Float | None]  # (m, 2) the outlines of the body and of its shadows
    predicted: Predicted
    cost: float

    @property
    def object_px(self) -> float:
        """The object's size in pixels: the square root of its silhouette's area."""
        return math.sqrt(max(int(np.count_nonzero(self.predicted.body)), LEAST_OBJECT_PX))

    @property
    def outlier_px(self) -> float:
        return max(OUTLIER_SHARE * self.object_px, OUTLIER_PX)

    @property
    def is_in_view(self) -> bool:
        """Whether all its outlines can be projected, and none of them is unreasonably large."""
        return are_in_view(self.hulls_px)


def placed_in(several: Sequence[tuple[LitBody, Sight, Costs]]) -> list[PlacedBody]:
    """Projects and paints each body in its picture, and adds up the unary costs."""
    if not several:
        return []
    outlines = lit_outlines([lit for lit, _, _ in several], [Sight.of(costs.region.view) for _, _, costs in several])
    found = []
    for (lit, sight, costs), hulls in zip(several, outlines, strict=True):
        predicted = painted(hulls, costs.as_object.shape)
        found.append(PlacedBody(lit, sight, costs, hulls, predicted, costs.of(predicted)))
    return found


@dataclass(frozen=True, slots=True, eq=False)
class NormalEquations:
    """Weighted normal equations of n bodies, from the residuals at r = (1 + l) p points of their outlines."""

    borders: Borders
    offset_px: Float  # (n, r) distance of each border outside of the outline
    weight: Float  # (n, r) information of each border, reduced for outliers
    by_theta: Float  # (n, split + q, r) derivatives of the points' outward movement by theta
    normal: Float  # (n, split + q, split + q) information matrix of theta, the prior included
    places: OutlinePoints  # the points, p on each of n (1 + l) outlines

    @property
    def gradient(self) -> Float:
        """(n, split + q) towards the borders."""
        return np.asarray((self.by_theta @ (self.weight * self.offset_px)[..., None])[..., 0])

    def steps(self) -> Float:
        """(n, split + q) damped Gauss-Newton steps of theta towards the borders."""
        return damped_steps(self.normal, self.gradient)


def normal_equations(
    several: Sequence[PlacedBody], range_share: float, loss_factor: float, with_nearness: bool = False
) -> NormalEquations:
    """Sets up the normal equations of bodies in view, with borders searched within `range_share` of the object's size.

    loss_factor: factor on the scale of Cauchy's loss. with_nearness: as in the ParameterLayout of theta.
    """
    n, outlines = len(several), len(several[0].hulls_px)
    reach_px = np.array([max(range_share * one.object_px, LEAST_RANGE_PX) for one in several])
    sides = [
        side for one, reach in zip(several, reach_px, strict=True) for side in one.costs.sides(one.predicted, reach)
    ]
    points = evenly_spaced([hull for one in several for hull in one.hulls_px if hull is not None])
    borders = borders_at(points, sides, reach_px.repeat(outlines))
    away = borders.offset_px.reshape(n, -1)
    scale_px = np.array([[loss_factor * one.outlier_px] for one in several])
    weight = borders.information.reshape(n, -1) / (1 + (away / scale_px) ** 2)
    by_theta = derivatives_by_theta([one.lit for one in several], [one.sight for one in several], points, with_nearness)
    normal = (by_theta * weight[:, None]) @ by_theta.swapaxes(1, 2)
    diagonal = np.arange(normal.shape[1])
    layout = ParameterLayout(len(several[0].lit.lights), with_nearness)
    normal[:, diagonal, diagonal] += padded([prior_information(one.lit.body.family, layout) for one in several])
    return NormalEquations(borders, away, weight, by_theta, normal, points)


def added_up(normals: Float, family: Family, layout: ParameterLayout) -> Float:
    """(t, t) the sum of one body's normal matrices (v, t, t) in several views, the prior that each has counted once."""
    total, prior = normals.sum(axis=0), prior_information(family, layout)
    diagonal = np.arange(len(prior))  # what is beyond pads it to the size of others of its batch
    total[diagonal, diagonal] -= (len(normals) - 1) * prior
    return np.asarray(total)


def pose_equations(placed: PlacedBody, equations: NormalEquations, number: int) -> PoseEquations | None:
    """The normal equations of a view's pose by a body's borders; None where the pose is exact.

    number: of the body among those of `equations`.
    """
    outlines = len(placed.hulls_px)
    own = slice(number * outlines, (number + 1) * outlines)
    places = equations.places.points[own].reshape(-1, 2), equations.places.normals[own].reshape(-1, 2)
    by_theta, weight, offset_px = equations.by_theta[number], equations.weight[number], equations.offset_px[number]
    return PoseEquations.of(placed.lit, placed.costs.region.view, places, by_theta, weight, offset_px)


def with_pose_moved(costs: Costs, step: Float) -> Costs:
    """The costs in their view, its pose moved by (w, v), (6,)."""
    return costs.with_pose(moved_view(costs.region.view, step).T_cam_marker)


def cost_of_moves(several: Sequence[PlacedBody]) -> float:
    """What it costs that the views' poses have been moved, in the unit of pixels' unary costs."""
    return PIXELS_PER_SAMPLE * sum(pose_cost(one.costs.region.view) for one in several)
