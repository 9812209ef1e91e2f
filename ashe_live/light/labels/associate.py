"""Association: which of a region's unlit areas may be shadow, and which object may have cast it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Mask, distinct
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import SHIFT_NOISE
from ashe_live.light.labels.materials import Materials, object_cost
from ashe_live.light.pixels.areas import (
    areas_by_size,
    distance_to,
    filled,
    grown,
    large_areas,
    majority,
    mean_nearby,
    overlapping,
    shrunk,
    smoothed,
    thick,
)
from ashe_live.light.pixels.mixtures import clusters, nearest_squared_distance

LEAST_PX = 14  # of an area that is tried as the shadow, or as an object in parts
LEAST_OBJECT_PX, LEAST_SHADOW_PX = 12, 8  # of the masks of a split
LEAST_AREA_PX = 30  # of an unlit area that is tried as the object
SMALL_PART = 0.05  # of an object's largest part: smaller ones are left out
OBJECTS, LESSER_OBJECT = 3, 0.1  # number of objects side by side, and their least area as a fraction of the largest
SAME_SHARE = 0.12  # two splits are alike if fewer than this fraction of their pixels differ
ROUNDS = 2  # of reassigning pixels to their cheapest label
SEAM_PX = 5  # least width of what is shadow along the object's border, not a mixture of its colours with lit ground's
REACH_PX = 3  # around object and shadow, within which pixels are reassigned
# The depth of one light's shadow varies, in units of its shift: in a penumbra, and where the object hides the sky too.
DEPTHS = (0.6, 0.8, 1.0, 1.2, 1.4)
# Least similarity of a pixel, smoothed, to shadowed ground: exp(-d²/2), d its distance to the nearest colour of that in
# units of WIDENED_NOISE times the shifts' noise. d² is clipped at FARTHEST, beyond any effect, to avoid underflow.
SHADOW_LIKE, WIDENED_NOISE, FARTHEST = 0.3, 1.2, 50.0
# Numbers of clusters that unlit colours are parted into, and of each one's areas that are tried as a shadow.
COLOUR_COUNTS, AREAS_PER_COLOUR = (2, 3), 2
# Number of colours whose areas are looked at one by one. An area is flat if its pixels' log odds of lying on the plane,
# of which so many pixels count as one sample, add up to more than FLAT_ODDS, and if less than the share FLAT_ABOVE of
# its pixels has log odds below ABOVE, as what stands above the plane has.
FLAT_COLOURS, FLAT_ODDS, PIXELS_PER_SAMPLE, ABOVE, FLAT_ABOVE = 6, 1.5, 40.0, -0.7, 0.03
# Fraction of the shadow's largest distance from the object beyond which a pixel that looks like shadow cannot be the
# object's own dark side.
SURELY_SHADOW = 0.6


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """A division of an unlit area into an object, the shadow that touches it, and pixels that may be of either one."""

    object_mask: Mask  # (h, w)
    shadow_mask: Mask  # (h, w)
    undecided: Mask | None = None  # (h, w)
    parts: tuple[Mask, ...] = ()  # (h, w) each light's shadow, if there are two lights; empty for one

    @property
    def shadows(self) -> tuple[Mask, ...]:
        """(h, w) the shadow of each light."""
        return self.parts or (self.shadow_mask,)

    @property
    def whole(self) -> Mask:
        """(h, w) all of the area."""
        taken = self.object_mask | self.shadow_mask
        return taken if self.undecided is None else taken | self.undecided

    @property
    def is_large_enough(self) -> bool:
        return bool(
            np.count_nonzero(self.object_mask) >= LEAST_OBJECT_PX
            and np.count_nonzero(self.shadow_mask) >= LEAST_SHADOW_PX
        )

    def is_like(self, other: "Split") -> bool:
        """Whether few pixels are labelled differently. Both splits must be of one region."""
        if (self.undecided is None) != (other.undecided is None):
            return False
        differing = (self.object_mask != other.object_mask) | (self.shadow_mask != other.shadow_mask)
        return bool(np.count_nonzero(differing) < SAME_SHARE * np.count_nonzero(self.whole))


def splits(
    region: Region, materials: Materials, like_shadow: Mask, shadows_tried: int, flat: Mask | None = None
) -> list[Split]:
    """The candidate divisions of the region's unlit areas into object and shadow, given the shift of `materials`.

    like_shadow: (h, w) the pixels that may be shadow, as `shadow_like` finds them. shadows_tried: number of areas, the
    largest first, that are each taken for the shadow. flat: (h, w) what lies on the plane, and is no object.
    """
    unlit = region.unlit if flat is None else region.unlit & ~flat
    if materials.other_ground is not None:
        unlit = unlit & ~materials.other_ground
    shadows, unlit = areas_by_size(like_shadow, LEAST_PX), large_areas(unlit | like_shadow, LEAST_AREA_PX)
    roughs = [rough for shadow in shadows[:shadows_tried] for rough in _splits_with(shadow, like_shadow, unlit)]
    refined = (_classified(region, materials, rough) for rough in distinct(roughs, Split.is_like))
    return distinct((split for split in refined if split.is_large_enough), Split.is_like)


def with_near_shadow_undecided(split: Split) -> Split | None:
    """The same split with only the far part of the shadow certain: the near part may be the object's own dark side.

    That part becomes `undecided`. None where too little certain shadow remains.
    """
    away = distance_to(split.object_mask)
    surely = split.shadow_mask & (away > SURELY_SHADOW * away[split.shadow_mask].max())
    doubtful = Split(split.object_mask, surely, split.shadow_mask & ~surely)
    return doubtful if doubtful.is_large_enough else None


def separate_objects(split: Split) -> list[Mask]:
    """(h, w) each: the parts of the split's object, the largest first; none where it has no second part of any size."""
    parts = areas_by_size(split.object_mask, LEAST_PX)[:OBJECTS]
    large = [part for part in parts if np.count_nonzero(part) > LESSER_OBJECT * np.count_nonzero(parts[0])]
    return large if len(large) > 1 else []


def areas_of_one_colour(region: Region) -> list[Mask]:
    """(h, w) each: unlit areas of one colour, by K-means, as the paper finds its shadows.

    An object that looks like ground in shadow differs from its own shadow in colour alone. Each colour counts once,
    however many pixels have it, so that a small shadow gets a cluster too.
    """
    unlit, quantised = large_areas(region.unlit, LEAST_PX), region.quantised
    cells = np.unique(quantised.cell[unlit])
    found: list[Mask] = []
    for count in (each for each in COLOUR_COUNTS if each <= len(cells)):
        cluster = np.full(len(quantised.colours), count)
        cluster[cells] = clusters(quantised.colours[cells], count)[0]
        labels = cluster[quantised.cell]
        for colour in range(count):
            found += areas_by_size(majority((labels == colour) & unlit), LEAST_PX)[:AREAS_PER_COLOUR]
    return distinct(found, are_like_areas)


def are_like_areas(one: Mask, other: Mask) -> bool:
    """Whether two areas (h, w) differ in few of their pixels."""
    return bool(np.count_nonzero(one ^ other) < SAME_SHARE * np.count_nonzero(one | other))


def flat_areas(region: Region) -> Mask | None:
    """(h, w) unlit areas of one colour that other views confirm to lie on the plane: paint, paper, or shadow.

    Only the border of an area shows whether it moves (the aperture problem), so areas are judged whole. None where
    there are no other views.
    """
    if region.on_plane is None:
        return None
    labels = clusters(region.quantised.colours, FLAT_COLOURS)[0].astype(np.uint8)[region.quantised.cell]
    flat = np.zeros_like(region.unlit)
    for colour in range(FLAT_COLOURS):
        for area in areas_by_size(majority((labels == colour) & region.unlit), LEAST_AREA_PX):
            odds = region.on_plane[grown(area, 1)]
            if odds.sum() > FLAT_ODDS * PIXELS_PER_SAMPLE and (odds < ABOVE).mean() < FLAT_ABOVE:
                flat |= area
    return flat


def shadow_like(region: Region, ground: LitGround, shifts: Sequence[Float]) -> Mask:
    """(h, w) the unlit pixels that look like one of the ground's colours in a shadow of one of `shifts` (3,)."""
    lit, noise = ground.palette.centres, np.diag((WIDENED_NOISE * SHIFT_NOISE) ** 2).astype(np.float32)
    shaded = np.concatenate([lit + (depth * shift).astype(np.float32) for shift in shifts for depth in DEPTHS])
    squared = nearest_squared_distance(region.quantised.colours, shaded, noise)
    likeness = np.exp(-0.5 * np.minimum(squared, FARTHEST))
    return majority(region.unlit & (smoothed(region.quantised.as_picture(likeness)) > SHADOW_LIKE))


def _splits_with(shadow: Mask, like_shadow: Mask, unlit: Mask) -> list[Split]:
    """Candidates for the object if `shadow` is its shadow: all the rest of the unlit area, or one part that touches it.

    If there are several objects, each gets the shadows that touch it. Other areas that look like shadow are tried both
    as more of the shadow (behind a handle, for example) and as the object's own dark side.
    """
    area = overlapping(unlit, shadow, 0.0)
    more = large_areas(area & like_shadow, LEAST_OBJECT_PX) | shadow
    found = []
    for whole_shadow in (more, shadow) if (more & ~shadow).any() else (shadow,):
        parts = areas_by_size(majority(area & ~whole_shadow), LEAST_PX)
        reach = grown(whole_shadow, 2)
        touching = [part for part in parts if (part & reach).any()]
        if touching:
            rest = np.any(
                [part for part in parts if np.count_nonzero(part) > SMALL_PART * np.count_nonzero(parts[0])], axis=0
            )
            found.append(Split(rest, whole_shadow))
            if len(parts) > 1:
                large = [part for part in touching[:OBJECTS] if part.sum() > LESSER_OBJECT * touching[0].sum()]
                found += [Split(part, overlapping(whole_shadow, grown(part, 2), 0.0)) for part in large]
    return found


def _classified(region: Region, materials: Materials, rough: Split) -> Split:
    """The split after ROUNDS of giving each pixel its cheapest label, the object's colours being learned anew."""
    split = rough
    for _ in range(ROUNDS):
        split = _reassigned(region, materials, split)
        if not split.is_large_enough:
            break
    return split


def _reassigned(region: Region, materials: Materials, rough: Split) -> Split:
    """The split's pixels and those around them, each labelled lit ground, shadow or object, whichever costs least.

    Where two materials meet, their costs are equal half-way between their colours, which is where the edge is.
    """
    core = _core(rough.object_mask)
    as_object = object_cost(region, core, materials)
    if region.on_plane is not None:
        # What an object shows stands above the plane. Twice the log odds, as costs are twice negative logs.
        as_object = as_object + 2 * region.on_plane
    nearby = grown(rough.object_mask | rough.shadow_mask, REACH_PX) & region.is_ground
    like_object = majority((as_object < np.minimum(materials.lit, materials.shaded)) & nearby, 5)
    body = filled(overlapping(like_object, core) if (like_object & core).any() else core)
    like_shadow = majority((materials.shaded < materials.lit) & (materials.shaded <= as_object) & nearby) & ~body
    shadow = overlapping(like_shadow, rough.shadow_mask)
    seam = _seam(region, body, shadow)
    return Split(body | (seam & (as_object < materials.lit)), shadow & ~seam)


def _seam(region: Region, body: Mask, shadow: Mask) -> Mask:
    """(h, w) what of the shadow is a narrow strip beside a darker object; nothing where that leaves too little shadow.

    Where a dark object's colours mix with lit ground's, they pass through those of a shadow between the two.
    """
    narrow = shadow & ~grown(thick(shadow, SEAM_PX), 1) & grown(body, SEAM_PX)
    brightness = np.asarray(region.colours[..., 0], dtype=np.float32)
    seam = large_areas(narrow & (brightness > mean_nearby(brightness, body, SEAM_PX)), LEAST_PX)
    return seam if large_areas(shadow & ~seam, LEAST_SHADOW_PX).any() else np.zeros_like(seam)


def _core(mask: Mask) -> Mask:
    """The mask without its rim, where colours mix; a small mask keeps as much of the rim as it needs."""
    for margin_px in (2, 1):
        core = shrunk(mask, margin_px)
        if np.count_nonzero(core) >= LEAST_PX:
            return core
    return mask
