"""Bodies on the ground and the lights that they stand in: geometry in the marker frame, independent of any camera."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.light.shape.family import Family, Members, padded
from ashe_live.light.shape.layout import ParameterLayout, nearness_of
from ashe_live.light.shape.light_points import towards

HIGHEST_NEARNESS = 0.4  # of a lamp, times half the height of the body below it


@dataclass(frozen=True, slots=True, eq=False)
class BodyFrame:
    """The body frame, in which a family's parameters are given: upright, on the ground, its unit the body's size."""

    origin_marker: Float  # (2,) metres, on the ground
    unit_m: float

    @property
    def T_marker_body(self) -> Float:
        """(4, 4) similarity transform from the body frame to the marker frame."""
        M = np.diag([self.unit_m, self.unit_m, self.unit_m, 1.0])
        M[:2, 3] = self.origin_marker
        return M

    def lights(self, lights_marker: Float) -> Float:
        """(l, 4) lights of the marker frame, transformed to the body frame."""
        in_body_frame = lights_marker.copy()
        in_body_frame[:, :2] -= lights_marker[:, 3:] * self.origin_marker
        in_body_frame[:, 3] *= self.unit_m
        return in_body_frame

    def lights_marker(self, lights: Float) -> Float:
        """(l, 4) lights of the body frame, transformed to the marker frame: the inverse of `lights`."""
        in_marker_frame = lights.copy()
        in_marker_frame[:, 3] /= self.unit_m
        in_marker_frame[:, :2] += in_marker_frame[:, 3:] * self.origin_marker
        return in_marker_frame


@dataclass(frozen=True, eq=False)
class Body:
    """A member of a family, somewhere on the ground."""

    frame: BodyFrame
    family: Family
    shape: Float  # (q,) the family's parameters

    @cached_property
    def spheroids(self) -> Float:
        """(k, 5) centre x, y, z, horizontal radius, half height, in the body frame."""
        spheroids: Float = self.family.parts(self.shape[None])[0][0]
        spheroids[:, 3:] = np.abs(spheroids[:, 3:])  # radii enter squared, so their signs have no meaning
        return spheroids

    @property
    def height(self) -> float:
        """Of its highest point, in the body frame."""
        return float((self.spheroids[:, 2] + self.spheroids[:, 4]).max())

    @cached_property
    def proxy(self) -> Proxy:
        """The body as a proxy in the marker frame, metres."""
        spheroids = self.spheroids * self.frame.unit_m
        spheroids[:, :2] += self.frame.origin_marker
        return Proxy(self.family.name, spheroids)

    @property
    def middle_m(self) -> float:
        """Half of the body's height."""
        return 0.5 * self.proxy.height_m


def members_of(several: Sequence[Body]) -> Members:
    """The bodies without their frames."""
    return Members([one.family for one in several], padded([one.shape for one in several]))


@dataclass(frozen=True, eq=False)
class LitBody:
    """What a fit varies: a body, and the lights that cast its shadows."""

    body: Body
    lights: Float  # (l, 4) homogeneous points, marker frame

    @property
    def layout(self) -> ParameterLayout:
        return ParameterLayout(len(self.lights))

    @cached_property
    def lights_in_body_frame(self) -> Float:
        """(l, 4) the lights in the body frame."""
        return self.body.frame.lights(self.lights)

    @property
    def to_lights_marker(self) -> list[Float]:
        """(3,) unit vectors from the body frame's origin towards the lights, marker frame."""
        origin = np.array([*self.body.frame.origin_marker, 0.0])
        return [towards(light, origin) for light in self.lights]

    def with_first_light_near(self, nearness: float) -> "LitBody":
        """With the first light at the nearness w / z (1/m, marker frame), in the direction that the body's middle sees.

        A lamp not well above the body's top would cast no finite shadow; it is moved up.
        """
        lights = self.lights / self.lights[:, 2:3]
        lights[0] = self.first_light_near([nearness])[0]
        return replace(self, lights=lights)

    def first_light_near(self, nearnesses: Sequence[float]) -> Float:
        """(k, 4) the first light, z = 1, at each of k nearnesses, as by `with_first_light_near`."""
        origin, middle = self.body.frame.origin_marker, self.body.middle_m
        near = np.minimum(nearnesses, HIGHEST_NEARNESS / max(middle, 1e-9))[:, None]
        x, y, z, w = self.lights[0]
        seen = (np.array([x, y]) / z - w / z * origin) / (1 - w / z * middle)
        return np.hstack([seen * (1 - near * middle) + near * origin, np.ones_like(near), near])

    def stretched(self, factor: float) -> "LitBody | None":
        """So many times as high, in lights so much higher that the shadows on the ground stay; None for a fixed shape.

        A shadow keeps its place, as a point (x, y, z) and its light (X, Y, Z) give that of (x, y, f z) and (X, Y, f Z).
        """
        heights = list(self.body.family.heights)
        if not heights:
            return None
        shape, lights = self.body.shape.copy(), self.lights.copy()
        shape[heights] += math.log(factor)
        lights[:, 2] *= factor
        return replace(self, body=replace(self.body, shape=shape), lights=lights / lights[:, 2:3])

    def moved(self, step: Float, with_nearness: bool = False) -> "LitBody":
        """After a step in theta; a step longer than (split + q,) is padded for others of its batch, and cut.

        with_nearness: as in the ParameterLayout of theta; else the nearness of lamps stays.
        """
        layout, before = ParameterLayout(len(self.lights), with_nearness), self.lights_in_body_frame
        theta = layout.theta(before, self.body.shape)
        theta = theta + step[: len(theta)]
        body = replace(self.body, shape=layout.shape_of(theta))
        lights = layout.lights_of(theta, nearness_of(before))
        if with_nearness:
            highest = 2 * HIGHEST_NEARNESS / max(body.height, 1e-9)
            lights[:, 3] = np.clip(lights[:, 3], 0.0, highest)
        return replace(self, lights=self.body.frame.lights_marker(lights), body=body)


@dataclass(frozen=True, slots=True)
class NearnessPrior:
    """A normal distribution of a light's nearness w / z (1/m), before outlines are seen."""

    mean: float
    sigma: float

    def applied(self, bodies: Sequence[LitBody]) -> tuple[Float, Float]:
        """(n,) information on the first light's nearness in each body's frame; (n,) the gradient towards the mean."""
        unit_m = np.array([one.body.frame.unit_m for one in bodies])
        here = np.array([float(nearness_of(one.lights)[0]) for one in bodies])
        information = 1 / (self.sigma * unit_m) ** 2
        return information, information * (self.mean - here) * unit_m
