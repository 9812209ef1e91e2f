"""Search for shadows of a known body: places on the ground that are darker than their surroundings.

The body is given, so each shadow has two unknowns only. One that is too pale to win votes or to stand out pixel by
pixel is found by the mean colour of all its pixels: a matched filter with the predicted shadow as template.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, cross_2d, unit_circle
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, image_from_plane
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.lit_ground import UNLIT_DISTANCE, LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import shift_near
from ashe_live.light.pixels.areas import grown, mean_nearby
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.layout import light_parameters, nearness_of
from ashe_live.light.shape.light_points import at_infinity, towards
from ashe_live.light.shape.predicted import predicted

# Displacements that are searched: a coarse grid of azimuth and length first, then a fine one around each candidate.
AZIMUTHS, LENGTHS = np.arange(0, 360, 10), (0.4, 0.6, 0.85, 1.2, 1.7, 2.4)
TURNS, STRETCHES = (-5.0, 0.0, 5.0), (0.8, 0.9, 1.0, 1.12, 1.25)
# Where a shadow is sampled: positions along each side of its outline; and radii from its centre, 1 at the outline, with
# the fraction of the area that each of these stands for.
CORNERS, ALONG_SIDE = 16, np.array([1 / 6, 1 / 2, 5 / 6])
DIRECTIONS, NORMALS = unit_circle(CORNERS), unit_circle(CORNERS, 0.5)  # of the corners, and of the sides after them
RADII, AREA_FRACTIONS = np.array([0.4, 0.8]), np.array([0.4, 0.6])
OUTSIDE_PX, BLUR_PX = 3.0, 1.2
AROUND = 8  # points on a body's rings
BESIDE_PX, LEAST_PX = 2, 25
SPARSE, LEAST_VARIANCE = 5, 1e-4  # the noise is measured at one pixel in so many; added to its variances
DARKEST, BRIGHTEST = -0.8, 0.5  # clip of a pixel's log-opponent difference from its surroundings, against outliers
SURROUNDINGS = 2.0  # radius of the surroundings, in units of the body's size
LEAST_DARKENING, LEAST_SIGNAL_TO_NOISE = 0.07, 20.0
APART_RAD = math.radians(12)
PALEST = math.log(0.9)  # brightness of a shift: a light that contributes less than a tenth of all light is left out


@dataclass(frozen=True, slots=True, eq=False)
class ShadowCandidate:
    """A candidate for a shadow."""

    light: Float  # (4,) homogeneous point at infinity, marker frame, with z = 1
    area: Mask  # (h, w) its visible part in the coarse picture, outside of the body and of known shadows
    shift: Float  # (3,) the shift of the ground's colours in it, log-opponent
    signal_to_noise: float  # at the place of the coarse grid by which it was found

    def region(self, lit: LitBody, view: SceneView, region_px: int) -> Region:
        """The part of the view that holds the candidate and the body with its shadows, scaled to `region_px`."""
        return view.region(view.ground_under(lit) | self.area, region_px)


def shadow_candidates(
    proxy: Proxy,
    known_lights: Float,
    coarse: View,
    ground: LitGround,
    count: int,
    least_signal_to_noise: float = LEAST_SIGNAL_TO_NOISE,
) -> list[ShadowCandidate]:
    """Up to `count` candidates for a shadow of a body beside those in known lights, by falling signal-to-noise ratio.

    That is at least `least_signal_to_noise` on the coarse grid. The signal is a candidate's difference from the ground
    around it. Where a light is known, the noise is the unevenness of lit ground, or a candidate's own where that is
    larger, as in parts of other things; else that of all ground, as a shadow that stands out nowhere lies on a pattern.
    Candidates without a shadow's colours are left out.
    known_lights: (l, 4) homogeneous points, marker frame; (0, 4) where none is known. coarse: the view that `ground`
    was fitted to.
    """
    known = predicted(proxy, known_lights, coarse)
    free = coarse.is_ground & ~grown(known.whole, BESIDE_PX)
    is_lit = free & (ground.squared_distance <= UNLIT_DISTANCE)
    if np.count_nonzero(is_lit) < LEAST_PX:
        return []
    uneven = _unevenness(ground, is_lit, SURROUNDINGS * math.sqrt(known.body.sum()))
    is_second = len(known_lights) > 0
    matched_filter = _MatchedFilter.of(proxy, coarse, free, uneven, is_lit if is_second else free, is_second)
    azimuths, lengths = (each.ravel() for each in np.meshgrid(np.radians(AZIMUTHS), LENGTHS))
    ratios, _ = matched_filter.responses(_lights(azimuths, lengths))
    found: list[ShadowCandidate] = []
    directions = [towards(light, proxy.foot_marker) for light in known_lights]
    for index in np.argsort(-ratios, kind="stable"):
        if ratios[index] < least_signal_to_noise or len(found) == count:
            break
        (coarsely,) = _lights(azimuths[index], lengths[index])
        if all(angle_between(coarsely[:3], other) > APART_RAD for other in directions):
            directions.append(coarsely[:3])
            turns, stretches = (each.ravel() for each in np.meshgrid(np.radians(TURNS), STRETCHES))
            nearby = _lights(azimuths[index] + turns, lengths[index] * stretches)
            ratios_nearby, differences = matched_filter.responses(nearby)
            best = int(ratios_nearby.argmax())
            area = predicted(proxy, nearby[best : best + 1], coarse).shadow & free
            shift = shift_near(ground.colours[area], ground, differences[best])
            if shift is not None and shift[0] < PALEST:
                found.append(ShadowCandidate(nearby[best], area, shift, float(ratios[index])))
    return found


def _lights(azimuths: Float, lengths: Float) -> Float:
    """(m, 4) lights at infinity with z = 1 in these azimuths, whose shadows are so long per unit of height."""
    x, y = lengths * np.cos(azimuths), lengths * np.sin(azimuths)
    return at_infinity(np.column_stack([x, y, np.ones_like(x)]))


def _unevenness(ground: LitGround, is_lit: Mask, reach_px: float) -> Float32:
    """(h, w, 3) difference of each pixel's colour from the mean of the lit ground around it, clipped."""
    around = mean_nearby(ground.colours, is_lit, int(reach_px))
    return (ground.colours - around).clip(DARKEST, BRIGHTEST)


@dataclass(frozen=True, slots=True, eq=False)
class _MatchedFilter:
    """A body and the ground around it, prepared for testing its shadows in many lights."""

    points: Float  # (n, 3) of the body, marker frame
    image_from_ground: Float  # (3, 3)
    # (h, w, 7) unevenness where ground is not yet explained, its squares, and a last channel of 1 there; blurred
    layers: Float32
    covariance: Float  # (3, 3) of the noise
    is_even: bool  # whether a shadow has no more than that: Welch's test of two means, and not Student's

    @staticmethod
    def of(
        proxy: Proxy, view: View, free: Mask, uneven: Float32, is_noise: Mask, is_even: bool = False
    ) -> "_MatchedFilter":
        image_from_ground = image_from_plane(view.camera, view.T_cam_marker)
        covariance = np.cov(uneven[is_noise][::SPARSE].T) + LEAST_VARIANCE * np.eye(3)
        layers = (np.dstack([uneven, uneven**2, np.ones_like(free)]) * free[..., None]).astype(np.float32)
        layers = np.asarray(cv2.GaussianBlur(layers, (0, 0), BLUR_PX), dtype=np.float32)
        return _MatchedFilter(proxy.points_marker(AROUND), image_from_ground, layers, covariance, is_even)

    def responses(self, lights: Float) -> tuple[Float, Float]:
        """(m,) signal-to-noise ratios, 0 where too little is seen, and (m, 3) colour differences of the shadows in
        lights (m, 4).
        """
        outlines, is_seen = self._outlines(lights)
        sides = np.roll(outlines, -1, axis=1) - outlines
        points = (outlines[:, :, None] + ALONG_SIDE[:, None] * sides[:, :, None]).reshape(len(lights), -1, 2)
        centre = outlines.mean(axis=1, keepdims=True)
        arms = outlines - centre
        inner = np.concatenate([centre + radius * (points - centre) for radius in RADII], axis=1)
        areas = 0.5 * np.abs(cross_2d(arms, sides))
        areas = np.repeat(areas / len(ALONG_SIDE), len(ALONG_SIDE), axis=1)
        weights = np.concatenate([part * areas for part in AREA_FRACTIONS], axis=1)
        inside, variances, inside_px = self._moments(inner, weights)
        lengths = np.repeat(np.linalg.norm(sides, axis=2) / len(ALONG_SIDE), len(ALONG_SIDE), axis=1)
        outer = points + OUTSIDE_PX * np.repeat(NORMALS, len(ALONG_SIDE), axis=0)
        outside, _, outside_px = self._moments(outer, OUTSIDE_PX * lengths)
        difference = inside - outside
        # The variance of a difference of two means adds up.
        sample_size = inside_px * outside_px / np.maximum(inside_px + outside_px, 1.0)
        if self.is_even:
            sample_size /= np.maximum(1.0, (variances / np.diag(self.covariance)).mean(axis=1))
        precision = np.linalg.inv(self.covariance)
        ratio = np.sqrt(np.einsum("mi,ij,mj->m", difference, precision, difference) * sample_size)
        is_dark = difference[:, 0] < -LEAST_DARKENING
        return np.where(is_seen & (np.minimum(inside_px, outside_px) > LEAST_PX) & is_dark, ratio, 0.0), difference

    def _outlines(self, lights: Float) -> tuple[Float, Mask]:
        """(m, CORNERS, 2) pixels where shadows reach farthest along DIRECTIONS; (m,) whether in front of the camera."""
        heights, scale = self.points[:, 2:], 1 - self.points[:, 2:] * nearness_of(lights)[:, None, None]
        cast = self.points[:, :2] - heights * light_parameters(lights)[:, None]
        image = cast @ self.image_from_ground[:, :2].T + scale * self.image_from_ground[:, 2]
        depth = image[..., 2:]
        is_seen = np.asarray(((depth > 0) & (scale > 0)).all(axis=(1, 2)))
        pixels = image[..., :2] / np.where(depth > 0, depth, 1.0)
        farthest = (pixels @ DIRECTIONS.T).argmax(axis=1)
        return np.take_along_axis(pixels, farthest[..., None], axis=1), is_seen

    def _moments(self, points: Float, weights: Float) -> tuple[Float, Float, Float]:
        """(m, 3) weighted means and variances of the unevenness at (m, k) points; (m,) the free weights' sum."""
        height, width = self.layers.shape[:2]
        columns, rows = np.round(points).astype(np.intp).transpose(2, 0, 1)
        inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        seen = self.layers[rows.clip(0, height - 1), columns.clip(0, width - 1)]
        total = np.einsum("mk,mkc->mc", weights * inside, seen)
        means, mean_squares = np.split(total[:, :-1] / np.maximum(total[:, -1:], 1e-6), 2, axis=1)
        return means, mean_squares - means**2, total[:, -1]
