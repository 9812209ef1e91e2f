"""Alignment: moves fitted bodies and their shadows until their outlines lie on the borders seen in the picture.

Each pixel has a unary cost: that of its colour under the material which the body and its shadows predict there. Along
the normal at each sampled point of a predicted outline, these costs give the position of the border and its variance.
The body's parameters follow by least squares, as in model-based tracking (Harris and Stennett, "RAPID", 1990), but from
region statistics in place of gradients. Unlike outlines of masks, such borders are not spoilt by single areas that look
like another material (docs/maths, "Alignment").

The bodies of several explanations are moved as one batch: the arrays are small, so the overhead of NumPy's calls
dominates.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.edges.outline_points import POINTS_PER_OUTLINE
from ashe_live.light.explanation.normal_equations import PlacedBody, added_up, normal_equations, placed_in
from ashe_live.light.labels.costs import Costs
from ashe_live.light.outline_fit.search import offset_of_lights
from ashe_live.light.shape.batches import for_alike, for_groups, for_known
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.layout import ParameterLayout, light_parameters
from ashe_live.light.shape.sight import Sight

# Search range for a border on either side of the outline: a fraction of the object's size in each round.
SEARCH_RANGES = 0.14, 0.1, 0.06, 0.05
EARLY_LOSS_FACTOR = 3.0  # times the scale of Cauchy's loss in all rounds but the last
# Penalty per parameter: the ln n of the Bayesian information criterion, n the region's pixels, times the number of
# pixels whose errors are correlated, as a colour model is wrong over whole patches.
COST_PER_PARAMETER = 250.0
# Number of bodies, each of another family, that are moved. The second costs 6 % of an estimate's time; of 250 training
# pictures 13 answers are sure and wrong with it, and 18 without.
TRIED_BODIES = 2
WIDEST_NEARNESS = 10.0  # one over the body's size: sigma of the prior on nearness, for lights that no border constrains


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
    the pixels best. Steps of Harris and Stennett, with Cauchy's weights (docs/maths). ranges: as SEARCH_RANGES.
    """
    return for_alike(partial(_aligned, ranges=ranges), several, lambda start: len(start.bodies[0].lights))


def lights_as_lamps(several: Sequence[PlacedBody]) -> tuple[Float, Float]:
    """How the borders constrain the lights if each may be a lamp: (3 l,) offset, (3 l, 3 l) information on it.

    The offset is that of every light's displacement s and nearness w / z, in the body frame, from the placed body's
    lights; the shape is marginalised out. several: the body in one or more views, in all of which it must be visible.
    """
    lit = several[0].lit
    layout = ParameterLayout(len(lit.lights), with_nearness=True)
    equations = normal_equations(several, SEARCH_RANGES[-1], 1.0, layout.with_nearness)
    normal, gradient = added_up(equations.normal, lit.body.family, layout), equations.gradient.sum(axis=0)
    nearness = [layout.light(i).stop - 1 for i in range(layout.lights)]
    normal[nearness, nearness] += 1 / WIDEST_NEARNESS**2
    return offset_of_lights(normal, gradient, layout)


def criterion(placed: PlacedBody) -> float:
    """Model selection criterion: the total unary cost plus a penalty per shape parameter; lower is likelier."""
    return placed.cost + COST_PER_PARAMETER * len(placed.lit.body.shape)


def _aligned(several: Sequence[Start], ranges: Sequence[float]) -> list[Alignment | None]:
    """As `aligned`, where all bodies have the same number of lights."""
    candidates = for_groups(placed_in, [[(lit, start.sight, start.costs) for lit in start.bodies] for start in several])
    tried = [sorted(bodies, key=criterion)[:TRIED_BODIES] for bodies in candidates]
    moved = for_groups(partial(_moved_onto_borders, ranges=ranges), tried)
    cheapest = [min(bodies, key=criterion) for bodies in moved]
    return for_known(measured, [one if one.is_in_view else None for one in cheapest])


def _moved_onto_borders(several: Sequence[PlacedBody], ranges: Sequence[float]) -> list[PlacedBody]:
    """Each body where it costs least on its way onto the borders around it, as long as it stays in view."""
    here, best = list(several), list(several)
    for number, range_share in enumerate(ranges):
        in_view = [i for i, one in enumerate(here) if one.is_in_view]
        if not in_view:
            break
        loss_factor = 1.0 if number == len(ranges) - 1 else EARLY_LOSS_FACTOR
        steps = normal_equations([here[i] for i in in_view], range_share, loss_factor).steps()
        stepping = [(here[i], step) for i, step in zip(in_view, steps, strict=True)]
        moved = placed_in([(one.lit.moved(step), one.sight, one.costs) for one, step in stepping])
        for i, one in zip(in_view, moved, strict=True):
            here[i] = one
            best[i] = min(best[i], one, key=attrgetter("cost"))
    return best


def measured(several: Sequence[PlacedBody]) -> list[Alignment]:
    """Measures misfit, clarity and information of bodies in view, where they stand."""
    if not several:
        return []
    equations = normal_equations(several, SEARCH_RANGES[-1], 1.0)
    squares = (equations.weight * equations.offset_px**2).sum(axis=1) / np.maximum(equations.weight.sum(axis=1), 1e-9)
    clarity = equations.borders.clarity.reshape(len(several), -1)
    in_view = equations.borders.in_view.reshape(len(several), -1, POINTS_PER_OUTLINE)
    found = []
    for i, (one, normal, square, clear) in enumerate(zip(several, equations.normal, squares, clarity, strict=True)):
        size = one.lit.layout.split + len(one.lit.body.shape)
        of_shadows = clear[POINTS_PER_OUTLINE:]
        found.append(
            Alignment(
                placed=one,
                normal=normal[:size, :size],
                misfit_px=math.sqrt(square),
                clear_body=_mean_of_known(clear[:POINTS_PER_OUTLINE]),
                clear_shadow=_mean_of_known(of_shadows),
                clear_shadows=tuple(map(_mean_of_known, of_shadows.reshape(-1, POINTS_PER_OUTLINE))),
                ends_in_view=_ends_in_view(one.lit.lights_in_body_frame, equations.by_theta[i], in_view[i, 1:]),
            )
        )
    return found


def _ends_in_view(lights: Float, by_theta: Float, in_view: Mask) -> tuple[float, ...]:
    """(l,) fraction of each shadow's far end in view, weighted by how far its points move as the shadow lengthens.

    lights: (l, 4) in the body frame, where s points from the body's foot. in_view: (l, p) whether each point of the
    shadows' outlines lies inside the picture.
    """
    ends, layout = [], ParameterLayout(len(lights))
    for i, displacement in enumerate(light_parameters(lights)):
        outward = displacement @ by_theta[layout.light(i)].reshape(len(displacement), -1, POINTS_PER_OUTLINE)[:, 1 + i]
        end_weights = np.maximum(outward, 0) ** 2
        # A shadow straight below its object has no far end.
        ends.append(min(float(end_weights @ in_view[i] / end_weights.sum()), 1.0) if end_weights.any() else 1.0)
    return tuple(ends)


def _mean_of_known(values: Float) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) > 2 else 0.0
