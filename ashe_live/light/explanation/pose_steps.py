"""The poses of views that a body is aligned in, moved along with the body (docs/maths.md, "Poses that move")."""

from collections.abc import Sequence
from dataclasses import replace

from ashe_live.core.arrays import Float
from ashe_live.light.edges.moved_views import PoseEquations, moved_view, pose_cost
from ashe_live.light.explanation.alignment import NormalEquations, PlacedBody
from ashe_live.light.explanation.borders import PIXELS_PER_SAMPLE
from ashe_live.light.labels.costs import Costs
from ashe_live.light.pixels.view import View


def pose_equations(placed: PlacedBody, pull: NormalEquations, number: int) -> PoseEquations | None:
    """What the borders tell of a view's pose; None where that is exact. number: of the body among those of `pull`."""
    outlines = len(placed.hulls_px)
    own = slice(number * outlines, (number + 1) * outlines)
    places = pull.places.points[own].reshape(-1, 2), pull.places.normals[own].reshape(-1, 2)
    by_theta, weight, offset_px = pull.by_theta[number], pull.weight[number], pull.offset_px[number]
    return PoseEquations.of(placed.lit, placed.costs.region.view, places, by_theta, weight, offset_px)


def with_pose_moved(costs: Costs, step: Float) -> Costs:
    """The costs in their view, its pose moved by (w, v), (6,)."""
    return _with_pose(costs, moved_view(costs.region.view, step))


def seen_from(costs: Costs, views: Sequence[View]) -> Costs:
    """The costs with the pose of that one of the views which is of the same picture; as they are where none is."""
    view = next((view for view in views if view.shows(costs.region.view.measured)), None)
    return costs if view is None else _with_pose(costs, view)


def cost_of_moves(several: Sequence[PlacedBody]) -> float:
    """What it costs that the views' poses have been moved, in the unit of pixels' unary costs."""
    return PIXELS_PER_SAMPLE * sum(pose_cost(one.costs.region.view) for one in several)


def _with_pose(costs: Costs, view: View) -> Costs:
    return replace(costs, region=costs.region.with_pose(view.T_cam_marker))
