"""Alignment: fitted bodies and their shadows are moved until their outlines lie on the picture's own borders.

Each pixel costs what its colour costs the material that it is predicted to be of. Across every place of a predicted
outline, the costs on either side say where the border is and how surely; the body follows by least squares, as in
model-based tracking (Harris and Stennett, "RAPID", 1990), with regions in the place of gradients. Unlike outlines of
masks, such borders are not spoilt by single areas that look like another material (docs/maths.md).

The bodies of several explanations are moved in step: NumPy's calls cost more than their numbers, which are few.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.explanation.borders import PLACES, Borders, Places, borders_at, evenly_spread
from ashe_live.light.labels.costs import Costs
from ashe_live.light.outline_fit.search import stiffness_of
from ashe_live.light.shape.body import Body, outlines_of
from ashe_live.light.shape.family import padded, parts_of
from ashe_live.light.shape.predicted import Predicted, painted
from ashe_live.light.shape.supports import outline_supports

# How far a border is looked for, as a share of the object's size: a little nearer in each round.
REACHES, LEAST_REACH_PX = (0.14, 0.1, 0.06, 0.05), 3.0
OUTLIER_SHARE, OUTLIER_PX = 0.03, 0.75  # misses beyond this count less and less (Cauchy's loss) in the end;
FORGIVING = 3.0  # and beyond this many times as much, at first
DAMPING, LARGEST_STEP = 1e-3, 1.0
# Bayes's ln n of the region's pixels, times the pixels whose errors go together: materials are wrong patch by patch.
COST_PER_PARAMETER = 250.0
TURN_RAD = 0.03  # by which a line is turned to touch either end of a straight edge
FARTHEST_PX = 5e3


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A body in a picture, and what it costs there."""

    body: Body
    costs: Costs
    hulls_px: list[Float | None]  # (m, 2) the outlines of the body and of its shadows
    predicted: Predicted
    cost: float

    @property
    def object_px(self) -> float:
        """Square root of the body's area."""
        return math.sqrt(max(int(np.count_nonzero(self.predicted.body)), 30))

    @property
    def outlier_px(self) -> float:
        return max(OUTLIER_SHARE * self.object_px, OUTLIER_PX)

    @property
    def is_in_view(self) -> bool:
        """Whether all its outlines are, and none of them endlessly large."""
        return all(hull is not None and np.abs(hull).max() <= FARTHEST_PX for hull in self.hulls_px)


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """A body where the picture wants it, and how well it suits there."""

    placed: Placed
    normal: Float  # (2 l + q, 2 l + q) information on slants and shape
    missed_px: float  # root mean square by which borders are missed, outliers forgiven
    clear_body: float  # share of the body's outline that has a clear border; of what is known of it
    clear_shadow: float  # of the shadows' outlines
    clear_shadows: tuple[float, ...]  # of each one's
    ends_in_view: tuple[float, ...]  # how much of each shadow's far end is in the picture, be it hidden by the body


def aligned(several: Sequence[tuple[Sequence[Body], Costs]]) -> list[Alignment | None]:
    """For each picture the body that suits it best, moved to the borders around it; None if that is not in view."""
    found: list[Alignment | None] = [None] * len(several)
    lights = [len(bodies[0].slants) for bodies, _ in several]
    for count in set(lights):
        own = [i for i, each in enumerate(lights) if each == count]
        for i, alignment in zip(own, _aligned([several[i] for i in own]), strict=True):
            found[i] = alignment
    return found


def criterion(placed: Placed) -> float:
    """Its cost, and what its parameters cost: the least is the likeliest."""
    return placed.cost + COST_PER_PARAMETER * len(placed.body.shape)


def _aligned(several: Sequence[tuple[Sequence[Body], Costs]]) -> list[Alignment | None]:
    """As `aligned`, where all bodies have equally many lights."""
    candidates = iter(_placed([(body, costs) for bodies, costs in several for body in bodies]))
    best = [min((next(candidates) for _ in bodies), key=criterion) for bodies, _ in several]
    here = list(best)
    for number, share in enumerate(REACHES):
        left = [i for i, one in enumerate(here) if one.is_in_view]
        if not left:
            break
        steps = _pulled([here[i] for i in left], share, 1.0 if number == len(REACHES) - 1 else FORGIVING).steps()
        moved = _placed([(here[i].body.moved(step), here[i].costs) for i, step in zip(left, steps, strict=True)])
        for i, one in zip(left, moved, strict=True):
            here[i] = one
            best[i] = min(best[i], one, key=attrgetter("cost"))
    seen = iter(_appraised([one for one in best if one.is_in_view]))
    return [next(seen) if one.is_in_view else None for one in best]


def _placed(several: Sequence[tuple[Body, Costs]]) -> list[Placed]:
    """Each body in its picture."""
    outlines = outlines_of([body for body, _ in several], [costs.region.view for _, costs in several])
    found = []
    for (body, costs), hulls in zip(several, outlines, strict=True):
        predicted = painted(hulls, costs.own.shape)
        found.append(Placed(body, costs, hulls, predicted, costs.of(predicted)))
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Pull:
    """Where borders pull n bodies, by their misses of r = (1 + l) p places."""

    borders: Borders
    away_px: Float  # (n, r) the borders', outward
    weight: Float  # (n, r) what each border counts, those far off less and less
    by_theta: Float  # (n, 2 l + q, r) how the places move outward with slants and shape
    normal: Float  # (n, 2 l + q, 2 l + q) what all tell of slants and shape

    def steps(self) -> Float:
        """(n, 2 l + q) Gauss and Newton's, towards the borders."""
        damped, diagonal = self.normal.copy(), np.arange(self.normal.shape[1])
        curvature = self.normal[:, diagonal, diagonal]
        damped[:, diagonal, diagonal] += DAMPING * curvature + 1e-6 * curvature.max(axis=1, keepdims=True) + 1e-12
        gradient = self.by_theta @ (self.weight * self.away_px)[..., None]
        return np.asarray(np.clip(np.linalg.solve(damped, gradient)[..., 0], -LARGEST_STEP, LARGEST_STEP))


def _pulled(several: Sequence[Placed], reach_share: float, forgiving: float) -> _Pull:
    """Those in view, by the borders nearer than that share of each object's size."""
    n, outlines = len(several), len(several[0].hulls_px)
    bodies = [one.body for one in several]
    reach_px = np.array([max(reach_share * one.object_px, LEAST_REACH_PX) for one in several])
    sides = [
        side for one, reach in zip(several, reach_px, strict=True) for side in one.costs.sides(one.predicted, reach)
    ]
    places = evenly_spread([hull for one in several for hull in one.hulls_px if hull is not None])
    borders = borders_at(places, sides, reach_px.repeat(outlines))
    away = borders.away_px.reshape(n, -1)
    scale_px = np.array([[forgiving * one.outlier_px] for one in several])
    weight = borders.information.reshape(n, -1) / (1 + (away / scale_px) ** 2)
    by_theta = _slopes(bodies, places)
    normal = (by_theta * weight[:, None]) @ by_theta.swapaxes(1, 2)
    diagonal = np.arange(normal.shape[1])
    normal[:, diagonal, diagonal] += padded([stiffness_of(body.family, body.slants.size) for body in bodies])
    return _Pull(borders, away, weight, by_theta, normal)


def _appraised(several: Sequence[Placed]) -> list[Alignment]:
    if not several:
        return []
    pull = _pulled(several, REACHES[-1], 1.0)
    squares = (pull.weight * pull.away_px**2).sum(axis=1) / np.maximum(pull.weight.sum(axis=1), 1e-9)
    clarity = pull.borders.clarity.reshape(len(several), -1)
    found = []
    in_view = pull.borders.in_view.reshape(len(several), -1, PLACES)
    for i, (one, normal, square, clear) in enumerate(zip(several, pull.normal, squares, clarity, strict=True)):
        size = one.body.slants.size + len(one.body.shape)
        clear_body, clear_shadow = _mean_of_known(clear[:PLACES]), _mean_of_known(clear[PLACES:])
        each = tuple(_mean_of_known(shadow) for shadow in clear[PLACES:].reshape(-1, PLACES))
        ends = _ends_in_view(one.body.slants, pull.by_theta[i], in_view[i, 1:])
        found.append(Alignment(one, normal[:size, :size], math.sqrt(square), clear_body, clear_shadow, each, ends))
    return found


def _ends_in_view(slants: Float, by_theta: Float, in_view: Mask) -> tuple[float, ...]:
    """Of l shadows, `in_view` (l, p): of the places that move outward as each grows, by how far, those in view."""
    ends = []
    for i, slant in enumerate(slants):
        outward = slant @ by_theta[2 * i : 2 * i + 2].reshape(2, -1, PLACES)[:, 1 + i]
        counts = np.maximum(outward, 0) ** 2
        # A shadow straight below its object has no far end.
        ends.append(min(float(counts @ in_view[i] / counts.sum()), 1.0) if counts.any() else 1.0)
    return tuple(ends)


def _mean_of_known(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) > 2 else 0.0


def _slopes(bodies: Sequence[Body], places: Places) -> Float:
    """(n, 2 l + q, (1 + l) p) how places of n bodies' outlines move outward with slants and shape.

    A straight edge moves as its two ends do, the parts that are touched by the edge's line turned a little.
    """
    n, slants = len(bodies), np.array([body.slants for body in bodies])
    c, s = math.cos(TURN_RAD), math.sin(TURN_RAD)
    normals, share = places.normals.reshape(n, -1, PLACES, 2).swapaxes(2, 3), places.share.reshape(n, -1, PLACES)
    aside = s * normals[:, :, ::-1] * [[-1], [1]]
    outward = np.concatenate([normals, normals], axis=3)
    turned = np.concatenate([c * normals - aside, c * normals + aside], axis=3)
    parts, by_shape = parts_of([body.family for body in bodies], padded([body.shape for body in bodies]))
    supports = outline_supports(np.array([body.guess.P for body in bodies]), parts, slants, outward, turned)
    by_theta = supports.by_theta(by_shape)
    ends = by_theta[..., :PLACES], by_theta[..., PLACES:]
    return np.asarray(((1 - share)[:, None] * ends[0] + share[:, None] * ends[1]).reshape(n, by_theta.shape[1], -1))
