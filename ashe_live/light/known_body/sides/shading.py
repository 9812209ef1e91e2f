"""What lights, the sky and the table give to a known body's sides, beside what they give to its level facet."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.known_body.sides.facets import Facets
from ashe_live.light.shape.light_points import NEAREST

PAPER = 0.8  # reflectance of white paper
LEAST_RELATIVE = 1e-3  # of a side's light over the level facet's
LOWEST_Z = 0.05  # of the unit vector towards a light: what a lower one gives to sides, over level ground, is bounded
# Standard deviations: of a side's light over level paper's, whatever lights it; of a light's part of the table's light,
# which its shadow determines, over that; and of the turn of a facet that was folded by hand.
NOISE, OF_LIGHT, TURN_RAD = 0.02, 0.08, np.radians(0.9).item()
# A facet's brightest white lies some way from its centre, towards a lamp or away: by a third of this, as the light of a
# lamp changes by about three times the way over its distance.
ACROSS_FACET_M = 0.065
# Sigma of a sky's slope before it is seen, over its light on level ground: it is 0 of an even sky, and 0.5 where all of
# its light comes from one side; skies, gardens and rooms have 0.12. And of what upright facets get of it all around,
# which is a half of an even sky: 0.4 of one that is three times as bright above (CIE overcast), more of a clear one.
SLOPE, UNEVEN = 0.12, 0.1
# Of a facet seen from the side, blur mixes the white with the print: in painted pictures its light is a fifth of the
# level one's off where it is ten pixels wide, and falls by the third power of the width.
MIXED, MIXED_PX, MIXED_POWER = 0.2, 10.0, 3
# Of the exponent by which a camera's tones bend the ratio of two facets' light: of 87 sides, path-traced, through five
# cameras, by `scenes.tones` (assets/sources); 0.01 of a plain one and 0.2 of a phone that maps tones locally.
TONES = 0.12
DENIED_SIGMAS = 3.0  # by which all sides that a light reaches lack its light, if it is none
MOST_SIGMAS = 4.0  # a residual counts no more than so many: something else may light or shade that side


@dataclass(frozen=True, slots=True, eq=False)
class Sides:
    """k upright facets, in units of the level facet's light."""

    normals: Float  # (k, 3)
    centres: Float  # (k, 3) metres, marker frame
    level_centre: Float  # (3,) of the level facet
    relative: Float  # (k,) their light
    even: Float  # (k,) what an even sky that gave all light would give them
    residual: Float  # (k,) their light without that, and without what the table sends
    noise: Float  # (k,) standard deviation of how that is measured
    is_clipped: Mask  # (k,) brighter than the picture shows
    by_level: Float  # (k,) what all change together by a standard deviation of the level facet's light; clipped ones: 0

    @staticmethod
    def of(facets: Facets, from_table: Float, channels: Float) -> "Sides":
        """No sides where the level facet's light, which all others are compared with, is unknown.

        from_table: (n, 3) what the table sends to each facet, in the picture's linear light. channels: (3,) weights of
        R, G, B.
        """
        light, bounced = facets.light_rgb @ channels, from_table @ channels
        level = np.flatnonzero(facets.is_level & math.isfinite(facets.level_sigma))
        sides = np.flatnonzero(~facets.is_level) if len(level) else level
        white = max(float(light[level].mean()), 1e-4) if len(level) else 1.0
        relative = light[sides] / white
        even = 0.5 * (1 + facets.normals[sides, 2])
        residual = relative - bounced[sides] / white - even
        mixed = MIXED * (MIXED_PX / np.maximum(facets.width_px, MIXED_PX / 2)) ** MIXED_POWER
        of_level = float(mixed[level].mean()) if len(level) else 0.0
        by_tones = TONES * relative * np.log(np.maximum(relative, LEAST_RELATIVE))
        noise = np.sqrt(NOISE**2 + mixed[sides] ** 2 + (relative * of_level) ** 2 + by_tones**2)
        level_centre = facets.centres[level].mean(axis=0) if len(level) else np.zeros(3)
        clipped = facets.is_clipped[sides]
        by_level = relative * (facets.level_sigma if len(level) else 0.0)
        # What is a bound only is no information on what is shared.
        noise = np.hypot(noise, np.where(clipped, by_level, 0.0))
        by_level = np.where(clipped, 0.0, by_level)
        normals, centres = facets.normals[sides], facets.centres[sides]
        return Sides(normals, centres, level_centre, relative, even, residual, noise, clipped, by_level)

    def reached(self, lights: Float) -> Float:
        """(..., k) by how much each side gets more of lights (..., 4) than of an even sky.

        Over the level facet, and in units of what each gives to the level ground at the marker's centre. A lamp gives
        more to what is nearer to it: where the level facet gets `level` of these units, a light's share D of the
        ground's light makes all relative light smaller by 1 + D (level - 1).
        """
        direct = direct_light(lights, self.normals, self.centres)
        if not lights[..., 3].any():
            return np.asarray(direct - self.even)
        level = direct_light(lights, np.array([(0.0, 0.0, 1.0)]), self.level_centre[None])
        return np.asarray(direct - self.even - (self.residual + self.even) * (level - 1))

    def spread(self, lights: Float, reached: Float) -> Float:
        """(..., k) variance that lights (..., 4) add to the residuals, over their squared darkenings; reached: as by
        `reached`.
        """
        to_lights = lights[..., :3]
        across = 1 / np.maximum(to_lights[..., 2:], LOWEST_Z) ** 2
        cosines = to_lights @ self.normals.T
        turned = np.where(cosines > 0, across * (1 - cosines**2), 0.0)
        turned_level = across * (1 - to_lights[..., 2:] ** 2) * self.relative**2
        uneven = (ACROSS_FACET_M * lights[..., 3:]) ** 2
        direct = (reached + self.even) ** 2
        by_lamps = uneven * (direct + self.relative**2)
        return np.asarray(OF_LIGHT**2 * direct + by_lamps + TURN_RAD**2 * (turned + turned_level))

    def deny(self, light: Float, darkening: float) -> bool:
        """Whether a light (4,) of that part of the table's light does not shine: what it alone gives is not there.

        Whatever else shines adds to it. Another thing's shadow may lie on a side, but on all that it reaches?
        """
        unit = light / np.linalg.norm(light[:3])
        reached = self.reached(unit)
        given, there = darkening * (reached + self.even), self.residual + self.even
        sigma = np.sqrt(self.noise**2 + self.by_level**2 + darkening**2 * self.spread(unit, reached))
        is_expected = ~self.is_clipped & (given > DENIED_SIGMAS * sigma)
        return bool(is_expected.any() and (given - there > DENIED_SIGMAS * sigma)[is_expected].all())

    def variance(self, spread: Float, darkenings: Float) -> Float:
        """(k, m) of the residuals in m sets of l lights of `darkenings` (l, m); spread: (l, k, m) as by `spread`."""
        sky = np.maximum(1 - darkenings.sum(axis=0), 0.0)
        by_lights = (spread * (darkenings**2)[:, None]).sum(axis=0)
        return np.asarray(self.noise[:, None] ** 2 + by_lights + (SLOPE**2 + UNEVEN**2) * sky**2)

    def log_likelihood(self, reached: Float, darkenings: Float, variance: Float) -> Float:
        """(m,) of the sides' light in l lights of `darkenings` (l, m), with residuals of `variance` (k, m).

        reached: (l, k, m) as by `reached`.
        """
        away = self.residual[:, None] - (reached * darkenings[:, None]).sum(axis=0)
        if self.is_clipped.any():  # it may be brighter than it looks
            away = np.where(self.is_clipped[:, None], np.maximum(away, 0.0), away)
        by_sides = np.log(variance).sum(axis=0)
        if self.by_level.any():
            # The level facet's error, which all sides share, is marginalised out.
            weighted, information = self.by_level[:, None] / variance, self.level_information(variance)
            shared = (weighted * away).sum(axis=0) / information
            away = away - self.by_level[:, None] * shared
            by_sides = by_sides + shared**2 + np.log(information)
        sigmas_squared = np.minimum(away**2 / variance, MOST_SIGMAS**2)
        return np.asarray(-0.5 * (sigmas_squared.sum(axis=0) + by_sides))

    def level_information(self, variance: Float) -> Float:
        """(m,) of the level facet's light, in standard deviations, by sides of `variance` (k, m) and before."""
        return np.asarray(1 + (self.by_level[:, None] ** 2 / variance).sum(axis=0))


def direct_light(lights: Float, normals: Float, centres: Float) -> Float:
    """(..., k) light of each of lights (..., 4) on facets with normals (k, 3) at `centres` (k, 3), marker frame.

    In units of what it gives to level ground at the marker's centre: by Lambert's cosine law and, of a lamp, the
    inverse square of the distance.
    """
    lengths = np.linalg.norm(lights[..., :3], axis=-1)
    up = np.maximum(lights[..., 2] / lengths, LOWEST_Z)[..., None]
    if not lights[..., 3].any():
        return np.asarray(np.maximum(lights[..., :3] / lengths[..., None] @ normals.T, 0.0) / up)
    ways = (lights[..., None, :3] - lights[..., None, 3:] * centres) / lengths[..., None, None]
    cosines = np.maximum((ways * normals).sum(axis=-1), 0.0)
    return np.asarray(cosines / np.maximum(np.linalg.norm(ways, axis=-1), NEAREST) ** 3 / up)


def fall_off(lights: Float | Float32, x: Float | Float32, y: Float | Float32) -> Float:
    """What lights (..., 4) give to level ground at places x, y, metres, over that at the marker's centre: 1 of a sun.

    The leading dimensions of lights, x and y broadcast.
    """
    lx, ly, lz, w = np.moveaxis(lights / np.linalg.norm(lights[..., :3], axis=-1, keepdims=True), -1, 0)
    squared = np.maximum((lx - w * x) ** 2 + ((ly - w * y) ** 2 + lz**2), NEAREST**2)
    return np.asarray(1 / (squared * np.sqrt(squared)))
