"""Where a body of known shape and size stands: a search over places and turns in lights that the picture may show.

A wrong split into object and shadow fits no given size, and other objects may stand out more than the given one. But
with its size known, three unknowns (place and turn) say what every pixel shows in a given light: few enough to try all
places without any split.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, distinct
from ashe_live.core.caster import Caster
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.light.explanation.explain import FittedProposal, aligned_explanations, proposal_of
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.normal_equations import PlacedBody, placed_in
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import Materials, materials_of
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.mixtures import UNEXPLAINED
from ashe_live.light.shape.body import Body, BodyFrame, LitBody
from ashe_live.light.shape.known import family_of, unit_m
from ashe_live.light.shape.light_points import cast_on_ground
from ashe_live.light.shape.sight import Sight

SEARCH_PX = 130  # size to which the whole picture is scaled
# Places tried in each light, or up to twice as many; bodies painted there; bodies aligned, in all lights.
FEET, PAINTED, FOUND = 400, 60, 12
# Places of a body's points about their middle, as fractions: inside of its silhouette, and of its shadow's.
INSIDE = (0.85, 0.5)
# Cost of an object's pixel before its colours are known: midway between the likeliest ground and none at all.
ANY_OBJECT = UNEXPLAINED / 2
AROUND_PX = 3
CELL = 0.5  # side of the squares of ground in each of which one place is painted, over the body's radius
APART = 0.35  # of the body's radius: places nearer than this, in much the same light, end in the same alignment
SAME_LIGHT = 0.97  # cosine


@dataclass(frozen=True, slots=True, eq=False)
class Hint:
    """A light that the picture may show, by whatever object."""

    light: Float  # (4,) homogeneous point, marker frame, scaled to a unit vector (x, y, z)
    shift: Float  # (3,) of the ground's colours where it is blocked


def hints_of(explanations: Iterable[Explanation], count: int) -> list[Hint]:
    """The lights of explanations, the likeliest first, without those like an earlier one's; `count` at most."""
    hints = (
        Hint(light.light, shift) for each in explanations for light, shift in zip(each.lights, each.shifts, strict=True)
    )
    return distinct(hints, lambda hint, other: bool(hint.light[:3] @ other.light[:3] >= SAME_LIGHT), count)


def explanations_by_place(
    caster: Caster, hints: Sequence[Hint], view: SceneView, unlit: Mask, region_px: int
) -> list[Explanation]:
    """The caster where it explains the picture best in one of the lights of `hints`, aligned; FOUND places at most.

    unlit: (h, w) of the coarse view, pixels that the lit ground does not explain. region_px: size in pixels to which a
    region is scaled.
    """
    if not unlit.any():
        return []
    whole = view.region(unlit, SEARCH_PX)
    feet = _feet(whole)
    if not len(feet):
        return []
    several = [(hint, materials_of(whole, view.ground, hint.shift)) for hint in hints]
    placed = [
        (hint, one) for hint, materials in several for one in _likely_places(caster, hint, whole, materials, feet)
    ]
    starts = (_start(one.lit, hint, view, region_px) for hint, one in _different(placed, caster))
    return [found for found in aligned_explanations([each for each in starts if each is not None]) if found is not None]


def _feet(whole: Region) -> Float:
    """(n, 2) places on the ground, metres, marker frame, that the picture shows where something stands out."""
    rows, columns = np.nonzero(whole.unlit)
    every = max(1, len(rows) // FEET)
    pixels = np.column_stack([columns, rows])[::every]
    places = raycast_to_plane(whole.view.camera, whole.view.T_cam_marker, pixels)[:, :2]
    return np.asarray(places[np.isfinite(places).all(axis=1)])


def _likely_places(
    caster: Caster, hint: Hint, whole: Region, materials: Materials, feet: Float
) -> Iterator[PlacedBody]:
    """The caster, painted where it explains points of its silhouette and of its shadow's best."""
    family, unit = family_of(caster), unit_m(caster)
    as_object = np.full(materials.lit.shape, ANY_OBJECT, np.float32)
    of_body = _gain(materials.lit - as_object, whole)
    of_shadow = _gain(materials.lit - materials.contact, whole)
    P = Sight.of(whole.view).P_marker
    bodies: list[LitBody] = []
    scores: list[Float] = []
    for shape in family.starts(np.zeros(5)):
        points = Body(BodyFrame(np.zeros(2), unit), family, shape).proxy.points_marker(8)
        middle = points.mean(axis=0)
        inside = np.concatenate([middle + share * (points - middle) for share in INSIDE])
        shadow = cast_on_ground(inside, hint.light)
        if shadow is None:
            continue
        scores.append(_sampled(of_body, P, feet, inside) + _sampled(of_shadow, P, feet, shadow))
        bodies += [LitBody(Body(BodyFrame(foot, unit), family, shape), hint.light[None]) for foot in feet]
    if not bodies:
        return
    costs, sight = Costs(whole, materials, as_object), Sight.of(whole.view)
    best = _best_of_cells(np.concatenate(scores), np.tile(feet, (len(scores), 1)), CELL * caster.radius_m)
    yield from placed_in([(bodies[i], sight, costs) for i in best[:PAINTED]])


def _best_of_cells(scores: Float, feet: Float, side_m: float) -> list[int]:
    """Of the feet (n, 2) in each square of the ground the one of the highest score (n,), the highest first."""
    order = np.argsort(-scores, kind="stable")
    _, first = np.unique(np.floor(feet[order] / side_m), axis=0, return_index=True)
    return list(order[np.sort(first)])


def _gain(gain: Float32, whole: Region) -> Float32:
    """(h, w) what a label saves at each pixel that shows ground or what stands on it, 0 elsewhere."""
    return np.asarray(np.where(whole.is_ground, gain, 0), dtype=np.float32)


def _sampled(gain: Float32, P: Float, feet: Float, points: Float) -> Float:
    """(n,) mean gain at points (k, 3) about each of the feet (n, 2)."""
    image = points @ P[:, :3].T + P[:, 3]
    seen = image[None] + (feet @ P[:, :2].T)[:, None]
    columns, rows = (np.round(seen[..., i] / np.maximum(seen[..., 2], 1e-9)) for i in (0, 1))
    height, width = gain.shape
    in_view = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height) & (seen[..., 2] > 0)
    at = np.where(in_view, rows * width + columns, 0).astype(np.intp)
    return np.asarray(np.where(in_view, gain.reshape(-1)[at], 0).mean(axis=1), dtype=np.float64)


def _different(several: Sequence[tuple[Hint, PlacedBody]], caster: Caster) -> list[tuple[Hint, PlacedBody]]:
    """The FOUND places that agree with the picture best, none of them next to another one in the same light."""

    def are_alike(one: tuple[Hint, PlacedBody], other: tuple[Hint, PlacedBody]) -> bool:
        place, there = (body.lit.body.frame.origin_marker for _, body in (one, other))
        return one[0] is other[0] and bool(np.linalg.norm(place - there) <= APART * caster.radius_m)

    return distinct(sorted(several, key=lambda each: _agreement(each[1]), reverse=True), are_alike, FOUND)


def _agreement(one: PlacedBody) -> float:
    """How far the pixels of the body, of its shadow and of the ground just around them look like these: 3 if all do.

    They count as shares of each area: a sum would favour larger and darker things than the body.
    """
    costs, masks = one.costs, one.predicted
    region = costs.region
    around = grown(masks.whole, AROUND_PX) & ~masks.whole
    looks = (
        (masks.body, region.unlit),
        (masks.shadow, costs.materials.contact < costs.materials.lit),
        (around, ~region.unlit),
    )
    return sum(float(look[seen].mean()) for mask, look in looks if (seen := mask & region.is_ground).any())


def _start(lit: LitBody, hint: Hint, view: SceneView, region_px: int) -> FittedProposal | None:
    """The body as the start of an alignment, in a region of its own; None where it is not in view."""
    seen = view.ground_under(lit)
    if not seen.any():
        return None
    region = view.region(seen, region_px)
    return proposal_of(lit, region, materials_of(region, view.ground, hint.shift))
