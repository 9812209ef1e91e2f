"""A hole in a picture of the ground, filled by what lies around it.

Patches are filled from the outside inwards by those patches of visible ground that continue what is known already
(Criminisi, Perez, Toyama, "Region filling and object removal by exemplar-based image inpainting", IEEE Trans. Image
Processing 2004). What difference is left at the hole's border is spread over its inside as smoothly as can be (Perez,
Gangnet, Blake, "Poisson image editing", SIGGRAPH 2003).
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask

COARSE_SIDE_PX = 26.0  # of the marker where patches are looked for
PATCH = 15  # coarse pixels a side
STEP = 7  # coarse pixels between the patches of the hole, which overlap
# Beside the hole, in the marker's sides: ground that the picture's coarse colours and sharpening have not mixed with
# what lies in it.
BLEED_SIDES, BESIDE_SIDES = 0.06, 0.16
AROUND_SIDES = 0.5  # of the hole: ground that tells which colours ground has
# Beyond the range of those: of the brightest, and of a channel's share in a colour, both of roots of linear RGB.
UNLIKE, UNLIKE_HUE = 0.12, 0.03
FIELD = 128  # cells a side in which the difference at the border is spread
SMOOTH_ROUNDS = 100  # of relaxing it


def filled(lit: Float32, hole: Mask, is_source: Mask, side_px: float) -> Float32 | None:
    """(n, n, 3) `lit`, linear RGB, with the hole (n, n) filled; None where no patch of ground is seen whole.

    is_source: (n, n) ground that may be copied. side_px: the marker's side.
    """
    size = max(PATCH + 2, round(len(hole) * COARSE_SIDE_PX / side_px))
    # Roots: dark and bright patches are compared alike.
    roots = np.sqrt(np.clip(lit, 0, 4)).astype(np.float32)
    coarse = np.asarray(cv2.resize(roots, (size, size), interpolation=cv2.INTER_AREA), np.float32)
    bleeds = cv2.distanceTransform((~hole).astype(np.uint8), cv2.DIST_L2, 5) < BLEED_SIDES * side_px
    unknown = cv2.resize(bleeds.astype(np.float32), (size, size), interpolation=cv2.INTER_AREA) > 0.02
    whole = cv2.resize((is_source & ~bleeds).astype(np.float32), (size, size), interpolation=cv2.INTER_AREA) > 0.98
    whole &= _like_the_ground_around(coarse, whole, unknown)
    sources = cv2.erode(whole.astype(np.uint8), np.ones((PATCH, PATCH)), borderValue=0) > 0
    if not sources.any() or not unknown.any():
        return None
    pasted, weight = np.zeros_like(roots), np.zeros(hole.shape, np.float32)
    scale = len(hole) / size
    trusted = (is_source & ~bleeds).astype(np.float32)
    for place, source in _patches(coarse, unknown, whole, sources):
        _paste(pasted, weight, roots, trusted, place, source, scale)
    filled = np.where(hole[..., None] & (weight[..., None] > 0), pasted / np.maximum(weight, 1e-9)[..., None], roots)
    return np.square(filled + _spread_difference(roots, pasted, weight, hole, is_source, side_px))


def _like_the_ground_around(coarse: Float32, known: Mask, unknown: Mask) -> Mask:
    """(m, m) whose colour occurs beside the unknown part: not objects, whether an estimate knows of them or not.

    coarse: (m, m, 3) roots of linear RGB.
    """
    away = cv2.distanceTransform((~unknown).astype(np.uint8), cv2.DIST_L2, 5)
    beside = known & (away < AROUND_SIDES * COARSE_SIDE_PX)
    if not beside.any():
        return known
    smooth = cv2.GaussianBlur(coarse, (0, 0), 1.0)
    low, high = np.percentile(smooth[beside], (2, 98), axis=0)
    margin = UNLIKE * float(high.mean())
    alike = ((smooth > low - margin) & (smooth < high + margin)).all(axis=2)
    # Hues, too: a grey object may be as bright as the ground.
    hues = smooth / np.maximum(smooth.sum(axis=2, keepdims=True), 1e-3)
    low, high = np.percentile(hues[beside], (2, 98), axis=0)
    return np.asarray(alike & ((hues > low - UNLIKE_HUE) & (hues < high + UNLIKE_HUE)).all(axis=2))


def _patches(coarse: Float32, unknown: Mask, known: Mask, sources: Mask) -> list[tuple[Float, Float]]:
    """Middles (row, column) of coarse patches to fill and of those to copy, in the order of filling."""
    reach = PATCH // 2
    picture, known, left = coarse.copy(), known.copy(), unknown.copy()
    found: list[tuple[Float, Float]] = []
    size = len(unknown)
    places = [
        (row, column)
        for row in range(reach, size - reach, STEP)
        for column in range(reach, size - reach, STEP)
        if unknown[_window(row, column)].any()
    ]
    while places and left.any():
        place = max(places, key=lambda each: known[_window(*each)].sum())
        places.remove(place)
        window = _window(*place)
        mask = known[window]
        if mask.any():
            masked = np.repeat(mask[..., None].astype(np.float32), 3, axis=2)
            misfit = cv2.matchTemplate(picture, picture[window], cv2.TM_SQDIFF, mask=masked)
            misfit = np.where(sources[reach:-reach, reach:-reach], misfit, np.inf)
            at = np.unravel_index(int(np.argmin(misfit)), misfit.shape)
            source = (int(at[0]) + reach, int(at[1]) + reach)
        else:
            rows, columns = np.nonzero(sources)
            source = int(rows[len(rows) // 2]), int(columns[len(rows) // 2])
        new = ~mask
        picture[window][new] = coarse[_window(*source)][new]
        known[window] = True
        left[window] = False
        found.append((np.array(place, float), np.array(source, float)))
    return found


def _window(row: int, column: int) -> tuple[slice, slice]:
    """A coarse patch by its middle."""
    reach = PATCH // 2
    return slice(row - reach, row + reach + 1), slice(column - reach, column + reach + 1)


def _paste(
    pasted: Float32, weight: Float32, roots: Float32, trusted: Float32, place: Float, source: Float, scale: float
) -> None:
    """Adds a patch of the fine picture, moved to where it fits best, with weights that fall off towards its border.

    trusted: (n, n) 1 on visible ground, else 0.
    """
    n, reach, play = len(weight), round(PATCH / 2 * scale), round(scale)
    middle, origin = (np.round((each + 0.5) * scale).astype(int) for each in (place, source))
    low = np.maximum(middle - reach, 0)
    high = np.minimum(middle + reach, n)
    to = (slice(low[0], high[0]), slice(low[1], high[1]))
    begin = np.maximum(origin - (middle - low) - play, 0)
    end = np.minimum(origin + (high - middle) + play, n)
    region = roots[begin[0] : end[0], begin[1] : end[1]]
    size = high - low
    if (np.array(region.shape[:2]) < size).any():
        return
    known = weight[to] > 0
    there = np.where(known[..., None], pasted[to] / np.maximum(weight[to], 1e-9)[..., None], roots[to])
    mask = np.maximum(known.astype(np.float32), trusted[to])
    at = origin - (middle - low) - begin
    if mask.any():
        misfit = cv2.matchTemplate(region, there, cv2.TM_SQDIFF, mask=np.repeat(mask[..., None], 3, axis=2))
        at = np.array(np.unravel_index(int(np.argmin(misfit)), misfit.shape))
    rows, columns = (
        np.cos((np.arange(low[k], high[k]) - middle[k] + 0.5) / reach * (np.pi / 2) * 0.98) ** 4 for k in (0, 1)
    )
    share = np.outer(rows, columns).astype(np.float32)
    pasted[to] += share[..., None] * region[at[0] : at[0] + size[0], at[1] : at[1] + size[1]]
    weight[to] += share


def _spread_difference(
    roots: Float32, pasted: Float32, weight: Float32, hole: Mask, is_source: Mask, side_px: float
) -> Float32:
    """(n, n, 3) what is to be added inside the hole: at its border the difference to the ground beside it, harmonic."""
    size = FIELD
    near = hole.astype(np.uint8)
    beside = cv2.distanceTransform(1 - near, cv2.DIST_L2, 5) / side_px
    ring = (beside > BLEED_SIDES) & (beside < BESIDE_SIDES) & is_source & (weight > 0)
    difference = np.where(ring[..., None], roots - pasted / np.maximum(weight, 1e-9)[..., None], 0).astype(np.float32)
    share = cv2.resize(ring.astype(np.float32), (size, size), interpolation=cv2.INTER_AREA)
    sums = cv2.resize(difference, (size, size), interpolation=cv2.INTER_AREA)
    fixed = share > 0.05
    value = np.where(fixed[..., None], sums / np.maximum(share, 1e-6)[..., None], 0).astype(np.float32)
    trusted = fixed.astype(np.float32)
    # From coarse to fine: a start by ever wider means, then Laplace's equation relaxed.
    start, seen = value * trusted[..., None], trusted.copy()
    for sigma in (1, 2, 4, 8, 16, 32):
        wide = cv2.GaussianBlur(value * trusted[..., None], (0, 0), sigma)
        much = cv2.GaussianBlur(trusted, (0, 0), sigma)
        fills = (seen == 0) & (much > 1e-3)
        start[fills] = wide[fills] / much[fills][:, None]
        seen[fills] = 1
    field = start
    for _ in range(SMOOTH_ROUNDS):
        field = np.where(fixed[..., None], value, cv2.blur(field, (3, 3)))
    spread = cv2.resize(field, hole.shape[::-1], interpolation=cv2.INTER_LINEAR)
    return np.where(hole[..., None], spread, 0).astype(np.float32)
