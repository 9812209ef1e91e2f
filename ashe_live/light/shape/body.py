"""A body on the ground and the shadows that it casts: a member of a family, placed in the frame of a first guess."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import normalised
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.family import Family, padded, parts_of
from ashe_live.light.shape.first_guess import FirstGuess
from ashe_live.light.shape.predicted import AROUND, outlines
from ashe_live.light.shape.supports import outline_points

LARGE_PX = 5e3


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
        """By a step (2 l + q,) in slants and shape; what is longer is longer for others' sake."""
        split = self.slants.size
        end = split + len(self.shape)
        return replace(self, slants=self.slants + step[:split].reshape(-1, 2), shape=self.shape + step[split:end])


def outlines_of(bodies: Sequence[Body], views: Sequence[View]) -> list[list[Float | None]]:
    """As `predicted.outlines` of each in its view, in less time than one after the other takes.

    All have equally many lights.
    """
    seen = zip(bodies, views, strict=True)
    P = np.array([body.guess.seen_by(view.camera, view.T_cam_marker).P for body, view in seen])
    parts, _ = parts_of([body.family for body in bodies], padded([body.shape for body in bodies]))
    clouds = outline_points(P, parts, np.array([body.slants for body in bodies]), AROUND).astype(np.float32)
    # What seems very large may go on behind the camera, which takes a closer look.
    are_large = ~(np.abs(clouds).max(axis=(1, 2, 3, 4)) < LARGE_PX)
    return [
        outlines(body.proxy, body.to_lights_marker, view) if is_large else [_hull(cloud) for cloud in own]
        for body, view, own, is_large in zip(bodies, views, clouds, are_large, strict=True)
    ]


def _hull(cloud: Float32) -> Float:
    """(m, 2) of (k, around, 2) points."""
    return np.asarray(cv2.convexHull(cloud.reshape(-1, 2))[:, 0], dtype=np.float64)
