"""Makes camera and tracker from the options that several commands share."""

import argparse
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from ashe_live.capture.opening import openable
from ashe_live.capture.photo import PhotoSource
from ashe_live.capture.sources import Source
from ashe_live.commands.flags.model_choice import other_markers
from ashe_live.core.camera import Camera, Size, fitted, read_camera_file
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.models.caster import read_caster
from ashe_live.process.messages import print_message
from ashe_live.quality import BALANCED, QUALITIES, Quality
from ashe_live.tracking.families.layout import Layout, is_of_cube, parse_target, usual_side_m
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.tracking.focal_tracker import FocalTracker
from ashe_live.tracking.plane_markers import PlaneMarkers
from ashe_live.tracking.tracker import MarkerTracker

CameraFor = Callable[[Size], Camera]


def quality_of(options: argparse.Namespace) -> Quality:
    """The quality that the options name; `auto` starts with the one in the middle."""
    return QUALITIES.get(options.quality, BALANCED)


def light_preset(options: argparse.Namespace) -> ProxyPreset:
    """The estimator's preset, with the kind of light that is assumed and the caster of --caster.

    Raises UserError for a caster that cannot be.
    """
    caster = None if options.caster is None else read_caster(options.caster)
    return quality_of(options).light.assuming(options.light, caster)


def camera_chooser(options: argparse.Namespace) -> CameraFor:
    """The camera for frames of a size, from --camera-file, --focal-px or --hfov, or assumed."""
    if options.camera_file is not None:
        calibrated = read_camera_file(options.camera_file)
        return lambda size: fitted(calibrated, size, f"the calibration {options.camera_file}")
    if options.focal_px is not None:
        return StatedFocal(options.focal_px)
    if options.hfov is not None:
        return lambda size: Camera.from_hfov(size, options.hfov)
    return AssumedCamera()


class StatedFocal:
    """A camera with a stated focal length for frames of any size; warns when they are not all of one size.

    A focal length in pixels holds for one size: for others the answers would be sure and wrong.
    """

    def __init__(self, focal_px: float) -> None:
        self._focal_px = focal_px
        self._first: Size | None = None
        self._is_said = False

    def __call__(self, size: Size) -> Camera:
        self._first = self._first or size
        if not self._is_said and sorted(size) != sorted(self._first):  # upright and across are the same camera
            self._is_said = True
            sizes = " as well as of ".join(f"{width}x{height}" for width, height in (size, self._first))
            print_message(
                f"--focal-px {self._focal_px:g} is taken for pictures of {sizes}: --hfov fits those of any size"
            )
        return Camera.from_focal(size, self._focal_px)


class AssumedCamera:
    """A camera for frames of any size about which nothing is known."""

    def __call__(self, size: Size) -> Camera:
        return Camera.assumed(size)


def assumed_note(tracked: TrackedFrame) -> str | None:
    """What is to be said of a frame whose camera is assumed although there is a marker; None: nothing."""
    if tracked.marker is None or tracked.camera.source != "assumed":
        return None
    return (
        f"the camera's field of view is not known: where the marker does not show it, {tracked.camera.hfov_deg:.0f} "
        "degrees are assumed; give it by --hfov, --focal-px or --camera-file"
    )


def make_tracker(
    options: argparse.Namespace,
    camera_for: CameraFor | None = None,
    memory: FocalMemory | None = None,
    source: Source | None = None,
    marker: Marker | Layout | None = None,
) -> MarkerTracker:
    """A tracker. It learns the focal length if nobody gave it, and recalls it from and keeps it in `memory`.

    `source`: may be a photo that states it. `marker`: what --marker names, if its file has been read already.
    Raises UserError for a marker or a camera that cannot be, and for the paper cube beside --caster.
    """
    if options.caster is not None and is_of_cube(options.marker):
        raise UserError("the paper cube casts the shadow that is looked for", "leave out --caster")
    marker = marker or parse_target(options.marker)
    camera_for = camera_for or camera_chooser(options)
    side_m = usual_side_m(options.marker) if options.marker_size is None else options.marker_size
    preset = quality_of(options).tracking
    tracker = (
        FocalTracker(marker, camera_for, side_m, preset, memory)
        if isinstance(camera_for, AssumedCamera)
        else MarkerTracker(marker, camera_for, side_m, preset)
    )
    if isinstance(tracker, FocalTracker) and isinstance(source, PhotoSource) and source.focal_px is not None:
        tracker.use_stated(Camera.from_focal(source.size, source.focal_px, "exif"))
    tracker.filters = not options.no_filter
    tracker.others = PlaneMarkers(other_markers(options))
    return tracker


def cameras_of_all(paths: Sequence[Path], options: argparse.Namespace, camera_for: CameraFor) -> dict[Size, Camera]:
    """The cameras that the photos of each size determine together; none where `camera_for` knows them already."""
    cameras: dict[Size, Camera] = {}
    if not isinstance(camera_for, AssumedCamera):
        return cameras
    trackers: dict[Size, MarkerTracker] = {}
    for source in openable(paths):
        if not states_no_camera(source):
            continue
        tracker = trackers.setdefault(source.size, make_tracker(options, camera_for))
        with suppress(Exception):  # the photo's own line in the answer says so
            frame = source.read()
            assert frame is not None
            cameras[source.size] = tracker.track(frame).camera
        tracker.reset()
    return cameras


def states_no_camera(source: Source) -> bool:
    """Whether the source is a photo whose EXIF data tell no focal length."""
    return isinstance(source, PhotoSource) and source.focal_px is None
