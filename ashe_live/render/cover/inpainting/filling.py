"""Fills a hole in a picture of the ground from the ground around it.

The ground consists of shading, straight lines and texture. Lines that are seen on both sides are drawn across
(`straight_lines.py`). Texture is copied in patches of visible ground that fit what is known already (`patches.py`); a
pattern that repeats is continued (`repetition.py`). Shading is spread from the hole's border over its inside as
smoothly as possible (Perez, Gangnet, Blake, "Poisson image editing", SIGGRAPH 2003).
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.render.cover.inpainting.masked import blurred_within, distances_from, mean_around, reduced
from ashe_live.render.cover.inpainting.patches import CoarseGround, CopiedPatches, chosen_patches, standing_out
from ashe_live.render.cover.inpainting.repetition import Pattern, pattern_of
from ashe_live.render.cover.inpainting.straight_lines import straight_lines
from ashe_live.render.cover.inpainting.visible_ground import AROUND_SIDES, SHADING_SIDES, VisibleGround

# "Sides" below is the length of a side of the marker; "roots" are square roots of linear RGB.
OVER_TEXTURE = 0.5, 1.5  # contrast of a line over the ground's, from which it is drawn faintly, and fully
DIMMEST = 0.03  # least shading, in roots, by which detail is divided
WHOLE = 0.995  # share of the hole that a pattern must fill
DARKEST_LINE = 0.2  # least root of light on a line over that beside it
# Distance from the hole up to which the picture's coarse colours and sharpening have mixed the ground with what lies in
# it, so that it is filled as well; and width of the ground beyond, with which what is filled in is compared.
BLEED_SIDES, BESIDE_SIDES = 0.06, 0.1
BAND_SIDES = 0.02  # standard deviation of the blur that separates fine texture from the rest
COARSER_SIDES = 0.05  # size of detail from which on patches are blended softly
MOST_GRAIN = 2.0  # largest factor by which the fine contrast of blended patches is raised to that of the ground
EDGE_OVER_GRAIN = 5.0  # fine contrast beyond this multiple of its median is an edge, and is not raised further
FIELD = 128  # cells a side of the grid in which the difference at the border is spread
BORDER_CELLS = 3.0  # standard deviation of a mean along the border
SMOOTH_ROUNDS = 100  # iterations of the relaxation


def filled(lit: Float32, hole: Mask, is_source: Mask, side_px: float) -> Float32 | None:
    """(n, n, 3) `lit`, linear RGB, with the hole (n, n) filled and all within BLEED_SIDES of it; None where no patch of
    ground is seen whole.

    is_source: (n, n) ground that may be copied. side_px: the marker's side.
    """
    # Roots: dark and bright patches are compared alike.
    roots = np.sqrt(np.clip(lit, 0, 4)).astype(np.float32)
    to_fill = with_rim(hole, side_px)
    ground = VisibleGround.around(to_fill, is_source & ~to_fill, roots, side_px)
    if not ground.sources.any() or not ground.unknown.any():
        return None
    trusted = ground.trusted
    shading = mean_around(roots, trusted, SHADING_SIDES * side_px)
    detail = np.where(trusted[..., None], roots - shading, 0)
    plain = trusted & (reduced(ground.known, len(hole)) > 0.5)
    pattern = _pattern_of_all(detail, shading, plain, to_fill, side_px)
    lines, predicted = np.zeros_like(detail), np.zeros_like(to_fill)
    if pattern is None:
        lines = straight_lines(detail, to_fill, trusted, side_px)
        lines *= _visibility(lines, detail[trusted])[..., None]
    else:  # its joints are part of it, and its checks, which touch at their corners, are no lines
        predicted = to_fill & pattern.is_there
        continued = pattern.contrast * shading
        continued += _spread_difference(detail, continued, pattern.is_there & trusted, to_fill, side_px)
        detail = np.where(predicted[..., None], continued, detail)
    # Lines are drawn, and not copied with patches: those would add to them. The ground on them is darker or brighter.
    on_line = np.maximum(1 + lines / np.maximum(shading, DIMMEST), DARKEST_LINE)
    plainer = np.asarray(np.where((trusted | predicted)[..., None], (detail - lines) / on_line, 0), np.float32)
    texture = _copied(plainer, predicted, shading, ground).blended(to_fill, COARSER_SIDES * side_px)
    if pattern is None:
        texture = _with_grain_of(plainer, plain, texture, to_fill, side_px)
    texture = np.asarray(texture * on_line + lines, np.float32)
    shows_shading = trusted | ground.highlights
    found = np.square(np.maximum(texture + _spread_difference(roots, texture, shows_shading, to_fill, side_px), 0))
    return np.asarray(np.where(to_fill[..., None], found, lit), np.float32)


def _copied(plainer: Float32, predicted: Mask, shading: Float32, ground: VisibleGround) -> CopiedPatches:
    """The patches that are copied into the hole, and the pattern where that is predicted (n, n).

    plainer: (n, n, 3) detail without lines. shading: (n, n, 3) of the ground.
    """
    n, m, known = len(predicted), len(ground.unknown), ground.trusted | predicted
    is_predicted = reduced(predicted, m) > 0.5
    coarse = CoarseGround(
        reduced(plainer, m),
        reduced(shading.mean(axis=2), m),
        reduced(standing_out(plainer, known), m),
        ground.unknown & ~is_predicted,
        ground.known | is_predicted,
        ground.sources,
    )
    copied = CopiedPatches(plainer, known, n / m)
    for place, source in chosen_patches(coarse):
        copied.paste(place, source)
    copied.keep(predicted)
    return copied


def _pattern_of_all(detail: Float32, shading: Float32, plain: Mask, to_fill: Mask, side_px: float) -> Pattern | None:
    """The pattern that repeats on plain ground (n, n), if it fills the hole; None for another, or none."""
    contrast = np.where(plain[..., None], detail / np.maximum(shading, DIMMEST), 0)
    pattern = pattern_of(contrast, plain, to_fill, side_px)
    # One that fills only a part may be grain, which repeats itself along a seam.
    return None if pattern is None or pattern.is_there[to_fill].mean() < WHOLE else pattern


def with_rim(hole: Mask, side_px: float) -> Mask:
    """(n, n) the hole and what lies within BLEED_SIDES of it, which is filled as well."""
    return distances_from(hole) < BLEED_SIDES * side_px


def _visibility(lines: Float32, ground: Float32) -> Float:
    """(n, n) 0 to 1: how much straight lines stand out from the detail of the ground (k, 3)."""
    low, high = OVER_TEXTURE
    contrast = np.linalg.norm(lines, axis=2) / max(float(np.median(np.linalg.norm(ground, axis=1))), 1e-4)
    return np.asarray(np.clip((contrast - low) / (high - low), 0, 1), np.float64)


def _with_grain_of(detail: Float32, plain: Mask, texture: Float32, hole: Mask, side_px: float) -> Float32:
    """`texture` (n, n, 3) with as much fine contrast in the hole as the ground beside it: blended patches have less.

    detail: (n, n, 3) of the ground, where it is `plain` (n, n).
    """
    near = plain & (distances_from(hole) < AROUND_SIDES * side_px)
    if not near.any():
        return texture
    weight = plain.astype(np.float32)
    around = detail - blurred_within(detail, weight, BAND_SIDES * side_px)
    fine = texture - blurred_within(texture, np.ones_like(weight), BAND_SIDES * side_px)
    wanted, found = (np.median(np.abs(each.mean(axis=2))[where]) for each, where in ((around, near), (fine, hole)))
    more = float(np.clip(wanted / max(float(found), 1e-6), 1.0, MOST_GRAIN)) - 1
    grain = np.clip(fine, -EDGE_OVER_GRAIN * found, EDGE_OVER_GRAIN * found)
    return np.asarray(texture + more * np.where(hole[..., None], grain, 0), np.float32)


def _spread_difference(roots: Float32, texture: Float32, is_known: Mask, hole: Mask, side_px: float) -> Float32:
    """(n, n, 3) to be added inside the hole: a harmonic function that at its border is the difference from the ground.

    texture: (n, n, 3) what was copied. is_known: (n, n) where ground is seen and something was copied.
    """
    ring = ~hole & (distances_from(hole) / side_px < BESIDE_SIDES) & is_known
    difference = np.where(ring[..., None], roots - texture, 0).astype(np.float32)
    share, sums = reduced(ring, FIELD), reduced(difference, FIELD)
    fixed = share > 0.05
    # Means along the border, as single speckles there say nothing of the inside.
    along, weight = (cv2.GaussianBlur(each, (0, 0), BORDER_CELLS) for each in (sums, share))
    value = np.where(fixed[..., None], along / np.maximum(weight, 1e-6)[..., None], 0).astype(np.float32)
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
