"""A simple body in the place of the real object: what hides, shades and receives shadows for it."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, frozen_floats, set_frozen


@dataclass(frozen=True, slots=True)
class Proxy:
    """The real object's stand-in: the convex hull of upright spheroids (a point, a disc, a ball are special cases)."""

    family: str  # the kind of body that was fitted, e.g. box
    spheroids_marker: Float  # (k, 5) centre x, y, z, horizontal radius, half height; metres, marker frame

    def __post_init__(self) -> None:
        set_frozen(self, spheroids_marker=frozen_floats(self.spheroids_marker, (-1, 5), "spheroids_marker"))

    def points_marker(self, around: int = 24) -> Float:
        """(m, 3) points on the body, marker frame, metres, whose convex hull it is (nearly, where it is round)."""
        angles = np.arange(around) * (2 * math.pi / around)
        clouds = []
        for x, y, z, radius, half in self.spheroids_marker:
            tilts = np.linspace(-math.pi / 2, math.pi / 2, 9) if half else np.zeros(1)
            tilt, angle = np.meshgrid(tilts, angles if radius else angles[:1])
            flat = radius * np.cos(tilt)
            offsets = np.stack([flat * np.cos(angle), flat * np.sin(angle), half * np.sin(tilt)], axis=-1)
            clouds.append((offsets + np.array([x, y, z])).reshape(-1, 3))
        return np.concatenate(clouds)
