"""The selection of the splits of regions that are worth a fit."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from ashe_live.core.arrays import Float, Mask, distinct, once_for_each
from ashe_live.light.explanation.explain import Proposal
from ashe_live.light.explanation.judgement.judge import Judge
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import SHIFT_NOISE, shift_within
from ashe_live.light.labels.associate import (
    Split,
    are_like_areas,
    areas_of_one_colour,
    flat_areas,
    separate_objects,
    shadow_like,
    splits,
    with_near_shadow_undecided,
)
from ashe_live.light.labels.materials import Materials, materials_of, with_other_ground
from ashe_live.light.labels.two_lights import (
    are_two_shadows,
    cost_reduction,
    likeliest_pairs,
    materials_of_each,
    separated_shadows,
)
from ashe_live.light.views.joint.log_odds import plane_support

SHADOWS_PER_SHIFT = 2  # number of areas that are tried as the shadow, the largest first
# Splits in which what is nearly lit ground, or looks like a paler shadow, belongs to no object are tried too, by the
# shifts with the most votes, where it is at least this fraction of the unlit pixels.
LIKELY_SHIFTS, LEAST_OTHER = 4, 0.03
PALER = SHIFT_NOISE[0]  # in log brightness, by which one shadow must be paler than another, beyond noise
PAIRS, PAIRS_TRIED = 1, 1  # number of pairs of two lights' shifts that are split, and of such splits that are fitted
PARTED = 3  # number of the best-looking splits whose objects, if they are several, are each tried alone


def proposals_of(
    region: Region, ground: LitGround, shifts: Sequence[Float], paired: Sequence[Float]
) -> Iterator[Proposal]:
    """The region's splits for each of `shifts` (3,), and for two lights whose shifts are among `paired` (3,)."""
    flat = flat_areas(region)
    alone = [materials_of(region, ground, shift) for shift in shifts]
    tried = [(materials, shadow_like(region, ground, materials.shifts)) for materials in alone]
    likely = tried[:LIKELY_SHIFTS]
    faint = region.faint
    if faint is not None and np.count_nonzero(faint) > LEAST_OTHER * np.count_nonzero(region.unlit):
        tried += [(with_other_ground(materials, faint), look) for materials, look in likely]
    tried += _beside_paler_shadows(region, likely)
    tried += list(_within_areas_of_one_colour(region, ground, tried))
    pairs = likeliest_pairs(region, ground, paired, PAIRS)
    both = (materials_of_each(region, ground, [paired[i], paired[j]]) for i, j in pairs)
    tried += [(each, shadow_like(region, ground, each.shifts)) for each in both if each is not None]
    for materials, look in tried:
        yield from _proposed(region, materials, splits(region, materials, look, SHADOWS_PER_SHIFT, flat))


def _beside_paler_shadows(
    region: Region, several: Sequence[tuple[Materials, Mask]]
) -> Iterator[tuple[Materials, Mask]]:
    """Each of `several` where what only a paler one's shadow explains is ground that another light does not reach.

    several: with what looks like their shadows, (h, w).
    """
    least = LEAST_OTHER * np.count_nonzero(region.unlit)
    for (materials, own), (paler, look) in permutations(several, 2):
        if paler.shift[0] > materials.shift[0] + PALER:
            other = look & ~own
            if np.count_nonzero(other) > least:
                yield with_other_ground(materials, other), own


def _within_areas_of_one_colour(
    region: Region, ground: LitGround, several: Sequence[tuple[Materials, Mask]]
) -> Iterator[tuple[Materials, Mask]]:
    """Areas of one colour, with the materials of the shift that they have if they are shadow.

    several: what has been tried, of which materials are taken where their shift is the same; with its shadows, (h, w).
    """
    # Before surroundings all have other ground, so that each area keeps the shift that it has itself.
    known = [materials for materials, _ in several if materials.other_ground is None]
    for area, shift in _areas_with_shifts(region, ground):
        if any(are_like_areas(area, look) for _, look in several):
            continue
        if shift is not None and shift[0] < -PALER:
            same = (each for each in known if np.abs((each.shift - shift) / SHIFT_NOISE).max() < 1)
            materials = next(same, None) or materials_of(region, ground, shift)
            known.append(materials)
            yield materials, area


@once_for_each
def _areas_with_shifts(region: Region, ground: LitGround) -> list[tuple[Mask, Float | None]]:
    """(h, w) each: the region's areas of one colour, with the shift (3,) that each has if it is shadow."""
    return [(area, shift_within(region.colours[area], ground)) for area in areas_of_one_colour(region)]


def _proposed(region: Region, materials: Materials, found: Sequence[Split]) -> Iterator[Proposal]:
    """Each split by itself; by one light also with the shadow near the object in doubt, by two if both show."""
    for whole in found:
        split = replace(whole, parts=separated_shadows(materials, whole.shadow_mask))
        if materials.lights == 2:
            if are_two_shadows(split.parts):
                yield Proposal(region, materials, split)
            continue
        yield Proposal(region, materials, split)
        doubtful = with_near_shadow_undecided(split)
        if doubtful is not None:
            yield Proposal(region, materials, doubtful)


def selected_for_fit(proposals: Sequence[Proposal], count: int, judge: Judge) -> list[Proposal]:
    """The `count` best-looking different proposals by one light, then the PAIRS_TRIED best by two.

    If the object of one of the best is several objects, those of each by itself are among them: alone, an object that
    stands in another's shadow looks worse than both together, as it leaves the other unexplained.
    """
    alone = [proposal for proposal in proposals if proposal.materials.lights == 1]
    together = [proposal for proposal in proposals if proposal.materials.lights == 2]

    by_colours: dict[tuple[int, int], float] = {}

    def score(one: Proposal) -> float:
        region, split = one.region, one.split
        # A split and its variant with the shadow in doubt share the object's mask, and have the same score by colours.
        key = id(one.materials), id(split.object_mask)
        if key not in by_colours:
            by_colours[key] = judge.split_score(region, one.materials, split)
        return by_colours[key] + plane_support(region, split.object_mask, split.shadow_mask)

    alone.sort(key=score, reverse=True)
    together.sort(key=lambda one: cost_reduction(one.region, one.materials, one.split), reverse=True)
    best = distinct(alone, Proposal.is_like, count)
    parts = [part for one in best[:PARTED] for part in _of_each_object(one, alone)]
    chosen = distinct([*best[:PARTED], *parts, *best[PARTED:]], Proposal.is_like, count)
    return chosen + together[:PAIRS_TRIED]


def _of_each_object(several: Proposal, ranked: Sequence[Proposal]) -> Iterator[Proposal]:
    """The best-looking proposal, by the same materials, of each of the objects that the object of `several` is.

    What has no shadow of its own is a part of an object.
    """
    alike = [one for one in ranked if one.materials is several.materials and one.split.undecided is None]
    for mask in separate_objects(several.split):
        alone = next((one for one in alike if are_like_areas(one.split.object_mask, mask)), None)
        if alone is not None and not are_like_areas(alone.split.shadow_mask, several.split.shadow_mask):
            yield alone
