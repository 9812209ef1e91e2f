"""Where a picture of the plane shows the ground, rather than things that stand on it, their shadows, and highlights."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float32, Mask
from ashe_live.render.cover.inpainting.masked import HOLE_FROM, KNOWN_FROM, distances_from, mean_around, reduced
from ashe_live.render.cover.inpainting.patches import PATCH

# "Sides" below is the length of a side of the marker; "roots" are square roots of linear RGB.
COARSE_SIDE_PX = 26.0  # length of a side in the coarse picture, in which patches are chosen
SHADING_SIDES = 0.5  # standard deviation of the blur that separates shading from texture
AROUND_SIDES = 0.5  # ground up to this distance from the hole gives the range of the ground's colours
# Margins of that range: in roots, over those of the brightest ground, and in a channel's share of the sum of roots.
UNLIKE, UNLIKE_HUE = 0.12, 0.03
# Objects and their shadows differ from the ground's level by both of these: in roots, and over the median difference.
OBJECT, OBJECT_OVER_TEXTURE = 0.08, 5.0
OBJECT_PX = 7  # their least width, in coarse pixels
# A brighter one has no outline, and is a highlight, if along its rim the brightness changes within three coarse pixels
# by less than this share (median) of what it differs by from the ground; at an outline it changes by all.
FADES = 0.7
MOST_OBJECTS = 0.25  # largest share of the ground that they are: what is more is a pattern of it


@dataclass(frozen=True, slots=True, eq=False)
class VisibleGround:
    """Where a picture (n, n) of the plane shows ground and no objects; coarse (m, m), also what is to be filled."""

    trusted: Mask  # (n, n)
    highlights: Mask  # (n, n) their light goes on into the hole, but they are not copied
    unknown: Mask  # (m, m) to be filled
    known: Mask  # (m, m) like the ground around that, and no object
    sources: Mask  # (m, m) middles of patches of it

    @staticmethod
    def around(to_fill: Mask, may_be_ground: Mask, roots: Float32, side_px: float) -> "VisibleGround":
        """The ground around what is `to_fill` (n, n), where it `may_be_ground` (n, n); side_px: the marker's side."""
        n = len(to_fill)
        m = max(PATCH + 2, round(n * COARSE_SIDE_PX / side_px))
        unknown, shown = reduced(to_fill, m) > HOLE_FROM, reduced(may_be_ground, m) > KNOWN_FROM
        coarse = reduced(roots, m)
        known = shown & _like_the_ground_around(coarse, shown, unknown)
        objects, highlights = _objects_and_highlights(coarse, known, shown)
        known &= ~(objects | highlights)
        sources = cv2.erode(known.astype(np.uint8), np.ones((PATCH, PATCH)), borderValue=0) > 0
        standing, bright = (reduced(each, n) > 0.5 for each in (objects, highlights))
        bare = may_be_ground & ~standing
        return VisibleGround(bare & ~bright, bare & bright, unknown, known, sources)


def _like_the_ground_around(coarse: Float32, known: Mask, unknown: Mask) -> Mask:
    """(m, m) ground whose colour also occurs beside the unknown part. Excludes objects, also those no estimate knows.

    coarse: (m, m, 3) roots of linear RGB.
    """
    away = distances_from(unknown)
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


def _objects_and_highlights(coarse: Float32, ground: Mask, shown: Mask) -> tuple[Mask, Mask]:
    """(m, m) each, of wide areas of other colours than the ground, or much darker or brighter than it is around them:
    objects and their shadows; and highlights, as glossy ground has, which have no outline.

    Joints and cracks are narrow. If more than MOST_OBJECTS of the ground is such areas, they are a pattern of it.
    coarse: (m, m, 3) roots. ground: (m, m) of its colours. shown: (m, m) what the picture shows, of ground and things.
    """
    plain, apart = ground.copy(), np.zeros(ground.shape, np.float32)
    for _ in range(2):  # first with them, then without
        level = mean_around(coarse, plain, SHADING_SIDES * COARSE_SIDE_PX)
        apart = (coarse - level).mean(axis=2)
        texture = float(np.median(np.abs(apart[plain]))) if plain.any() else 0.0
        plain = ground & (np.abs(apart) < max(OBJECT, OBJECT_OVER_TEXTURE * texture))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (OBJECT_PX, OBJECT_PX))
    wide = cv2.morphologyEx((shown & ~plain).astype(np.uint8), cv2.MORPH_OPEN, disc)
    objects, highlights = np.zeros_like(ground), np.zeros_like(ground)
    count, areas = cv2.connectedComponents(wide)
    for area in (areas == number for number in range(1, count)):
        kind = highlights if _is_highlight(area, apart, shown) else objects
        kind |= cv2.dilate(area.astype(np.uint8), disc) > 0
    if ((objects | highlights) & ground).sum() >= MOST_OBJECTS * ground.sum():
        return np.zeros_like(ground), np.zeros_like(ground)
    return objects, highlights


def _is_highlight(area: Mask, apart: Float32, shown: Mask) -> bool:
    """Whether an area (m, m) is brighter than what is `shown` (m, m) around it, and fades into that.

    apart: (m, m) difference from the ground's level, roots.
    """
    window = np.ones((3, 3), np.uint8)
    across = cv2.dilate(apart, window) - cv2.erode(apart, window)
    is_seen = cv2.erode(shown.astype(np.uint8), window, borderValue=0) > 0
    rim = (cv2.morphologyEx(area.astype(np.uint8), cv2.MORPH_GRADIENT, window) > 0) & is_seen
    return bool(rim.any()) and float(np.median(across[rim])) < FADES * float(np.median(apart[area]))
