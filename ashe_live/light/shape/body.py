"""Bodies on the ground and the lights in which they stand: geometry in the marker's frame, whatever sees them."""

from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import normalised
from ashe_live.light.shape.family import Family
from ashe_live.light.shape.layout import Layout, numbers_of


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A body's own frame, in which its family's parameters are: upright at its foot, its size the unit."""

    origin_marker: Float  # (2,) metres, on the ground
    unit_m: float

    @property
    def T_marker_own(self) -> Float:
        """(4, 4) a similarity."""
        M = np.diag([self.unit_m, self.unit_m, self.unit_m, 1.0])
        M[:2, 3] = self.origin_marker
        return M

    def lights(self, lights_marker: Float) -> Float:
        """(l, 4) lights of the marker frame in this one."""
        own = lights_marker.copy()
        own[:, :2] -= lights_marker[:, 3:] * self.origin_marker
        own[:, 3] *= self.unit_m
        return own


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A member of a family, somewhere on the ground."""

    place: Place
    family: Family
    shape: Float  # (q,) the family's parameters

    @property
    def spheroids(self) -> Float:
        """(k, 5) in its own frame."""
        spheroids: Float = self.family.parts(self.shape[None])[0][0]
        spheroids[:, 3:] = np.abs(spheroids[:, 3:])  # a radius enters squared, so that its sign means nothing
        return spheroids

    @property
    def proxy(self) -> Proxy:
        """In the marker frame, metres."""
        spheroids = self.spheroids * self.place.unit_m
        spheroids[:, :2] += self.place.origin_marker
        return Proxy(self.family.name, spheroids)


@dataclass(frozen=True, slots=True, eq=False)
class LitBody:
    """What a fit varies: a body, and the lights that throw its shadows."""

    body: Body
    lights: Float  # (l, 4) homogeneous points, marker frame

    @property
    def layout(self) -> Layout:
        return Layout(len(self.lights))

    @property
    def own_lights(self) -> Float:
        """(l, 4) in the body's own frame."""
        return self.body.place.lights(self.lights)

    @property
    def to_lights_marker(self) -> list[Float]:
        """(3,) unit vectors: the lights' directions, which is all of a light that is far away."""
        return [normalised(np.array([*slant, 1.0])) for slant in numbers_of(self.lights)]

    def moved(self, step: Float) -> "LitBody":
        """By a step (split + q,) in theta; what is longer is longer for others' sake."""
        layout = self.layout
        theta = layout.theta(self.lights, self.body.shape)
        theta = theta + step[: len(theta)]
        return replace(self, lights=layout.lights_of(theta), body=replace(self.body, shape=layout.shape_of(theta)))
