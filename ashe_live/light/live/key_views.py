"""Key views: the few frames of a camera that show an unmoved scene from different sides, kept for the estimator.

Several frames from one side show hardly more than one of them; frames from several sides separate what lies on the
marker's plane from what stands on it. To save time, a frame's direction of view is checked first (a few products), its
sharpness only if the direction is wanted, and only a frame that is kept is scaled down.
"""

import math
import threading
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, without
from ashe_live.core.camera import Camera, scaled_pixels
from ashe_live.core.ranges import VIEWS
from ashe_live.core.transforms import transform_points, view_direction
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.live.comparable import lies_as_in
from ashe_live.light.live.moved_marker import seen_before_move
from ashe_live.light.views.selection import span_rad

MOST_VIEWS = int(VIEWS.high)
# The widest picture that a preset of the estimator works on; halving keeps at least that of a landscape picture, where
# MOST_PIXELS allow it.
WORKING_WIDTH_PX = 640
MOST_BYTES = 40e6  # of all pictures together
MOST_PIXELS = MOST_BYTES / MOST_VIEWS / 3
# Between directions nearer than this, a thing 5 cm high and half a metre away shifts by less than two pixels.
SAME_DIRECTION_COSINE = math.cos(math.radians(1.0))
# A full set takes a view that widens its narrowest gap by this factor; without it, noise would renew the set for ever.
GAIN = 1.25
# Views that span less than a hand's trembling count as one.
LEAST_SPAN_RAD = math.radians(1.5)
# The sun moves by a degree in four minutes, and clouds come: an old view is replaced by a new one from the same side.
RENEWED_AFTER_S, OLDEST_S = 30.0, 120.0
# Standard deviation of the pose's rotation by noise: 30 cm beside the marker it moves the ground by 2.6 mm. Errors that
# all poses of one camera share, as that of its focal length, are no reason to leave out a view.
MOST_ROTATION_SIGMA_RAD = math.radians(0.5)
# Standard deviation of the blur across the marker's borders, in pixels of the picture that is kept: a sharp border,
# averaged over pixels as a camera does, has 0.4 to 1.
MOST_BLUR_PX = 2.0
CROP_PX = 64  # side of the square around a corner of the marker in which the blur is measured
# Shares of its pixels that are left out, as they may come from sharpening or noise: of the brightest and the darkest,
# each; and of the steepest.
EXTREME, STEEPEST = 0.02, 0.01


def span_of(views: Sequence[TrackedFrame]) -> float:
    """The largest angle between two views' directions, seen from the marker, in radians; 0 for fewer than two."""
    return span_rad(_directions(views))


class KeyViews:
    """A few frames, spread over the directions from which the scene has been seen.

    One thread adds frames; any thread may read `views` and drop some of them.
    """

    def __init__(self, most: int = MOST_VIEWS) -> None:
        """`most`: the largest number of views. Raises ValueError if it is below two."""
        if most < 2:
            raise ValueError(f"{most} views are not several")
        self._most = most
        self._set = _ViewSet(())
        self._camera: Camera | None = None  # of the frames as they came
        self._T_room_marker: Float | None = None  # of the last frame
        self._changing = threading.Lock()  # held for a few comparisons, never while a picture is processed

    @property
    def views(self) -> tuple[TrackedFrame, ...]:
        """In the order in which they were added; scaled down, together with their cameras and corners."""
        return self._set.views

    @property
    def nbytes(self) -> int:
        """Bytes of all pictures."""
        return sum(view.frame.image_bgr.nbytes for view in self.views)

    def add(self, tracked: TrackedFrame) -> bool:
        """Keeps a frame if it is sharp, has a precise pose and shows another side; returns whether it was kept."""
        marker = tracked.marker
        if marker is None or not _is_well_posed(marker):
            return False
        if tracked.camera is not self._camera:
            # Poses depend on the focal length, so that those of two cameras do not fit each other.
            self.drop()
            self._camera = tracked.camera
        if self._is_being_moved(tracked):
            return False
        time_s = tracked.frame.time_s
        replaced = self._set.replaced_from(view_direction(marker.T_cam_marker), time_s, self._most)
        if replaced is None:
            return False
        size = kept_size(tracked.frame.size)
        if blur_px(tracked) * size[0] / tracked.frame.size[0] > MOST_BLUR_PX:
            return False
        view = scaled(tracked, size)
        with self._changing:
            stay = [each for each in without(self.views, replaced) if _age_s(each, time_s) <= OLDEST_S]
            self._set = _ViewSet((*stay, view))
        return True

    def _is_being_moved(self, tracked: TrackedFrame) -> bool:
        """Whether the marker moves in the room. Once it lies still, the views are carried over to its new frame."""
        before, self._T_room_marker = self._T_room_marker, tracked.T_room_marker
        if before is not None and before is not tracked.T_room_marker:
            return True
        lies = tracked.T_room_marker
        if lies is not None and not all(lies_as_in(view, tracked) for view in self.views):
            with self._changing:
                kept = [v if lies_as_in(v, tracked) else seen_before_move(v, lies) for v in self.views]
                self._set = _ViewSet(tuple(view for view in kept if view is not None))
        return False

    def drop(self, views: Sequence[TrackedFrame] | None = None) -> None:
        """Forgets these views, or all of them."""
        with self._changing:
            self._set = _ViewSet(() if views is None else tuple(without(self.views, views)))


class _ViewSet:
    """The views, and what is computed once to decide whether each further frame is wanted."""

    def __init__(self, views: tuple[TrackedFrame, ...]) -> None:
        self.views = views
        self._directions = np.array(_directions(views))
        if len(views) > 1:
            between = np.arccos(np.clip(self._directions @ self._directions.T, -1.0, 1.0))
            np.fill_diagonal(between, np.inf)
            gaps = np.sort(between, axis=1)
            # Of the two views at the narrowest gap, the one whose other neighbours are nearer.
            self._redundant = min(range(len(views)), key=lambda at: tuple(gaps[at]))
            self._narrowest_rad = float(gaps[self._redundant, 0])

    def replaced_from(self, direction: Float, time_s: float, most: int) -> tuple[TrackedFrame, ...] | None:
        """The views that a view from `direction` (3,) would replace; None if that view is not wanted."""
        if not self.views:
            return ()
        cosines = self._directions @ direction
        nearest = int(cosines.argmax())
        if cosines[nearest] > SAME_DIRECTION_COSINE:
            return (self.views[nearest],) if _age_s(self.views[nearest], time_s) > RENEWED_AFTER_S else None
        if len(self.views) < most:
            return ()
        cosines[self._redundant] = -1.0
        is_gain = math.acos(min(1.0, cosines.max())) > GAIN * self._narrowest_rad
        return (self.views[self._redundant],) if is_gain else None


def _directions(views: Sequence[TrackedFrame]) -> list[Float]:
    return [view_direction(view.marker.T_cam_marker) for view in views if view.marker is not None]


def _is_well_posed(marker: MarkerPose) -> bool:
    if marker.bridged:
        return False
    covariance = marker.covariance if marker.noise_covariance is None else marker.noise_covariance
    return covariance is None or max(covariance[0, 0], covariance[1, 1]) <= MOST_ROTATION_SIGMA_RAD**2


def _age_s(view: TrackedFrame, now_s: float) -> float:
    return abs(now_s - view.frame.time_s)


def kept_size(size: tuple[int, int]) -> tuple[int, int]:
    """The size (width, height) of a kept picture: halved once or several times, as such scaling costs the least."""
    width, height = size
    while width >= 2 * WORKING_WIDTH_PX or width * height > MOST_PIXELS:
        width, height = (width + 1) // 2, (height + 1) // 2
    return width, height


def scaled(tracked: TrackedFrame, size: tuple[int, int]) -> TrackedFrame:
    """The frame, which must have a marker, scaled to `size` with its camera and corners."""
    marker, before = tracked.pose, tracked.frame.size
    if size == before:
        return tracked
    image: Image = np.asarray(cv2.resize(tracked.frame.image_bgr, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    scale = np.divide(size, before)
    return replace(
        tracked,
        clean_plate_bgr=None,  # of the frame's size; where views are kept there is none
        frame=Frame(image, tracked.frame.index, tracked.frame.time_s),
        camera=tracked.camera.resized(size),
        marker=replace(
            marker,
            corners_px=scaled_pixels(marker.corners_px, scale),
            reprojection_rms_px=marker.reprojection_rms_px * float(scale[0]),
            other_rms_px=None if marker.other_rms_px is None else marker.other_rms_px * float(scale[0]),
        ),
    )


def blur_px(tracked: TrackedFrame) -> float:
    """Standard deviation of the blur at the marker's corner, in pixels, across the more blurred of its two sides.

    The border of a black square on white paper is a step: blurred by a normal distribution of deviation s, its steepest
    slope is its height over s sqrt(2 pi). Both sides are measured, as motion along one of them blurs only the other. Of
    the corners it is the first in the picture. On a body with prints on its faces, the blur is measured at its middle,
    along the picture's axes. Infinity where there is nothing to measure.
    """
    measured = _corner_in_picture(tracked)
    if measured is None:
        return math.inf
    place, sides = measured
    left, top = np.maximum(np.round(place) - CROP_PX // 2, 0).astype(int)
    crop = tracked.frame.image_bgr[top : top + CROP_PX, left : left + CROP_PX]
    if min(crop.shape[:2]) < 3:
        return math.inf
    grey = cv2.cvtColor(np.asarray(crop), cv2.COLOR_BGR2GRAY)
    across_x, across_y = (
        cv2.Sobel(grey, cv2.CV_32F, *order, ksize=1, scale=0.5).ravel()[::2] for order in ((1, 0), (0, 1))
    )
    levels = np.sort(grey, axis=None)
    darkest, brightest = (float(levels[int(share * len(levels))]) for share in (EXTREME, 1 - EXTREME))
    height = brightest - darkest
    normals = np.column_stack((-sides[:, 1], sides[:, 0])) / np.linalg.norm(sides, axis=1)[:, None]
    rank = int((1 - STEEPEST) * len(across_x))
    slope = min(float(np.partition(np.abs(x * across_x + y * across_y), rank)[rank]) for x, y in normals)
    return height / (slope * math.sqrt(2 * math.pi)) if height > 0 and slope > 0 else math.inf


def _corner_in_picture(tracked: TrackedFrame) -> tuple[Float, Float] | None:
    """(2,) where in the picture the blur is measured, and (2, 2) the two sides across which it is; None for nowhere."""
    marker, camera = tracked.marker, tracked.camera
    if marker is None:
        return None
    if marker.body is not None:
        middle_cam = transform_points(marker.T_cam_marker, [(0.0, 0.0, marker.side_m / 2)])
        seen, _ = cv2.projectPoints(middle_cam, np.zeros(3), np.zeros(3), camera.K, camera.dist)
        corners = [(seen[0, 0], np.eye(2))]
    else:
        corners = [(at, marker.corners_px[[i - 1, (i + 1) % 4]] - at) for i, at in enumerate(marker.corners_px)]
    inside = (each for each in corners if (each[0] >= 0).all() and (each[0] <= np.array(camera.size) - 1).all())
    return next(((place, sides) for place, sides in inside if sides.any(axis=1).all()), None)
