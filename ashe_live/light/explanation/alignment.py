"""Alignment: moves fitted bodies and their shadows until their outlines lie on the borders seen in the picture.

Each pixel has a unary cost: that of its colour under the material which the body and its shadows predict there. Along
the normal at each sampled point of a predicted outline, these costs give the position of the border and its variance.
The body's parameters follow by least squares, as in model-based tracking (Harris and Stennett, "RAPID", 1990), but from
region statistics in place of gradients. Unlike outlines of masks, such borders are not spoilt by single areas that look
like another material (docs/maths.md, "Alignment").

The bodies of several explanations are moved as one batch: the arrays are small, so the overhead of NumPy's calls
dominates.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.edges.outline_points import (
    POINTS_PER_OUTLINE,
    OutlinePoints,
    are_in_view,
    derivatives_by_theta,
    evenly_spaced,
)
from ashe_live.light.explanation.borders import Borders, borders_at
from ashe_live.light.labels.costs import Costs
from ashe_live.light.outline_fit.search import damped_steps, offset_of_lights, prior_information
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.family import padded
from ashe_live.light.shape.layout import Layout, light_parameters
from ashe_live.light.shape.predicted import Predicted, lit_outlines, painted
from ashe_live.light.shape.sight import Sight

# Search range for a border on either side of the outline: a fraction of the object's size in each round, and the least.
SEARCH_RANGES, LEAST_RANGE_PX = (0.14, 0.1, 0.06, 0.05), 3.0
OUTLIER_SHARE, OUTLIER_PX = 0.03, 0.75  # scale of Cauchy's loss in the last round: of the object's size, and at least
EARLY_LOSS_FACTOR = 3.0  # times that scale in the rounds before
# Penalty per parameter: the ln n of the Bayesian information criterion, n the region's pixels, times the number of
# pixels whose errors are correlated, as a colour model is wrong over whole patches.
COST_PER_PARAMETER = 250.0
# Number of bodies, each of another family, that are moved. The second costs 6 % of an estimate's time; of 250 training
# pictures 13 answers are sure and wrong with it, and 18 without.
TRIED_BODIES = 2
LEAST_OBJECT_PX = 30  # area that the size of smaller silhouettes is counted by
WIDEST_NEARNESS = 10.0  # one over the body's size: sigma of the prior on nearness, for lights that no border constrains


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


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """A body moved onto the picture's borders, and how well it agrees with them."""

    placed: PlacedBody
    normal: Float  # (split + q, split + q) matrix of the normal equations: the information on theta
    misfit_px: float  # robust root mean square distance between the outlines and the borders
    clear_body: float  # mean clarity of the border along the observable part of the body's outline, 0 to 1
    clear_shadow: float  # the same along the outlines of all shadows
    clear_shadows: tuple[float, ...]  # the same along each shadow's outline
    ends_in_view: tuple[float, ...]  # (l,) fraction of each shadow's far end inside the picture, hidden or not
    elsewhere: tuple[PlacedBody, ...] = ()  # the same body in other views, if their borders were aligned with as well


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Candidate bodies from which an alignment begins, and the unary costs of the picture."""

    bodies: Sequence[LitBody]  # all with the same number of lights
    sight: Sight  # whose centre lies near the bodies
    costs: Costs


def aligned(several: Sequence[Start], ranges: Sequence[float] = SEARCH_RANGES) -> list[Alignment | None]:
    """For each start the cheapest of its bodies, moved onto the borders around it; None if that body is not in view.

    The TRIED_BODIES that are cheapest before they move are tried, as the family that fits the masks best need not fit
    the pixels best. Steps of Harris and Stennett, with Cauchy's weights (docs/maths.md). ranges: as SEARCH_RANGES.
    """
    found: list[Alignment | None] = [None] * len(several)
    lights = [len(start.bodies[0].lights) for start in several]
    for count in set(lights):
        members = [i for i, each in enumerate(lights) if each == count]
        for i, alignment in zip(members, _aligned([several[i] for i in members], ranges), strict=True):
            found[i] = alignment
    return found


def lights_as_lamps(several: Sequence[PlacedBody]) -> tuple[Float, Float]:
    """How the borders constrain the lights if each may be a lamp: (3 l,) offset, (3 l, 3 l) information on it.

    The offset is that of every light's displacement s and nearness w / z, in the body frame, from the placed body's
    lights; the shape is marginalised out. several: the body in one or more views, in all of which it must be visible.
    """
    lit = several[0].lit
    layout = Layout(len(lit.lights), with_nearness=True)
    pull = normal_equations(several, SEARCH_RANGES[-1], 1.0, layout.with_nearness)
    normal, gradient = pull.normal.sum(axis=0), pull.gradient.sum(axis=0)
    prior, diagonal = prior_information(lit.body.family, layout), np.arange(len(normal))
    normal[diagonal, diagonal] -= (len(several) - 1) * prior  # which each view's includes
    nearness = [layout.light(i).stop - 1 for i in range(layout.lights)]
    normal[nearness, nearness] += 1 / WIDEST_NEARNESS**2
    return offset_of_lights(normal, gradient, layout)


def criterion(placed: PlacedBody) -> float:
    """Model selection criterion: the total unary cost plus a penalty per shape parameter; lower is likelier."""
    return placed.cost + COST_PER_PARAMETER * len(placed.lit.body.shape)


def _aligned(several: Sequence[Start], ranges: Sequence[float]) -> list[Alignment | None]:
    """As `aligned`, where all bodies have the same number of lights."""
    candidates = iter(placed_in([(lit, start.sight, start.costs) for start in several for lit in start.bodies]))
    tried = [sorted((next(candidates) for _ in start.bodies), key=criterion)[:TRIED_BODIES] for start in several]
    best = [one for bodies in tried for one in bodies]
    here = list(best)
    for number, range_share in enumerate(ranges):
        in_view = [i for i, one in enumerate(here) if one.is_in_view]
        if not in_view:
            break
        steps = normal_equations(
            [here[i] for i in in_view], range_share, 1.0 if number == len(ranges) - 1 else EARLY_LOSS_FACTOR
        ).steps()
        stepping = [(here[i], step) for i, step in zip(in_view, steps, strict=True)]
        moved = placed_in([(one.lit.moved(step), one.sight, one.costs) for one, step in stepping])
        for i, one in zip(in_view, moved, strict=True):
            here[i] = one
            best[i] = min(best[i], one, key=attrgetter("cost"))
    each = iter(best)
    cheapest = [min((next(each) for _ in bodies), key=criterion) for bodies in tried]
    seen = iter(measured([one for one in cheapest if one.is_in_view]))
    return [next(seen) if one.is_in_view else None for one in cheapest]


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

    loss_factor: factor on the scale of Cauchy's loss. with_nearness: as in the Layout of theta.
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
    layout = Layout(len(several[0].lit.lights), with_nearness)
    normal[:, diagonal, diagonal] += padded([prior_information(one.lit.body.family, layout) for one in several])
    return NormalEquations(borders, away, weight, by_theta, normal, points)


def measured(several: Sequence[PlacedBody]) -> list[Alignment]:
    """Measures misfit, clarity and information of bodies in view, where they stand."""
    if not several:
        return []
    pull = normal_equations(several, SEARCH_RANGES[-1], 1.0)
    squares = (pull.weight * pull.offset_px**2).sum(axis=1) / np.maximum(pull.weight.sum(axis=1), 1e-9)
    clarity = pull.borders.clarity.reshape(len(several), -1)
    found = []
    in_view = pull.borders.in_view.reshape(len(several), -1, POINTS_PER_OUTLINE)
    for i, (one, normal, square, clear) in enumerate(zip(several, pull.normal, squares, clarity, strict=True)):
        size = one.lit.layout.split + len(one.lit.body.shape)
        clear_body, clear_shadow = (
            _mean_of_known(clear[:POINTS_PER_OUTLINE]),
            _mean_of_known(clear[POINTS_PER_OUTLINE:]),
        )
        each = tuple(_mean_of_known(shadow) for shadow in clear[POINTS_PER_OUTLINE:].reshape(-1, POINTS_PER_OUTLINE))
        ends = _ends_in_view(one.lit.lights_in_body_frame, pull.by_theta[i], in_view[i, 1:])
        found.append(Alignment(one, normal[:size, :size], math.sqrt(square), clear_body, clear_shadow, each, ends))
    return found


def _ends_in_view(lights: Float, by_theta: Float, in_view: Mask) -> tuple[float, ...]:
    """(l,) fraction of each shadow's far end in view, weighted by how far its points move as the shadow lengthens.

    lights: (l, 4) in the body frame, where s points from the body's foot. in_view: (l, p) whether each point of the
    shadows' outlines lies inside the picture.
    """
    ends, layout = [], Layout(len(lights))
    for i, displacement in enumerate(light_parameters(lights)):
        outward = displacement @ by_theta[layout.light(i)].reshape(len(displacement), -1, POINTS_PER_OUTLINE)[:, 1 + i]
        end_weights = np.maximum(outward, 0) ** 2
        # A shadow straight below its object has no far end.
        ends.append(min(float(end_weights @ in_view[i] / end_weights.sum()), 1.0) if end_weights.any() else 1.0)
    return tuple(ends)


def _mean_of_known(values: Float) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) > 2 else 0.0
