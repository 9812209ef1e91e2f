"""The white paper of a body's visible facets, and the light that falls on it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Float32, Mask, fixed_point, upper_quantile
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import camera_centre, project
from ashe_live.light.pixels.view import View

NORMALS: Float = np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], dtype=np.float64)
NORMALS.flags.writeable = False
LEVEL_Z = 0.99  # of the normal of a facet that counts as level, at least
# A print leaves half of a facet white: what is brighter than most of it, without what gloss or noise makes brightest.
WHITE = (0.9, 0.98)  # quantiles
RIM_PX, LEAST_PX = 2, 30  # of a facet: width of the rim that is left out, and pixels within it, at least
ENOUGH = 2000  # pixels of a facet, by which the limits are known to less than a hundredth of all
CLIPPED = 0.95  # linear light, from which on it may be any
INK = 0.1  # quantile of a facet's brightness: print is a good third of it
# Ink is as dark beside white on every facet, but for the light that it mirrors, glare and what a camera does to dark
# tones: standard deviation of the logarithm of two facets' inks over their light; and root mean square of that of a
# clipped facet's light over what is shown. Of 110 sides beside a clipped level facet, path-traced through five cameras.
INK_SIGMA, OVER_SIGMA = 0.33, 0.43
INK_PX = 25.0  # width of facets from which on blur leaves the ink dark
LEAST_INK = 1e-4  # linear light: darker ink is black in the picture, and no share of anything
WITHIN_SIGMAS, STEPS = 4.0, 65  # of these
FOLDED = 0.08  # of the body's extent: how deep a facet is that was folded by hand


@dataclass(frozen=True, slots=True, eq=False)
class Facets:
    """Of n facets of white paper."""

    normals: Float  # (n, 3) unit, outwards, marker frame
    light_rgb: Float  # (n, 3) linear light of the white, as the picture has it; of a clipped level one as its ink says
    centres: Float  # (n, 3) metres
    is_clipped: Mask  # (n,) brighter than the picture shows
    width_px: Float  # (n,) of the narrowest strip of the picture that holds it
    level_sigma: float = 0.0  # standard deviation of the logarithm of the level facet's light; inf: it is unknown

    @property
    def is_level(self) -> Mask:
        """(n,) which one faces upwards."""
        return self.normals[:, 2] > LEVEL_Z


def facets_of(view: View, body: Proxy, picture: Float32) -> Facets:
    """Those of a box along the marker's axes that are seen in `picture` (h, w, 3), linear light, B, G, R."""
    in_view = _outlines_in_view(view, body)
    found: list[tuple[_Outline, Float, float]] = []
    for one in in_view:
        seen = _inside(one.hull, [other.hull for other in in_view if other is not one], picture)
        if len(seen) >= LEAST_PX:
            found.append((one, *_white_and_ink(seen)))
    if not found:
        return Facets(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3)), np.empty(0, bool), np.empty(0), math.inf)
    outlines, whites, inks = zip(*found, strict=True)
    normals, centres = (np.array(each) for each in zip(*((one.normal, one.centre) for one in outlines), strict=True))
    light, clipped = np.array(whites), np.array([bool(white.max() > CLIPPED) for white in whites])
    widths = np.array([min(cv2.minAreaRect(one.hull)[1]) for one in outlines])
    light, level_sigma = _with_level(normals, light, clipped, widths, np.array(inks))
    return Facets(normals, light, centres, clipped, widths, level_sigma)


class _Outline(NamedTuple):
    """A facet that faces the camera."""

    normal: Float  # (3,)
    centre: Float  # (3,) metres, marker frame
    hull: Float32  # (m, 2) pixels


def _outlines_in_view(view: View, body: Proxy) -> list[_Outline]:
    """The facets of the body, a box along the marker's axes, that face the camera."""
    points = body.points_marker(4)
    eye = camera_centre(view.T_cam_marker)
    found = []
    for normal in NORMALS:
        along = points @ normal
        corners = points[along > along.max() - FOLDED * np.ptp(along)]
        centre = corners.mean(axis=0)
        pixels = project(view.camera, view.T_cam_marker, corners)
        if len(corners) >= 3 and (eye - centre) @ normal > 0 and np.isfinite(pixels).all():
            hull = np.asarray(cv2.convexHull(pixels.clip(-1e4, 1e4).astype(np.float32))[:, 0], dtype=np.float32)
            found.append(_Outline(normal, centre, hull))
    return found


def _white_and_ink(seen: Float32) -> tuple[Float, float]:
    """(3,) linear RGB of the white among a facet's pixels (n, 3), linear B, G, R, and the brightness of its ink."""
    brightness = seen @ np.full(3, 1 / 3, np.float32)
    some = brightness[:: max(1, len(brightness) // ENOUGH)]
    least, most = (upper_quantile(some, share) for share in WHITE)
    white = seen[(brightness >= least) & (brightness <= most)].mean(axis=0)[::-1].astype(np.float64)
    return white, upper_quantile(some, INK)


def _with_level(normals: Float, light: Float, is_clipped: Mask, widths: Float, inks: Float) -> tuple[Float, float]:
    """The facets' light (n, 3), that of a clipped level one by its ink (n,), and how well that is determined.

    The ratio of their inks is that of a level facet's light to a side's; and it is no darker than it looks.
    """
    level = np.flatnonzero(normals[:, 2] > LEVEL_Z)
    if not len(level) or not is_clipped[level[0]]:
        return light, 0.0 if len(level) else math.inf
    shows_ink = (widths > INK_PX) & (inks > LEAST_INK)
    comparable = ~is_clipped & shows_ink
    logs = np.linspace(0.0, WITHIN_SIGMAS * OVER_SIGMA, STEPS)
    score = (logs / OVER_SIGMA) ** 2
    if comparable.any() and shows_ink[level[0]]:
        by_ink = np.log(light[comparable].mean(axis=1) * inks[level[0]] / inks[comparable]).mean()
        score += ((logs - float(by_ink - np.log(light[level[0]].mean()))) / INK_SIGMA) ** 2
    weight = np.exp(-0.5 * (score - score.min()))
    weight /= weight.sum()
    mean = float(weight @ logs)
    light[level[0]] *= math.exp(mean)
    return light, math.sqrt(float(weight @ (logs - mean) ** 2))


def _inside(hull: Float32, others: Sequence[Float32], picture: Float32) -> Float32:
    """(n, 3) pixels of a picture (h, w, 3) in a convex outline (m, 2), without its rim and what may be others'.

    Facets that were folded by hand reach into their neighbours' outlines, where a brighter one's white would be taken
    for a darker one's.
    """
    height, width = picture.shape[:2]
    (left, top), (right, bottom) = np.floor(hull.min(axis=0)).astype(int), np.ceil(hull.max(axis=0)).astype(int) + 1
    rows, columns = slice(max(top, 0), min(bottom, height)), slice(max(left, 0), min(right, width))
    part = picture[rows, columns]
    if not part.size:
        return part.reshape(-1, 3)
    mask = np.zeros(part.shape[:2], np.uint8)
    corner = np.array((columns.start, rows.start), np.float32)
    cv2.fillConvexPoly(mask, fixed_point(hull - corner), 1, shift=FRACTION_BITS)
    within = cv2.erode(mask, np.ones((2 * RIM_PX + 1, 2 * RIM_PX + 1), np.uint8), borderValue=0)
    for other in others:
        cv2.fillConvexPoly(within, fixed_point(other - corner), 0, shift=FRACTION_BITS)
    return part[within > 0]
