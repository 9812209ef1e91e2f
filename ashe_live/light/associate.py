"""Which of the unlit areas are shadow, and which object belongs to it."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.ground import (
    LitGround,
    cleaned,
    clusters,
    large_areas,
    mixture,
    nearest_squared_distance,
    smoothed,
)
from ashe_live.light.log_colour import Float32
from ashe_live.light.shift import SHIFT_NOISE, shadow_shifts

LEAST_PX = 25
LEAST_AREA_PX = 60
OBJECT_COLOURS = 4
SMALL_PART = 0.05
SAME_SHARE = 0.03
BAND_PX = 4
SEAM_PX = 3
# Where a penumbra or a pixel's own width mixes lit and shadowed ground, and where the object hides part of the sky as
# well: shares of the shift, below and above the half at which the edge is drawn.
LIT_SHARES = (0.0, 0.25, 0.45)
SHADED_SHARES = (1.0, 0.55, 0.78, 1.25)
MIXED_COST = 2.0
MOST_COST = 40.0
# Squared distance from the shadow's colours beyond which a colour is surely the object's own.
SURELY_OWN = 12.0


@dataclass(frozen=True, slots=True)
class AssociateSteps:
    """How many explanations are tried."""

    shifts: int = 5
    shadows_per_shift: int = 2
    rounds: int = 2  # of learning colours and classifying by them


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """One explanation of an unlit area: an object, and the shadow that touches it."""

    object_mask: Mask  # (h, w)
    shadow_mask: Mask  # (h, w)
    shift: Float  # (3,) from the ground's colours to its shadowed ones, log-opponent

    @property
    def is_large_enough(self) -> bool:
        return bool(min(self.object_mask.sum(), self.shadow_mask.sum()) >= LEAST_PX // 2)

    def is_like(self, other: "Split") -> bool:
        """Whether hardly a pixel is explained otherwise."""
        differing = (self.object_mask != other.object_mask) | (self.shadow_mask != other.shadow_mask)
        total = np.count_nonzero(self.object_mask | self.shadow_mask)
        return bool(np.count_nonzero(differing) < SAME_SHARE * total)


def splits(ground: LitGround, unlit: Mask, is_ground: Mask, steps: AssociateSteps) -> list[Split]:
    """The explanations worth a fit, likeliest shift first."""
    found: list[Split] = []
    for shift in shadow_shifts(ground, unlit, steps.shifts):
        shadow_like = _shadow_like(ground, unlit, shift)
        for shadow in _areas_by_size(shadow_like, LEAST_PX)[: steps.shadows_per_shift]:
            for rough in _splits_with(shadow, shadow_like, unlit, shift):
                split = classified(ground.colours, ground, rough, is_ground, steps.rounds)
                if split.is_large_enough and not any(split.is_like(other) for other in found):
                    found.append(split)
    return found


def classified(colours: Float32, ground: LitGround, split: Split, is_ground: Mask, rounds: int) -> Split:
    """The split's pixels and those around them, each given to lit ground, shadow or object by likelihood.

    `colours` (h, w, 3) may be the ground's own or those of a window at another scale; the masks are of that size.
    Where two materials meet, the likelihoods change places half-way between their colours, which is where the edge is.
    """
    body, shadow = split.object_mask, split.shadow_mask
    band = _grown(body | shadow, BAND_PX) & is_ground
    banded = colours[band]
    lit = _ground_cost(banded, ground, split.shift, LIT_SHARES)
    shaded = _ground_cost(banded, ground, split.shift, SHADED_SHARES)
    lit_map, shaded_map = _cost_map(lit, band), _cost_map(shaded, band)
    surely_own = np.zeros(band.shape, dtype=bool)
    surely_own[band] = np.minimum(lit, shaded) - _floor(ground) > SURELY_OWN
    for _ in range(rounds):
        core = cv2.erode(body.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
        core &= surely_own
        own = colours[core if np.count_nonzero(core) > 60 else body & surely_own]
        if len(own) < LEAST_PX // 2:
            break
        labels, centres = clusters(own, OBJECT_COLOURS)
        centres, covariances, weights = mixture(own, labels, centres)
        if len(centres) == 0:
            break
        material = _cost(banded, centres, covariances, -2 * np.log(np.maximum(weights, 1e-3)))
        label_map = np.argmin([lit_map, shaded_map, _cost_map(material, band)], axis=0)
        body = _overlapping(cleaned(band & (label_map == 2)), body, 0.3)
        body = _filled(body)
        beside = _grown(body | shadow, 1)
        shadow = _overlapping(large_areas(cleaned(band & (label_map == 1) & ~body), LEAST_PX // 2), beside, 0.0)
        # Cleaning leaves a seam where the two meet; there, nothing shows where the shadow ends.
        shadow |= _grown(shadow, SEAM_PX) & _grown(body, SEAM_PX) & (label_map != 0) & ~body
        if not Split(body, shadow, split.shift).is_large_enough:
            break
    return Split(body, shadow, split.shift)


def _shadow_like(ground: LitGround, unlit: Mask, shift: Float) -> Mask:
    """The unlit pixels that look like some colour of the ground in shadow."""
    height, width = unlit.shape
    noise = np.broadcast_to(np.diag((1.3 * SHIFT_NOISE) ** 2), (len(ground.centres), 3, 3)).astype(np.float32)
    squared = nearest_squared_distance(ground.colours.reshape(-1, 3), ground.centres + shift.astype(np.float32), noise)
    return cleaned(unlit & (smoothed(np.exp(-0.5 * squared).reshape(height, width)) > 0.3))


def _splits_with(shadow: Mask, shadow_like: Mask, unlit: Mask, shift: Float) -> list[Split]:
    """What may be the object if `shadow` is its shadow: all the rest of the unlit area, or the part that touches it.

    Other places in the area that look like shadow may be more of it, as behind a handle, or the object's own dark side.
    """
    area = _overlapping(large_areas(unlit, LEAST_AREA_PX), shadow, 0.0)
    more = large_areas(area & shadow_like, LEAST_PX // 2) | shadow
    found = []
    for whole_shadow in (more, shadow):
        parts = _areas_by_size(cleaned(area & ~whole_shadow), LEAST_PX)
        reach = _grown(whole_shadow, 2)
        touching = [part for part in parts if (part & reach).any()]
        if touching:
            rest = np.any([part for part in parts if part.sum() > SMALL_PART * parts[0].sum()], axis=0)
            found += [Split(rest, whole_shadow, shift), Split(touching[0], whole_shadow, shift)]
    return found


def _areas_by_size(mask: Mask, least_px: int) -> list[Mask]:
    """The connected areas of `mask`, largest first."""
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    sizes = statistics[1:, cv2.CC_STAT_AREA]
    order = np.argsort(-sizes, kind="stable")
    return [labels == index + 1 for index in order if sizes[index] >= least_px]


def _overlapping(mask: Mask, other: Mask, least_share: float) -> Mask:
    """The connected areas of `mask` of which more than `least_share` lies in `other`; `mask` itself if none does."""
    _, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    sizes = np.bincount(labels.ravel())
    shared = np.bincount(labels[other & mask], minlength=len(sizes))
    kept = shared > least_share * sizes
    kept[0] = False
    return np.asarray(kept[labels], dtype=bool) if kept.any() else mask


def _grown(mask: Mask, by_px: int) -> Mask:
    kernel = np.ones((2 * by_px + 1, 2 * by_px + 1), np.uint8)
    return cv2.dilate(mask.astype(np.uint8), kernel).astype(bool)


def _filled(mask: Mask) -> Mask:
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    filled = np.zeros(mask.shape, np.uint8)
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.astype(bool)


def _ground_cost(colours: Float32, ground: LitGround, shift: Float, shares: tuple[float, ...]) -> Float32:
    """(n,) cost of being ground of which `shares` of the light that the shadow lacks are missing."""
    rarity = -2 * np.log(np.maximum(ground.weights, 1e-3))
    costs = []
    for share in shares:
        wider = ground.covariances * (1 + 0.5 * share)
        mixed = 0.0 if share in (0.0, 1.0) else MIXED_COST
        costs.append(_cost(colours, ground.centres + (share * shift).astype(np.float32), wider, rarity) + mixed)
    return np.asarray(np.min(costs, axis=0))


def _cost_map(costs: Float32, band: Mask) -> Float32:
    """(h, w) of costs (n,) in the band; without the cap, one odd pixel would outvote its neighbours."""
    picture = np.zeros(band.shape, np.float32)
    picture[band] = np.minimum(costs, MOST_COST)
    return smoothed(picture)


def _floor(ground: LitGround) -> float:
    """The cost of the ground's most common colour, exactly met."""
    spread = np.linalg.slogdet(ground.covariances.astype(np.float64))[1]
    return float((spread - 2 * np.log(np.maximum(ground.weights, 1e-3))).min())


def _cost(colours: Float32, centres: Float32, covariances: Float32, rarity: Float32) -> Float32:
    """(n,) twice the negative log likelihood of the likeliest component, up to a constant."""
    spread = np.linalg.slogdet(covariances.astype(np.float64))[1].astype(np.float32)
    return nearest_squared_distance(colours, centres, covariances, spread + rarity)
