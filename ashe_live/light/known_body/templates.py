"""The shadows that a known body casts on the cells of its table, in lights of some hundred directions.

They depend on the body's shape alone, in units of its height, so that they are made once for all cubes.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.rims import Rims
from ashe_live.light.known_body.shadows import Shadows, shadows_of
from ashe_live.light.known_body.sides.bounce import form_factors
from ashe_live.light.known_body.table import SIDE
from ashe_live.light.shape.light_points import at_infinity

# Lengths of shadows per unit of height, from lights 82 to 10 degrees high, each longer by a fifth.
LENGTHS = 0.14 * 1.2 ** np.arange(21)
# How far apart the ends of neighbouring shadows of one length are, per unit of height; limits of their number.
APART, FEWEST_AZIMUTHS, MOST_AZIMUTHS = 0.3, 16, 72
ROUNDED = 6  # templates are shared by bodies whose shapes agree when they are rounded to such a part of their heights
# Shadows of so many neighbouring rings and of so many directions around share a window of the map; all short ones one.
RINGS_A_WINDOW, WINDOWS_AROUND, SHORT_RINGS = 3, 8, 9
# Lights behind the camera, whose shadow the body hides: parts of the displacement at which the camera would cast it,
# and how far beside it, over 1 + |s|. Each stands for a cell of these two steps.
BEHIND_STEP, ASIDE_STEP = 0.1, 0.06
BEHIND, BEHIND_ASIDE = 0.15 + BEHIND_STEP * np.arange(11), ASIDE_STEP * (np.arange(4) - 1.5)


@dataclass(frozen=True, slots=True, eq=False)
class Templates:
    """The shadows of one body in many lights."""

    lights: Float  # (m, 4) at infinity, unit (x, y, z)
    solid_angle: Float  # (m,) share of the upper hemisphere that each stands for
    shadows: Shadows
    rims: Rims  # of the first of these lights; those of others are hidden
    hidden_sky: Float32  # (n * n,) fraction of an even sky's light that the body keeps from the table
    # (2, n * n) what it hides more of a sky that is brighter along x, and along y: one that gives 1 more to a facet
    # that faces that way, in units of what it gives to a level one.
    hidden_slope: Float32
    from_sides: Float32  # (4, n, n) as by `form_factors`

    def and_behind(self, eye: Float, body: Proxy) -> "Templates":
        """These, and between them more lights whose shadow the body hides from a camera at `eye` (3,).

        Where both are, each counts half, so that the hemisphere is covered once.
        """
        eye = eye - body.foot_marker
        if eye[2] <= 0:
            return self
        s = eye[:2] / eye[2]
        length = max(math.hypot(*s), 1e-9)
        grid = BEHIND[:, None, None] * s + (1 + length) * BEHIND_ASIDE[:, None] * np.array([-s[1], s[0]]) / length
        further = np.column_stack([grid.reshape(-1, 2), np.ones(grid.size // 2)])
        lengths = np.linalg.norm(further, axis=1)
        further = at_infinity(further / lengths[:, None])
        cell = length * BEHIND_STEP * (1 + length) * ASIDE_STEP
        weight = np.where(_are_behind(self.lights, s), 0.5, 1.0) * self.solid_angle
        return replace(
            self,
            lights=np.concatenate([self.lights, further]),
            solid_angle=np.concatenate([weight, 0.5 * cell / lengths**3 / (2 * np.pi)]),
            shadows=self.shadows.joined(shadows_of(body, further)),
        )


def _are_behind(lights: Float, s: Float) -> Mask:
    """(m,) which lights (m, 4) lie in the cells of those behind a camera at the displacement `s` (2,) from the foot."""
    displacements = lights[:, :2] / lights[:, 2:3]
    length = max(math.hypot(*s), 1e-9)
    along, aside = displacements @ s / length**2, displacements @ np.array([-s[1], s[0]]) / (length * (1 + length))
    is_along = np.abs(along - BEHIND.mean()) < 0.5 * BEHIND_STEP * len(BEHIND)
    are_behind: Mask = is_along & (np.abs(aside) < 0.5 * ASIDE_STEP * len(BEHIND_ASIDE))
    return are_behind


def templates_of(body: Proxy) -> Templates:
    """Of all directions; made once for all bodies that are alike but for size, place, and how they were folded."""
    spheroids = body.spheroids_marker - np.append(body.foot_marker, (0.0, 0.0))
    rounded = np.round(spheroids * (ROUNDED / body.height_m)) / ROUNDED
    return _templates(body.family, (rounded + 0.0).tobytes())  # without the sign of a zero


@lru_cache(maxsize=4)
def _templates(family: str, spheroids: bytes) -> Templates:
    """As `templates_of`, of a body 1 high with its foot in the origin: `spheroids` are the bytes of (k, 5) float64."""
    body = Proxy(family, np.frombuffer(spheroids).reshape(-1, 5))
    displacements = []
    for length in LENGTHS:
        count = int(np.clip(2 * np.pi * length / APART, FEWEST_AZIMUTHS, MOST_AZIMUTHS))
        angles = 2 * np.pi * (np.arange(count) + 0.5) / count
        displacements.append(length * np.column_stack([np.cos(angles), np.sin(angles)]))
    s = np.concatenate(displacements)
    to_light = np.column_stack([s, np.ones(len(s))])
    to_light /= np.linalg.norm(to_light, axis=1, keepdims=True)
    lights = at_infinity(to_light)
    # Each ring of azimuths stands for the sky around its height, whose light falls by the cosine.
    counts_of_rings = [len(each) for each in displacements]
    ring, around = np.repeat(np.arange(len(LENGTHS)), counts_of_rings), np.arctan2(s[:, 1], s[:, 0]) / (2 * np.pi)
    window_around = np.floor(WINDOWS_AROUND * around).astype(np.intp) % WINDOWS_AROUND
    window = np.where(ring < SHORT_RINGS, -1, ring // RINGS_A_WINDOW * WINDOWS_AROUND + window_around)
    shadows = shadows_of(body, lights, window)
    counts = np.bincount(ring)[ring]
    heights = np.arctan(1 / LENGTHS)
    between = np.concatenate([[np.pi / 2], 0.5 * (heights[1:] + heights[:-1]), [0.0]])
    solid_angle = (np.sin(between[:-1]) - np.sin(between[1:]))[ring] / counts
    share = (np.sin(between[:-1]) ** 2 - np.sin(between[1:]) ** 2)[ring] / counts
    # A sky with the radiance 1 + 3 g·w towards w gives 1/2 + g·n to an upright facet, over that of level ground.
    hidden = np.einsum("cm,mij->cij", share * np.vstack([np.ones(len(s)), 3 * lights[:, :2].T]), shadows.whole())
    hidden = hidden.reshape(3, SIDE * SIDE).astype(np.float32)
    rims = Rims.of(body, lights, hidden[0])
    return Templates(lights, solid_angle, shadows, rims, hidden[0], hidden[1:], form_factors(body))
