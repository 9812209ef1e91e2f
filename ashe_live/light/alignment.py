"""Alignment: a fitted body and its shadows are moved until their outlines lie on the picture's own borders.

Each pixel costs what its colour costs the material that it is predicted to be of. Across every place of a predicted
outline, the costs on either side say where the border is and how surely; the body follows by least squares, as in
model-based tracking (Harris and Stennett, "RAPID", 1990), with regions in the place of gradients. Unlike outlines of
masks, such borders are not spoilt by single areas that look like another material (docs/maths.md).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.areas import grown
from ashe_live.light.body import Body
from ashe_live.light.borders import PLACES, Borders, Places, borders_at, evenly_spread
from ashe_live.light.log_colour import Float32
from ashe_live.light.materials import Materials
from ashe_live.light.predicted import Predicted, outlines, painted
from ashe_live.light.regions import Region
from ashe_live.light.search import stiffness_of
from ashe_live.light.supports import outline_supports

# How far a border is looked for, as a share of the object's size: a little nearer in each round.
REACHES, LEAST_REACH_PX = (0.14, 0.1, 0.06, 0.05), 3.0
OUTLIER_SHARE, OUTLIER_PX = 0.03, 0.75  # misses beyond this count less and less (Cauchy's loss) in the end;
FORGIVING = 3.0  # and beyond this many times as much, at first
DAMPING, LARGEST_STEP = 1e-3, 1.0
STEPS = (1.0, 1.5)  # a border at the end of what was looked at lies farther, so that the first step may be too short
FAMILIES_WEIGHED = 6
# Bayes's ln n of the region's pixels, times the pixels whose errors go together: materials are wrong patch by patch.
COST_PER_PARAMETER = 250.0
BESIDE_BODY_PX = 2
TURN_RAD = 0.03  # by which a line is turned to touch either end of a straight edge
FARTHEST_PX = 5e3


@dataclass(frozen=True, slots=True, eq=False)
class Costs:
    """What each pixel of a region costs as ground, shadow and object."""

    region: Region
    materials: Materials
    own: Float32  # (h, w) as the object

    def of(self, masks: Predicted) -> float:
        """Of all the ground in the region, each pixel taken for what the masks say."""
        cost = np.where(masks.shadow, self._shaded(masks), self.materials.lit)
        cost[masks.body] = self.own[masks.body]
        return float(cost[self.region.is_ground].sum())

    def gains(self, masks: Predicted, reach_px: float) -> Iterator[Float32]:
        """(h, w) how much less a pixel costs inside of the outline than outside: the body's, then each shadow's."""
        lit, layers = self.materials.lit, self.materials.layers
        beside_shadow = grown(masks.shadow, math.ceil(reach_px))
        yield np.where(beside_shadow, np.minimum(lit, self.materials.contact), lit) - self.own
        if not layers:
            yield lit - self.materials.contact
        else:
            first, second, both = layers
            for own, other, elsewhere in ((first, second, masks.parts[1]), (second, first, masks.parts[0])):
                yield np.where(elsewhere, other - both, lit - own)

    def _shaded(self, masks: Predicted) -> Float32:
        if not self.materials.layers:
            return self.materials.contact
        first, second, both = self.materials.layers
        one, other = masks.parts
        return np.where(one, np.where(other, both, first), second)


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A body in the picture, and what it costs there."""

    body: Body
    hulls_px: list[Float | None]  # (m, 2) the outlines of the body and of its shadows
    predicted: Predicted
    cost: float

    @property
    def object_px(self) -> float:
        """Square root of the body's area."""
        return math.sqrt(max(int(self.predicted.body.sum()), 30))


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """A body where the picture wants it, and how well it suits there."""

    placed: Placed
    normal: Float  # (2 l + q, 2 l + q) information on slants and shape
    missed_px: float  # root mean square by which borders are missed, outliers forgiven
    clear_body: float  # share of the body's outline that has a clear border; of what is known of it
    clear_shadow: float  # of the shadows' outlines


def aligned(bodies: Sequence[Body], costs: Costs) -> Alignment | None:
    """The body of those that suits the picture best, moved to the borders around it; None if it is not in view."""
    weighed = [_placed(body, costs) for body in bodies[:FAMILIES_WEIGHED]]
    best = here = min(weighed, key=criterion)
    for number, share in enumerate(REACHES):
        found = _borders(here, costs, share)
        if found is None:
            return None
        scale_px = _outlier_px(here) * (1.0 if number == len(REACHES) - 1 else FORGIVING)
        start, step = here.body, _step(here.body, *found, scale_px)
        for length in STEPS:
            here = _placed(start.moved(length * step), costs)
            if here.cost < best.cost:
                best = here
                break
    return _appraised(best, costs)


def criterion(placed: Placed) -> float:
    """Its cost, and what its parameters cost: the least is the likeliest."""
    return placed.cost + COST_PER_PARAMETER * len(placed.body.shape)


def _placed(body: Body, costs: Costs) -> Placed:
    hulls = outlines(body.proxy, body.to_lights_marker, costs.region.view)
    predicted = painted(hulls, costs.region.is_ground.shape)
    return Placed(body, hulls, predicted, costs.of(predicted))


def _outlier_px(placed: Placed) -> float:
    return max(OUTLIER_SHARE * placed.object_px, OUTLIER_PX)


def _appraised(best: Placed, costs: Costs) -> Alignment | None:
    found = _borders(best, costs, REACHES[-1])
    if found is None:
        return None
    borders, by_theta = found
    weight, normal = _weighed(best.body, borders, by_theta, _outlier_px(best))
    square = float(weight @ borders.away_px**2) / max(float(weight.sum()), 1e-9)
    clarity = borders.clarity[:PLACES], borders.clarity[PLACES:]
    return Alignment(best, normal, math.sqrt(square), *(_mean_of_known(each) for each in clarity))


def _mean_of_known(values: Float) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) > 2 else 0.0


def _step(body: Body, borders: Borders, by_theta: Float, scale_px: float) -> Float:
    """(2 l + q,) Gauss and Newton's, towards the borders."""
    weight, normal = _weighed(body, borders, by_theta, scale_px)
    diagonal = np.diag(normal)
    damped = normal + np.diag(DAMPING * diagonal + 1e-6 * diagonal.max() + 1e-12)
    step = np.linalg.solve(damped, by_theta.T @ (weight * borders.away_px))
    return np.asarray(np.clip(step, -LARGEST_STEP, LARGEST_STEP))


def _weighed(body: Body, borders: Borders, by_theta: Float, scale_px: float) -> tuple[Float, Float]:
    """(n,) what each border counts, those beyond `scale_px` less and less; and (2 l + q, 2 l + q) what all tell."""
    weight = borders.information / (1 + (borders.away_px / scale_px) ** 2)
    normal = (by_theta * weight[:, None]).T @ by_theta + np.diag(stiffness_of(body.family, body.slants.size))
    return weight, normal


def _borders(placed: Placed, costs: Costs, reach_share: float) -> tuple[Borders, Float] | None:
    """Borders around outlines, and (n, 2 l + q) how their places move outward with slants and shape.

    None of what is not, or endlessly large, in view.
    """
    places, found = [], []
    reach_px = max(reach_share * placed.object_px, LEAST_REACH_PX)
    trusted = ~costs.region.unreliable
    visible = np.ones_like(trusted)
    for hull, gain in zip(placed.hulls_px, costs.gains(placed.predicted, reach_px), strict=True):
        if hull is None or np.abs(hull).max() > FARTHEST_PX:
            return None
        places.append(evenly_spread(hull))
        found.append(borders_at(places[-1], gain, trusted, visible, reach_px))
        visible = ~grown(placed.predicted.body, BESIDE_BODY_PX)  # shadows go on behind the body
    by_theta = _slopes(placed.body, places)
    return (Borders.joined(found), by_theta) if np.isfinite(by_theta).all() else None


def _slopes(body: Body, places: Sequence[Places]) -> Float:
    """(n, 2 l + q) how places of outlines move outward with slants and shape.

    A straight edge moves as its two ends do, the parts that are touched by the edge's line turned a little.
    """
    split, count = body.slants.size, 2 * PLACES
    c, s = math.cos(TURN_RAD), math.sin(TURN_RAD)
    outward = np.concatenate([each.normals for each in places for _ in range(2)])
    ends = np.repeat(np.tile([-s, s], len(places)), PLACES)
    turned = c * outward + ends[:, None] * outward[:, ::-1] * (-1, 1)
    parts, by_shape = body.family.parts(body.shape[None])
    supports = outline_supports(body.guess.P[None], parts, body.slants[None], outward[None], turned[None])
    touched = by_shape[0].reshape(parts.shape[1], 5, -1)
    rows = []
    for number, each in enumerate(places):
        own = slice(number * count, (number + 1) * count)
        by_theta = np.zeros((count, split + len(body.shape)))
        by_part = supports.by_part[0, number, own][:, None]
        by_theta[:, split:] = (by_part @ touched[supports.part[0, number, own]])[:, 0]
        if number:
            by_theta[:, 2 * number - 2 : 2 * number] = supports.by_slant[0, number - 1, own]
        share = each.share[:, None]
        rows.append((1 - share) * by_theta[:PLACES] + share * by_theta[PLACES:])
    return np.concatenate(rows)
