"""A body on the ground and the shadows that it casts: a member of a family, placed in the frame of a first guess."""

from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import normalised
from ashe_live.light.first_guess import FirstGuess
from ashe_live.light.proxies import Family


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What a fit varies: the shape of a body, and where each light throws its shadow."""

    guess: FirstGuess
    family: Family
    slants: Float  # (l, 2) displacement s of each light's shadow, for a unit of height
    shape: Float  # (q,) the family's parameters

    @property
    def spheroids(self) -> Float:
        """(k, 5) in the frame of the guess."""
        spheroids: Float = self.family.parts(self.shape[None])[0][0]
        spheroids[:, 3:] = np.abs(spheroids[:, 3:])  # a radius enters squared, so that its sign means nothing
        return spheroids

    @property
    def proxy(self) -> Proxy:
        """In the marker frame, metres."""
        spheroids = self.spheroids * self.guess.unit_m
        spheroids[:, :2] += self.guess.origin_marker
        return Proxy(self.family.name, spheroids)

    @property
    def to_lights_marker(self) -> list[Float]:
        """(3,) unit vectors."""
        return [normalised(np.array([*slant, 1.0])) for slant in self.slants]

    def moved(self, step: Float) -> "Body":
        """By a step (2 l + q,) in slants and shape."""
        split = self.slants.size
        return replace(self, slants=self.slants + step[:split].reshape(-1, 2), shape=self.shape + step[split:])
