"""Follows a marker, or a layout of several, from frame to frame (docs/tracking.md).

In each frame the marker is looked for along the edges where it is expected, then around its last place, then anywhere.
"""

import dataclasses
import time
from collections.abc import Callable
from typing import NamedTuple

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera, Size, fitted
from ashe_live.core.square import PlaneMarker
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.tracking.cube.unfolded import UNFOLDED, lies_unfolded
from ashe_live.tracking.edges.flow import flowed_corners
from ashe_live.tracking.edges.lens import ideal_from_source
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.layout import Layout
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.members import MarkerMembers, Posed
from ashe_live.tracking.memory import Memory, remembered
from ashe_live.tracking.plane_markers import PlaneMarkers
from ashe_live.tracking.poses.pose import Sighting, poses_of_square
from ashe_live.tracking.poses.pose_filter import PoseFilter
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.search import Expected, along_edges, anywhere, first_along_edges, in_front, nearby, refined

# The last pose is forgotten when the marker has not been seen for this long.
MEMORY_S = 0.5
# At most this many frames in a row are bridged by optical flow, whose corners have this standard deviation.
BRIDGED_FRAMES = 5
FLOW_SIGMA_PX = 1.0
# A lost marker is searched for thoroughly in the first frames without it, then in one frame of so many.
THOROUGH_FRAMES, THOROUGH_EVERY = 3, 8
# A frame is searched for a second marker like the followed one this often.
DUPLICATE_CHECK_EVERY_S = 1.0
SEVERAL = "{} equal markers in view: one of them is tracked, cover the others"


class _Looked(NamedTuple):
    """What looking for the members shows in a frame."""

    squares: dict[int, FittedSquare]  # by member
    equal_count: int | None  # of the markers found that are like a member; None: they were not counted
    is_unfolded: bool = False  # whether the frame shows the cube's sheet before it is folded


class MarkerTracker:
    """Finds the marker in each frame, and its pose. For use by one thread at a time."""

    def __init__(
        self, marker: Marker | Layout, camera: Camera | Callable[[Size], Camera], side_m: float, preset: TrackingPreset
    ) -> None:
        """`camera`: of any size, scaled to the frames; or a function that gives the camera for their size. `side_m`:
        the side of a black square, or the edge of the cube that the markers are printed on.
        """
        self.marker = marker
        self.side_m = side_m
        self.preset = preset
        self.others = PlaneMarkers(())  # further markers to look for on the same plane
        self.filters = True  # whether poses are smoothed; if not, each frame's pose is as measured
        self._members = MarkerMembers(marker, side_m)
        self._camera = camera
        self._camera_now: Camera | None = None
        self._filter = PoseFilter(side_m)
        self._sightings: list[Sighting] = []  # of the last frame
        self.reset()

    def reset(self) -> None:
        """Forgets the last pose, for a rewind or a cut, after which it says nothing about the next frame."""
        self._last: Memory | None = None
        self._lost_frames = 0
        self._duplicates_s: float | None = None
        self._note: str | None = None
        self._before_jump: MarkerPose | None = None
        self._filter.reset()
        self.others.reset()
        if self._members.beside is not None:
            self._members.beside.forget()

    def jump(self) -> None:
        """As `reset`, for a seek in the same clip: the last pose still decides between the two poses of a square.

        Otherwise a seek could flip a model that stands upright when the clip is played.
        """
        pose = self._before_jump if self._last is None else self._last.pose
        self.reset()
        self._before_jump = pose

    def use_camera(self, camera: Camera) -> None:
        """Uses `camera` for frames of its size from now on, until their size changes; the marker is not lost."""
        self._camera_now = camera
        self._filter.reset()  # its pose was measured with another camera, and so were a cube's folds
        self._members.forget_folds()

    def track(self, frame: Frame) -> TrackedFrame:
        """The frame with the pose measured in it; with None if the marker is not found.

        Raises UserError if there is no camera for frames of this size.
        """
        start = time.perf_counter()
        camera = self._camera_for(frame.size)
        last = self._recent(frame.time_s)
        looked = self._look(frame, camera, last)
        if looked.equal_count is not None:
            self._note = SEVERAL.format(looked.equal_count) if looked.equal_count > 1 else None
        posed, last = self._posed(looked.squares, camera, last)
        bridged = 0
        if posed.pose is None and last is not None and last.bridged < BRIDGED_FRAMES:
            flowed, bridged = self._flowed(frame.image_bgr, camera, last), last.bridged + 1
            posed, last = self._posed(flowed, camera, last)
        pose, self._sightings = posed.pose, posed.sightings
        if pose is None:
            self._last = last
            self._lost_frames += 1
        else:
            pose = self._smoothed(pose, frame.time_s, bridged > 0)
            seen_px = self._members.seen_px(posed.squares, pose, camera)
            self._last = remembered(frame, pose, seen_px, posed.squares, bridged, last)
            self._lost_frames = 0
            self._before_jump = None
        others = self._others_on_plane(frame, camera, pose)
        detect_ms = (time.perf_counter() - start) * 1e3
        note = UNFOLDED if looked.is_unfolded else self._note if pose else None
        return TrackedFrame(frame, camera, pose, detect_ms, note, others)

    def _camera_for(self, size: Size) -> Camera:
        if self._camera_now is None or self._camera_now.size != size:
            self.reset()
            self._camera_now = fitted(self._camera, size) if isinstance(self._camera, Camera) else self._camera(size)
        return self._camera_now

    def _recent(self, time_s: float) -> Memory | None:
        """The last frame with a marker, unless it is too old or from after `time_s`."""
        return self._last if self._last is not None and 0 <= time_s - self._last.time_s <= MEMORY_S else None

    def _look(self, frame: Frame, camera: Camera, last: Memory | None) -> _Looked:
        """Looks for all members where expected, else near their last place, else anywhere."""
        image, looked = frame.image_bgr, _Looked({}, None)
        if last is not None:
            looked = self._where_expected(image, camera, last, frame.time_s)
            if not looked.squares:
                looked = self._near_last_place(image, camera, last)
        if not looked.squares:
            searched = self._search(image, camera, last)
            return searched if searched.equal_count is not None else searched._replace(equal_count=looked.equal_count)
        if self._duplicates_s is None or not 0 <= frame.time_s - self._duplicates_s < DUPLICATE_CHECK_EVERY_S:
            self._duplicates_s = frame.time_s
            (alike,) = anywhere([self._members.all[0].marker], image, self.preset.detection_width_px, thorough=False)
            looked = looked._replace(equal_count=len(alike))
        return looked

    def _where_expected(self, image: Image, camera: Camera, last: Memory, time_s: float) -> _Looked:
        """Members measured along their expected edges: moving on as they did, or as predicted by the last pose."""
        moved_px = last.expected_px(time_s)
        expected = self._members.projected(camera, last.pose.measured_T_cam_marker, moved_px) | moved_px
        numbers = self._members.in_order_of_worth(in_front(expected, last.corners_px))
        most = self._members.most_measured(numbers)
        where = {
            number: Expected(self._members.all[number].marker, expected[number], last.aligned_sigmas.get(number, 0.0))
            for number in numbers
        }
        seen = first_along_edges(where, most, image, camera, self.preset.edge_samples, last.is_predictable)
        return _Looked({number: square for number, square in seen.items() if square is not None}, None)

    def _near_last_place(self, image: Image, camera: Camera, last: Memory) -> _Looked:
        """Members searched for in the surroundings of their last places."""
        squares: dict[int, FittedSquare] = {}
        equal_count: int | None = None
        for number, corners_px in last.corners_px.items():
            marker = self._members.all[number].marker
            if found := nearby(marker, image, corners_px):
                equal_count = len(found)
                square = refined(marker, image, camera, last.nearest(number, found), self.preset.edge_samples)
                if square is not None:
                    squares[number] = square
        return _Looked(squares, equal_count)

    def _search(self, image: Image, camera: Camera, last: Memory | None) -> _Looked:
        """Searches the whole frame for the first member that is found, and those that are seen by its pose."""
        is_thorough = self._lost_frames < THOROUGH_FRAMES or self._lost_frames % THOROUGH_EVERY == 0
        markers = [member.marker for member in self._members.all]
        equal_count: int | None = None
        for thorough in (False, True) if is_thorough else (False,):
            several = anywhere(markers, image, self.preset.detection_width_px, thorough)
            if lies_unfolded(self._members.faces_among(several)):
                return _Looked({}, equal_count, is_unfolded=True)
            for number, (marker, found) in enumerate(zip(markers, several, strict=True)):
                if not found:
                    continue
                equal_count, chosen = len(found), found[0] if last is None else last.nearest(number, found)
                square = refined(marker, image, camera, chosen, self.preset.edge_samples)
                if square is not None:
                    return _Looked(self._with_others(number, square, image, camera), equal_count)
        return _Looked({}, equal_count)

    def _with_others(self, number: int, square: FittedSquare, image: Image, camera: Camera) -> dict[int, FittedSquare]:
        """The one member that was found, and all others that are seen where its pose predicts them.

        Of the two poses of a single square, the one that finds more of the other members is right.
        """
        best = found = {number: square}
        if len(self._members.all) == 1:
            return found
        for T_cam_marker in poses_of_square(self._members.sighting(number, square), camera):
            expected = self._members.projected(camera, T_cam_marker, found)
            where = [Expected(self._members.all[other].marker, corners_px) for other, corners_px in expected.items()]
            others = zip(expected, along_edges(where, image, camera, self.preset.edge_samples), strict=True)
            seen = found | {other: one for other, one in others if one is not None}
            if len(seen) > len(best):
                best = seen
        return best

    def _posed(
        self, squares: dict[int, FittedSquare], camera: Camera, last: Memory | None
    ) -> tuple[Posed, Memory | None]:
        """The pose, and the last frame's memory without a flat marker that was forgotten as it has moved."""
        previous = self._before_jump if last is None else last.pose
        posed = self._members.pose(squares, camera, previous, self.preset.refines_pose)
        return posed, last and last.of_members(range(len(self._members.all)))

    def _flowed(self, image: Image, camera: Camera, last: Memory) -> dict[int, FittedSquare]:
        squares = {}
        for number, corners_px in last.corners_px.items():
            moved_px = flowed_corners(last.image_bgr, image, corners_px)
            if moved_px is not None:
                squares[number] = FittedSquare.guessed(ideal_from_source(camera, moved_px), FLOW_SIGMA_PX)
        return squares

    def _smoothed(self, pose: MarkerPose, time_s: float, bridged: bool) -> MarkerPose:
        assert pose.noise_covariance is not None
        if not self.filters:
            return dataclasses.replace(pose, bridged=bridged)
        held = self._filter.add(pose.T_cam_marker, pose.noise_covariance, time_s, self.preset)
        return dataclasses.replace(pose, T_cam_marker=held, unfiltered_T_cam_marker=pose.T_cam_marker, bridged=bridged)

    def _others_on_plane(self, frame: Frame, camera: Camera, pose: MarkerPose | None) -> tuple[PlaneMarker, ...]:
        """Further markers on the plane of the pose: those asked for, and the flat one beside a cube."""
        others = self.others.found(frame, camera, pose, self.preset)
        beside = self._members.beside
        if pose is None or beside is None:
            return others
        if not pose.bridged:
            beside.learn(frame, camera, pose, self.preset)
        return others if beside.placed is None else (*others, beside.placed)
