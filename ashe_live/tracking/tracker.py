"""Follows one marker from frame to frame."""

import time
from collections.abc import Callable

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera, Size
from ashe_live.core.quality import TrackingPreset
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.tracking.corners import refined_corners, side_lengths_px
from ashe_live.tracking.markers import Marker
from ashe_live.tracking.pose import estimate_pose
from ashe_live.tracking.quads import MIN_SIDE_PX

# After so long without the marker, its last pose says nothing about the next one.
MEMORY_S = 0.5
# The region searched first: the last corners' bounding box, grown on each side by this part of its longer side.
REGION_MARGIN = 0.6
# A larger marker is scaled down to this for the search in the region; it is refined at full resolution anyway.
REGION_MARKER_PX = 96.0
# Between two frames the marker does not become smaller than this part of itself.
SMALLEST_NEAR = 0.6
# At the scale of the search, how far a marker's coarse corners may be off.
COARSE_PX = 1.0


class Tracker:
    """Finds the marker in each frame and its pose, near its last place first. For use by one thread at a time."""

    def __init__(
        self, marker: Marker, camera: Camera | Callable[[Size], Camera], side_m: float, preset: TrackingPreset
    ) -> None:
        """`camera` is scaled to the frames, or asked for by their size; `side_m` is the black square's side."""
        self.marker = marker
        self.side_m = side_m
        self.preset = preset
        self._camera = camera
        self._camera_now: Camera | None = None
        self._last: tuple[float, MarkerPose] | None = None

    def reset(self) -> None:
        """Forgets the last pose: after a rewind or a cut, the next frame has nothing to do with it."""
        self._last = None

    def track(self, frame: Frame) -> TrackedFrame:
        """`frame` with the pose measured in it, or with None when the marker is not in it or cannot be.

        Raises UserError when the camera cannot explain frames of this size.
        """
        start = time.perf_counter()
        camera = self._camera_for(frame.size)
        previous = self._recent(frame.time_s)
        pose = None
        if previous is not None:
            pose = self._pose(self._find_near(frame.image_bgr, previous.corners_px), camera, previous)
        if pose is None:
            pose = self._pose(self._find_anywhere(frame.image_bgr), camera, previous)
        if pose is not None:
            self._last = frame.time_s, pose
        return TrackedFrame(frame, camera, pose, (time.perf_counter() - start) * 1e3)

    def _camera_for(self, size: Size) -> Camera:
        if self._camera_now is None or self._camera_now.size != size:
            self.reset()
            self._camera_now = _resized(self._camera, size) if isinstance(self._camera, Camera) else self._camera(size)
        return self._camera_now

    def _recent(self, time_s: float) -> MarkerPose | None:
        """The last pose, unless it is too old or from after `time_s`."""
        if self._last is None or not 0 <= time_s - self._last[0] <= MEMORY_S:
            return None
        return self._last[1]

    def _pose(self, corners_px: Float | None, camera: Camera, previous: MarkerPose | None) -> MarkerPose | None:
        if corners_px is None:
            return None
        return estimate_pose(corners_px, camera, self.side_m, previous, self.preset.refines_pose)

    def _find_near(self, image_bgr: Image, corners_px: Float) -> Float | None:
        """Source pixels of the corners (4, 2), looked for around `corners_px`."""
        lower, upper = corners_px.min(axis=0), corners_px.max(axis=0)
        extent = float((upper - lower).max())
        height, width = image_bgr.shape[:2]
        left, top = np.clip(lower - REGION_MARGIN * extent, 0, None).astype(int)
        right, bottom = np.clip(upper + REGION_MARGIN * extent, None, (width, height)).astype(int)
        if right - left < 2 or bottom - top < 2:
            return None
        grey = _grey(image_bgr[top:bottom, left:right])
        corners = self._find(
            grey, min(1.0, REGION_MARKER_PX / extent), SMALLEST_NEAR * side_lengths_px(corners_px).min()
        )
        return None if corners is None else corners + np.array((left, top))

    def _find_anywhere(self, image_bgr: Image) -> Float | None:
        grey = _grey(image_bgr)
        scale = min(1.0, self.preset.detection_width_px / grey.shape[1])
        return self._find(grey, scale, MIN_SIDE_PX / scale)

    def _find(self, grey: Image, scale: float, min_side_px: float) -> Float | None:
        """Corners (4, 2) in pixels of `grey`: searched at `scale`, smaller sides passed over, refined without it."""
        if scale == 1:
            corners = next(iter(self.marker.find(grey, min_side_px)), None)
        else:
            height, width = grey.shape
            small_size = max(1, round(width * scale)), max(1, round(height * scale))
            small = np.asarray(cv2.resize(grey, small_size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
            corners = next(iter(self.marker.find(small, min_side_px * scale)), None)
            if corners is not None:
                corners = (corners + 0.5) * (np.array((width, height)) / small_size) - 0.5
        if corners is None:
            return None
        return refined_corners(grey, corners, self.preset.edge_samples, off_by_px=COARSE_PX / scale)


def _resized(camera: Camera, size: Size) -> Camera:
    try:
        return camera.resized(size)
    except ValueError as error:
        raise UserError(
            f"the camera does not fit the picture: {error}", "calibrate at the same aspect ratio"
        ) from error


def _grey(image_bgr: Image) -> Image:
    return np.asarray(cv2.cvtColor(image_bgr, cv2.COLOR_BGR2GRAY), dtype=np.uint8)
