"""Lights, and what an estimator answers: the light of one frame, or why there is none; and a clock for its stages."""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from ashe_live.core import arguments
from ashe_live.core.arrays import Float, Mask, frozen_floats, read_only_copies, set_frozen, set_given_frozen, set_views
from ashe_live.core.proxy import Proxy
from ashe_live.core.ranges import ANGLE, ANGULAR_SIZE, INVERSE_DISTANCE, LAMP_RADIUS, SHARE
from ashe_live.core.transforms import angles_from_direction, normalised
from ashe_live.core.types import TrackedFrame

LEAST_INVERSE_DISTANCE = 1e-100  # 1/m: what is farther away counts as a sun, as squares of smaller numbers are 0
LEAST_REST = 1e-6  # share of all other light by which a lamp's is divided
LEAST_SINE = 1e-9  # of a light's elevation: one that is lower is in the plane, as it has no shadow that can be computed


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class Light:
    """A sun or a lamp, with the uncertainty of its direction. What was not measured is None.

    A sun is a light at infinity: its inverse distance is 0, while a lamp's is positive. Nothing else differs.

    to_light_marker: (3,) unit, marker frame, from the marker's centre towards the light; given at any length.
    covariance_rad2: (2, 2) on the tangent basis: larger azimuth, larger elevation.
    sigma_rad: radius that contains the truth with probability 0.68.
    confidence: P(angular error < 10 degrees).
    angular_size_rad: the source's angular diameter, seen from the marker's centre.
    shadow_rgb_ratio: (3,) linear RGB, shadowed over lit ground. Of an estimated lamp, whose light falls off, it holds
    where the shadow was measured, and `intensity_rgb_ratio` at the marker's centre; of any other light it holds there
    as well.
    inverse_distance: 1/m, one over a lamp's distance from the marker's centre; 0 for a sun.
    lamp_covariance: (3, 3) on (larger azimuth, larger elevation, larger inverse distance): rad, rad and 1/m.
    radius_m: of a lamp's bulb or shade.
    intensity_rgb_ratio: (3,) linear RGB, of a lamp: its irradiance on the plane at the marker's centre, over that of
    all other light.

    Raises ValueError for a direction of length 0, an array of another shape, a number beyond its range (core/ranges.py)
    and a covariance that is not symmetric or has a negative variance, TypeError for what is no number.
    """

    to_light_marker: Float
    covariance_rad2: Float | None = None
    sigma_rad: float | None = None
    confidence: float | None = None
    angular_size_rad: float | None = None
    shadow_rgb_ratio: Float | None = None
    inverse_distance: float = 0.0
    lamp_covariance: Float | None = None
    radius_m: float | None = None
    intensity_rgb_ratio: Float | None = None

    def __post_init__(self) -> None:
        given = frozen_floats(self.to_light_marker, (3,), "to_light_marker")
        if not given.any():
            raise ValueError("to_light_marker has no direction")
        direction = normalised(given)
        direction[2] = direction[2] if abs(direction[2]) > LEAST_SINE else 0.0
        set_frozen(self, to_light_marker=frozen_floats(direction, (3,), "to_light_marker"))
        sizes = {"angular_size_rad": ANGULAR_SIZE, "radius_m": LAMP_RADIUS}
        arguments.set_given_numbers(self, sigma_rad=ANGLE, confidence=SHARE, **sizes)
        nearness = INVERSE_DISTANCE.checked(self.inverse_distance, "inverse_distance")
        set_frozen(self, inverse_distance=0.0 if nearness < LEAST_INVERSE_DISTANCE else nearness)
        arguments.set_given_covariances(self, covariance_rad2=2, lamp_covariance=3)
        set_given_frozen(self, shadow_rgb_ratio=(3,), intensity_rgb_ratio=(3,))

    @property
    def azimuth_deg(self) -> float:
        """From x towards y of the marker's frame, in [0, 360)."""
        return math.degrees(angles_from_direction(self.to_light_marker)[0])

    @property
    def elevation_deg(self) -> float:
        """Above the marker's plane; negative below it."""
        return math.degrees(angles_from_direction(self.to_light_marker)[1])

    @property
    def kind(self) -> str:
        """ "lamp" for a light near by, "directional" for a sun."""
        return "lamp" if self.inverse_distance > 0 else "directional"

    @property
    def position_marker_m(self) -> Float | None:
        """(3,) position of a lamp, metres, marker frame; None for a sun."""
        if self.inverse_distance == 0:
            return None
        return np.asarray(self.to_light_marker / self.inverse_distance)

    @property
    def homogeneous(self) -> Float:
        """(4,) the light as a point (x, y, z, w), marker frame, metres: w = 0 for a sun."""
        return np.array([*self.to_light_marker, self.inverse_distance])

    @property
    def ground_rgb_ratio(self) -> Float | None:
        """(3,) linear RGB, level ground at the marker's centre without this light over that with all; None: unknown."""
        if self.intensity_rgb_ratio is not None:
            return np.asarray(1 / (1 + np.maximum(self.intensity_rgb_ratio, 0.0)))
        return self.shadow_rgb_ratio

    def with_ground_share(self, ground_share: Float) -> Self:
        """The light that gives `ground_share` (3,) of all light on level ground; a lamp with an intensity, by that."""
        if self.intensity_rgb_ratio is None:
            return replace(self, shadow_rgb_ratio=1 - ground_share)
        return replace(self, intensity_rgb_ratio=ground_share / np.maximum(1 - ground_share, LEAST_REST))

    def with_angular_size(self, angular_size_rad: float | None) -> Self:
        """The light with this angular diameter, seen from the marker's centre; a lamp's radius is made to fit."""
        radius_m = self.radius_m
        if angular_size_rad is not None and self.inverse_distance > 0:
            radius_m = math.tan(angular_size_rad / 2) / self.inverse_distance
        return replace(self, angular_size_rad=angular_size_rad, radius_m=radius_m)

    def elsewhere(self, to_light_marker: Float, inverse_distance: float) -> Self:
        """The light in another direction (3,); a lamp at another inverse distance (1/m), as large as it looks there."""
        size_rad = self.angular_size_rad
        if self.radius_m is not None and inverse_distance > 0:
            size_rad = 2 * math.atan(self.radius_m * inverse_distance)
        return replace(
            self, to_light_marker=to_light_marker, inverse_distance=inverse_distance, angular_size_rad=size_rad
        )


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class Illumination:
    """The light of a scene, whether it was estimated, set by hand or made up by a program.

    lights: strongest first (but last, a light whose shadow a known body hides). Empty: the sky alone, no shadows.
    ambient_rgb_ratio: (3,) linear RGB, ground that none of `lights` reaches, over lit ground.
    ground_rgb: (3,) linear RGB, the lit ground's mean colour in the video.
    real_object: approximates the real object, which casts shadows and occludes the model. It stands below the plane
    z = 0 where several views tell that the marker lies above the ground.
    seen_in: the frame, with a marker, that polished surfaces mirror, whose white turns `ground_rgb` into an albedo, and
    that shows the outline up to which the real object hides models. None: they mirror even ground under an overcast
    sky, and the object is drawn as it was fitted.
    sky_slope_rgb: (2, 3) linear RGB, the lean of the sky: beyond the light of an even sky, a surface of normal n gets
    n_x times the first row plus n_y times the second, relative to all light on level ground. None: an even sky.
    as_read: the illumination as it was when `seen_in` was read: in the frame of the marker as it lay there, where it
    has been moved since, and in the lights of then, where these are others (`relit`). None: it is this one.

    Raises ValueError for an array of another shape and for a frame without a marker, TypeError for what is no such
    object.
    """

    lights: tuple[Light, ...] = ()
    ambient_rgb_ratio: Float | None = None
    ground_rgb: Float | None = None
    real_object: Proxy | None = None
    seen_in: TrackedFrame | None = None
    sky_slope_rgb: Float | None = None
    as_read: "Illumination | None" = None

    def __post_init__(self) -> None:
        for light in arguments.instance(self.lights, tuple, "lights"):
            arguments.instance(light, Light, "each of lights")
        set_given_frozen(self, ambient_rgb_ratio=(3,), ground_rgb=(3,), sky_slope_rgb=(2, 3))
        if self.real_object is not None:
            arguments.instance(self.real_object, Proxy, "real_object")
        if self.seen_in is not None and arguments.instance(self.seen_in, TrackedFrame, "seen_in").marker is None:
            raise ValueError("without a marker in it, a frame does not show where the ground is")

    @property
    def light(self) -> Light | None:
        """The strongest light, or None if there is only the sky."""
        return self.lights[0] if self.lights else None

    def as_seen_in(self, tracked: TrackedFrame | None) -> Self:
        """A copy that was seen in `tracked`; as seen nowhere if that is None or has no marker. Details: `seen_in`."""
        if tracked is not None and arguments.instance(tracked, TrackedFrame, "tracked").marker is None:
            tracked = None
        return replace(self, seen_in=tracked)

    def relit(self, lights: tuple[Light, ...], ambient_rgb_ratio: Float | None) -> Self:
        """A copy in other lights, set by hand or on their way; what is read in the picture it was seen in stays."""
        as_read = None if self.seen_in is None else self.as_read or self
        return replace(self, lights=lights, ambient_rgb_ratio=ambient_rgb_ratio, as_read=as_read)


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class LightEstimate:
    """An estimator's answer to one frozen frame: the light, and how it was found; or the `reason` why there is none.

    estimator: its name, "proxy" or "paper".
    frame_index: of the frame that it answers for, as `frame.index` of a TrackedFrame.
    illumination: with `seen_in` None; the caller adds the frame by `Illumination.as_seen_in`.
    reason: a message for the user, e.g. "no shadow found beside the object"; without a light there always is one.
    object_mask, shadow_mask: (h, w) bool at the estimator's working size; None where nothing was found.
    timing_ms: by stage, with "total".
    views: indices of the frames that the answer rests on, `frame_index` first.
    span_rad: the largest angle between their directions of view to the marker; None: one view.

    Raises ValueError where there is neither a light nor a reason, and where `views` do not begin with `frame_index`.
    """

    estimator: str
    frame_index: int
    illumination: Illumination
    reason: str | None = None
    object_mask: Mask | None = None
    shadow_mask: Mask | None = None
    timing_ms: Mapping[str, float] = field(default_factory=dict)
    views: tuple[int, ...] = ()
    span_rad: float | None = None

    def __post_init__(self) -> None:
        arguments.instance(self.illumination, Illumination, "illumination")
        if not self.lights and not self.reason:
            raise ValueError("an estimate without a light needs a reason")
        set_frozen(self, views=tuple(self.views) or (self.frame_index,))
        set_views(self, "object_mask", "shadow_mask")
        if self.views[0] != self.frame_index:
            raise ValueError(f"the first view of frame {self.frame_index} is itself, not {self.views[0]}")
        if self.span_rad is not None:
            ANGLE.checked(self.span_rad, "span_rad")

    @property
    def light(self) -> Light | None:
        """The strongest light, or None for "no directional light"."""
        return self.illumination.light

    @property
    def lights(self) -> tuple[Light, ...]:
        """As `Illumination.lights`."""
        return self.illumination.lights


class StageClock:
    """Measures milliseconds by stage from its creation on; the time between two `end`s belongs to the second's."""

    def __init__(self) -> None:
        self._begin = self._last = time.perf_counter()
        self._stages: dict[str, float] = {}

    def end(self, stage: str) -> None:
        """Books the time since the last `end` under `stage`."""
        now = time.perf_counter()
        self._stages[stage] = self._stages.get(stage, 0.0) + 1000 * (now - self._last)
        self._last = now

    def timing_ms(self) -> dict[str, float]:
        """Milliseconds by stage, and as "total" those since the beginning."""
        return {**self._stages, "total": 1000 * (time.perf_counter() - self._begin)}
