"""The values that are passed between the parts: immutable and checked, with the shape, unit and frame of each field.

A source gives Frames, the tracker makes TrackedFrames of them, an estimator answers with a LightEstimate (`light.py`),
whose Illumination the renderer draws in.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core import arguments
from ashe_live.core.arrays import (
    Float,
    GivenImage,
    Image,
    frozen_floats,
    frozen_view,
    read_only_copies,
    set_frozen,
    set_given_frozen,
)
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.core.ranges import INDEX, MARKER_SIDE, TIME
from ashe_live.core.square import PlaneMarker

RIGID_WITHIN = 0.02  # of products of axes: a matrix that was written down with two decimals is off by 0.0174 at most


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One picture of a source.

    image_bgr: (h, w, 3) uint8 sRGB, OpenCV's channel order, read-only.
    index, time_s: 0 for the source's first frame; the time since then, at capture, seconds.

    Raises TypeError for what is no array or number, ValueError for an array of another shape or type, and for a number
    beyond its range (core/ranges.py).
    """

    image_bgr: Image
    index: int
    time_s: float

    if TYPE_CHECKING:  # OpenCV's types do not say that pictures are uint8

        def __init__(self, image_bgr: GivenImage, index: int, time_s: float) -> None: ...

    def __post_init__(self) -> None:
        set_frozen(
            self,
            image_bgr=frozen_view(arguments.picture(self.image_bgr, "image_bgr")),
            index=arguments.whole_number(self.index, INDEX, "index"),
            time_s=TIME.checked(self.time_s, "time_s"),
        )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.image_bgr.shape[1], self.image_bgr.shape[0]


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class MarkerPose:
    """Where the marker stands in front of the camera, and how well that explains its corners.

    T_cam_marker: (4, 4) rigid, marker to camera frame, metres; smoothed by the tracker's filter.
    corners_px: (4, 2) source pixels: top-left, top-right, bottom-right, bottom-left of the upright print.
    side_m: of the black square, metres.
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

    Raises ValueError for an array of another shape, for what is not finite or, as a pose that scales or mirrors, not
    rigid, for a covariance that is not symmetric or has a negative variance, and for a side beyond MARKER_SIDE;
    TypeError for what is no number in these and for another kind of body.
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

    if TYPE_CHECKING:  # a calibration's arrays may be of any kind of number, or lists

        def __init__(
            self,
            T_cam_marker: ArrayLike,
            corners_px: ArrayLike,
            side_m: float,
            reprojection_rms_px: float,
            other_rms_px: float | None,
            covariance: ArrayLike | None = ...,
            noise_covariance: ArrayLike | None = ...,
            unfiltered_T_cam_marker: ArrayLike | None = ...,
            bridged: bool = ...,
            body: Proxy | None = ...,
            pose_shape_errors: PoseShapeErrors | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        set_frozen(
            self,
            T_cam_marker=frozen_floats(self.T_cam_marker, (4, 4), "T_cam_marker"),
            corners_px=frozen_floats(self.corners_px, (4, 2), "corners_px"),
        )
        arguments.set_given_covariances(self, covariance=6, noise_covariance=6)
        set_given_frozen(self, unfiltered_T_cam_marker=(4, 4))
        _check_rigid(self.T_cam_marker, "T_cam_marker")
        _check_rigid(self.unfiltered_T_cam_marker, "unfiltered_T_cam_marker")
        set_frozen(self, side_m=MARKER_SIDE.checked(self.side_m, "side_m"))
        if self.body is not None:
            arguments.instance(self.body, Proxy, "body")
        if self.pose_shape_errors is not None:
            arguments.instance(self.pose_shape_errors, PoseShapeErrors, "pose_shape_errors")

    @property
    def measured_T_cam_marker(self) -> Float:
        """(4, 4) the pose measured in this frame alone, without the filter."""
        return self.T_cam_marker if self.unfiltered_T_cam_marker is None else self.unfiltered_T_cam_marker


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class TrackedFrame:
    """A frame and the pose measured in it: one object, so that video and model are never out of step.

    frame: the picture (`image_bgr`), its `index`, `time_s` and `size`.
    camera: of this frame's size.
    marker: its pose; None: no marker in this frame.
    detect_ms: how long it was looked for, milliseconds.
    note: a message for the user, e.g. that two equal markers are in view.
    others: further markers on the same plane: those asked for that are in this frame.
    T_room_marker: (4, 4) rigid, metres, from the marker's frame to the room's, which is that of the marker where it lay
    at first. It is the same array until the marker itself is moved. None: nobody has followed it, and it counts as
    unmoved.
    clean_plate_bgr: (h, w, 3) uint8 sRGB: the same view without the object, by a camera that stood still; None: none.

    Raises ValueError for a camera or a clean plate of another size than the frame and for a T_room_marker that is not
    rigid, TypeError for other kinds of object.
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
        for other in arguments.instance(self.others, tuple, "others"):
            arguments.instance(other, PlaneMarker, "each of others")
        set_given_frozen(self, T_room_marker=(4, 4))
        _check_rigid(self.T_room_marker, "T_room_marker")
        if self.camera.size != self.frame.size:
            raise ValueError(f"a camera for {self.camera.size} cannot explain a frame of {self.frame.size}")
        if self.clean_plate_bgr is not None:
            plate = frozen_view(arguments.picture(self.clean_plate_bgr, "clean_plate_bgr"))
            if plate.shape != self.frame.image_bgr.shape:
                raise ValueError(f"a clean plate of {plate.shape[1::-1]} is no picture of a frame of {self.frame.size}")
            set_frozen(self, clean_plate_bgr=plate)

    @property
    def pose(self) -> MarkerPose:
        """The pose of its marker, where it is known to have one. Raises ValueError where it has none."""
        if self.marker is None:
            raise ValueError("there is no marker in this frame")
        return self.marker


def _check_rigid(T: Float | None, name: str) -> None:
    """Raises ValueError for a (4, 4) that is no rotation and shift: in it a light would be wrong, and surely so."""
    if T is None:
        return
    R = T[:3, :3]
    if np.abs(T[3] - (0, 0, 0, 1)).max() > RIGID_WITHIN:
        raise ValueError(f"{name} needs the last row 0 0 0 1: columns are vectors, and the shift is the last one")
    if np.abs(R.T @ R - np.eye(3)).max() > RIGID_WITHIN:
        raise ValueError(f"{name} is not rigid: its first three columns must be at right angles, each of length 1")
    if np.linalg.det(R) < 0:
        raise ValueError(f"{name} mirrors, and is no rotation: one axis points the wrong way")
