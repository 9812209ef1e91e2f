"""The values that are passed between the parts: immutable and checked, with the shape, unit and frame of each field.

A source gives Frames, the tracker makes TrackedFrames of them, an estimator answers with a LightEstimate
(`light_estimate.py`), whose Illumination the renderer draws in.
"""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from ashe_live.core import arguments
from ashe_live.core.arrays import Float, Image, frozen_floats, frozen_view, set_frozen, set_given_frozen
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.core.ranges import ANGLE, INVERSE_DISTANCE, LAMP_RADIUS, MARKER_SIDE, SHARE
from ashe_live.core.square import PlaneMarker
from ashe_live.core.transforms import angles_from_direction, normalised

# 1/m: what is farther away than that counts as a sun, as the squares of smaller numbers are 0.
LEAST_INVERSE_DISTANCE = 1e-100


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One picture of a source: (h, w, 3) uint8 sRGB, OpenCV's channel order, read-only.

    index, time_s: 0 for the source's first frame; the time since then, at capture.
    """

    image_bgr: Image
    index: int
    time_s: float

    def __post_init__(self) -> None:
        set_frozen(self, image_bgr=frozen_view(arguments.picture(self.image_bgr, "image_bgr")))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.image_bgr.shape[1], self.image_bgr.shape[0]


@dataclass(frozen=True, slots=True, eq=False)
class MarkerPose:
    """Where the marker stands in front of the camera, and how well that explains its corners.

    T_cam_marker: (4, 4) rigid, marker to camera frame, metres; smoothed by the tracker's filter.
    corners_px: (4, 2) source pixels: top-left, top-right, bottom-right, bottom-left of the upright print.
    side_m: of the black square.
    reprojection_rms_px, other_rms_px: of the corners by this pose, one of IPPE's two solutions, and by the other one;
    None when there is only one.
    covariance, noise_covariance: (6, 6) of (w, v), camera axes, rad and m: R' = exp(w) R, t' = t + v; and the part of
    it that changes from frame to frame.
    unfiltered_T_cam_marker: (4, 4) from this frame alone; None: T_cam_marker is unfiltered.
    bridged: the marker could not be read: its corners were followed from an earlier frame.
    body: what the marker is printed on (the paper cube), standing on the plane z = 0; None for a flat marker. With a
    body, `side_m` is its edge, and `corners_px` are the corners of a square of that side on the plane, centred on the
    origin, whether it can be seen or not.
    pose_shape_errors: how pose and body may be off; of the pose it is `covariance`.
    """

    T_cam_marker: Float
    corners_px: Float
    side_m: float
    reprojection_rms_px: float
    other_rms_px: float | None
    covariance: Float | None = None
    noise_covariance: Float | None = None
    unfiltered_T_cam_marker: Float | None = None
    bridged: bool = False
    body: Proxy | None = None
    pose_shape_errors: PoseShapeErrors | None = None

    def __post_init__(self) -> None:
        set_frozen(
            self,
            T_cam_marker=frozen_floats(self.T_cam_marker, (4, 4), "T_cam_marker"),
            corners_px=frozen_floats(self.corners_px, (4, 2), "corners_px"),
        )
        set_given_frozen(self, covariance=(6, 6), noise_covariance=(6, 6), unfiltered_T_cam_marker=(4, 4))
        MARKER_SIDE.checked(self.side_m, "side_m")

    @property
    def measured_T_cam_marker(self) -> Float:
        """(4, 4) the pose measured in this frame alone, without the filter."""
        return self.T_cam_marker if self.unfiltered_T_cam_marker is None else self.unfiltered_T_cam_marker


@dataclass(frozen=True, slots=True, eq=False)
class TrackedFrame:
    """A frame and the pose measured in it: one object, so that video and model are never out of step.

    frame: the picture (`image_bgr`), its `index`, `time_s` and `size`.
    camera: of this frame's size.
    marker: its pose; None: no marker in this frame.
    detect_ms: how long it was looked for.
    note: a message for the user, e.g. that two equal markers are in view.
    others: further markers on the same plane: those asked for that are in this frame.
    T_room_marker: (4, 4) rigid, metres, from the marker's frame to the room's, which is that of the marker where it lay
    at first. It is the same array until the marker itself is moved. None: nobody has followed it, and it counts as
    unmoved.
    clean_plate_bgr: (h, w, 3) uint8 sRGB: the same view without the object, by a camera that stood still; None: none.
    """

    frame: Frame
    camera: Camera
    marker: MarkerPose | None
    detect_ms: float = 0.0
    note: str | None = None
    others: tuple[PlaneMarker, ...] = ()
    T_room_marker: Float | None = None
    clean_plate_bgr: Image | None = None

    def __post_init__(self) -> None:
        arguments.instance(self.frame, Frame, "frame")
        arguments.instance(self.camera, Camera, "camera")
        if self.marker is not None:
            arguments.instance(self.marker, MarkerPose, "marker")
        set_given_frozen(self, T_room_marker=(4, 4))
        if self.camera.size != self.frame.size:
            raise ValueError(f"a camera for {self.camera.size} cannot explain a frame of {self.frame.size}")
        if self.clean_plate_bgr is not None:
            plate = frozen_view(arguments.picture(self.clean_plate_bgr, "clean_plate_bgr"))
            if plate.shape != self.frame.image_bgr.shape:
                raise ValueError(f"a clean plate of {plate.shape[1::-1]} is no picture of a frame of {self.frame.size}")
            set_frozen(self, clean_plate_bgr=plate)


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
        direction = frozen_floats(self.to_light_marker, (3,), "to_light_marker")
        if not direction.any():
            raise ValueError("to_light_marker has no direction")
        set_frozen(self, to_light_marker=frozen_floats(normalised(direction), (3,), "to_light_marker"))
        for name, allowed in (("sigma_rad", ANGLE), ("confidence", SHARE), ("angular_size_rad", ANGLE)):
            if getattr(self, name) is not None:
                allowed.checked(getattr(self, name), name)
        if INVERSE_DISTANCE.checked(self.inverse_distance, "inverse_distance") < LEAST_INVERSE_DISTANCE:
            set_frozen(self, inverse_distance=0.0)
        if self.radius_m is not None:
            LAMP_RADIUS.checked(self.radius_m, "radius_m")
        set_given_frozen(self, covariance_rad2=(2, 2), lamp_covariance=(3, 3))
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

    def with_angular_size(self, angular_size_rad: float | None) -> Self:
        """The light with this angular diameter, seen from the marker's centre; a lamp's radius is made to fit."""
        radius_m = self.radius_m
        if angular_size_rad is not None and self.inverse_distance > 0:
            radius_m = math.tan(angular_size_rad / 2) / self.inverse_distance
        return replace(self, angular_size_rad=angular_size_rad, radius_m=radius_m)

    def elsewhere(self, to_light_marker: Float, inverse_distance: float) -> Self:
        """The light in another direction (3,) and, of a lamp, at another distance (1/m), as large as it looks there."""
        size_rad = self.angular_size_rad
        if self.radius_m is not None and inverse_distance > 0:
            size_rad = 2 * math.atan(self.radius_m * inverse_distance)
        return replace(
            self, to_light_marker=to_light_marker, inverse_distance=inverse_distance, angular_size_rad=size_rad
        )


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
        """A copy in which polished surfaces mirror `tracked`, or even ground if that is None or has no marker."""
        if tracked is not None and arguments.instance(tracked, TrackedFrame, "tracked").marker is None:
            tracked = None
        return replace(self, seen_in=tracked)

    def relit(self, lights: tuple[Light, ...], ambient_rgb_ratio: Float | None) -> Self:
        """A copy in other lights, set by hand or on their way; what is read in the picture it was seen in stays."""
        as_read = None if self.seen_in is None else self.as_read or self
        return replace(self, lights=lights, ambient_rgb_ratio=ambient_rgb_ratio, as_read=as_read)
