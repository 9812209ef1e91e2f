"""What several commands make of the same options: the camera, the tracker."""

import argparse
import sys
from collections.abc import Callable

from ashe_live.core.camera import ASSUMED_HFOV_DEG, Camera, Size, read_camera_file
from ashe_live.core.quality import BALANCED, QUALITIES, Quality
from ashe_live.errors import UserError
from ashe_live.tracking.markers import parse_marker
from ashe_live.tracking.tracker import Tracker

CameraFor = Callable[[Size], Camera]


def quality_of(options: argparse.Namespace) -> Quality:
    """`auto` starts in the middle."""
    return QUALITIES.get(options.quality, BALANCED)


def camera_chooser(options: argparse.Namespace) -> CameraFor:
    """The camera for frames of a size, from --camera-file, --focal-px or --hfov; says so when it has to assume."""
    if options.camera_file is not None:
        return _calibrated(read_camera_file(options.camera_file), str(options.camera_file))
    if options.focal_px is not None:
        return lambda size: Camera.from_focal(size, options.focal_px)
    if options.hfov is not None:
        return lambda size: Camera.from_hfov(size, options.hfov)
    print(
        f"ashe-live: the camera's field of view is not known, {ASSUMED_HFOV_DEG:g} degrees assumed; "
        "--hfov, --focal-px or --camera-file make it right",
        file=sys.stderr,
    )
    return lambda size: Camera.from_hfov(size, ASSUMED_HFOV_DEG, "assumed")


def make_tracker(options: argparse.Namespace, camera_for: CameraFor | None = None) -> Tracker:
    marker = parse_marker(options.marker)
    return Tracker(marker, camera_for or camera_chooser(options), options.marker_size, quality_of(options).tracking)


def _calibrated(camera: Camera, name: str) -> CameraFor:
    def camera_for(size: Size) -> Camera:
        try:
            return camera.resized(size)
        except ValueError as error:
            raise UserError(f"the calibration {name} does not fit ({error})", "calibrate at this shape") from error

    return camera_for
