"""A flat marker on the table beside the cube: once its place is known, both are tracked as one rigid object.

The flat marker alone gives the pose while the cube is too near or covered by a hand; both together give a more exact
pose than either.
"""

from collections.abc import Mapping

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import PlaneMarker, mean_side_px, square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose
from ashe_live.tracking.cube.faces import FACES
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.plane_markers import MOVED_SIDES, PlaneMarkers
from ashe_live.tracking.preset import TrackingPreset

BESIDE_NUMBER = len(FACES)  # of this member, after the cube's faces
# Its place is averaged over this many frames in a row before it is used, so that its error is well below the noise of a
# frame. It is forgotten after as many frames in which the cube is seen but the marker is not where it was.
PLACED_AFTER = 12
# It or the cube has been moved if the RMS distance of its corners from where they are expected exceeds this share of
# its side: several times what folds and the lens leave unexplained.
MOVED = 0.1


class FlatBeside:
    """Learns where one marker lies on the cube's table. For use by one thread at a time."""

    def __init__(self, marker: Marker) -> None:
        self.marker = marker
        self._lying = PlaneMarkers((marker,))
        self.forget()

    def forget(self) -> None:
        """It may lie anywhere."""
        self.placed: PlaneMarker | None = None  # once it is known
        self.corners: Float | None = None  # (4, 3) metres, the cube's frame; once it is placed
        self._lying.reset()
        self._seen: PlaneMarker | None = None
        self._frames = self._missed = 0

    def learn(self, frame: Frame, camera: Camera, pose: MarkerPose, preset: TrackingPreset) -> None:
        """Looks for it in a frame with the cube's own pose, unless it is placed already."""
        if self.placed is not None:
            return
        found = self._lying.found(frame, camera, pose, preset)
        rests = bool(found and self._seen is not None and _is_near(found[0], self._seen))
        self._frames = self._frames + 1 if rests else 0
        self._seen = found[0] if found else None
        if self._frames >= PLACED_AFTER and self._seen is not None:
            self.placed = self._seen
            self.corners = self.placed.on_plane(square_corners(self.placed.side_m))

    def has_moved(self, squares: Mapping[int, FittedSquare], pose: MarkerPose | None, camera: Camera) -> bool:
        """Whether the marker or the cube has been moved, by a frame that shows faces of the cube.

        It has if no `pose` explains both, if the pose puts the marker elsewhere than it is seen, or if the marker has
        been missing for PLACED_AFTER frames.
        """
        if self.corners is None or not squares or (BESIDE_NUMBER in squares and len(squares) == 1):
            return False
        if BESIDE_NUMBER not in squares:
            self._missed += 1
            return self._missed >= PLACED_AFTER
        self._missed = 0
        if pose is None:
            return True
        seen_px = squares[BESIDE_NUMBER].corners_px
        off_px = project(camera, pose.T_cam_marker, self.corners) - seen_px
        return not float(np.sqrt((off_px**2).sum(axis=1).mean())) < MOVED * mean_side_px(seen_px)


def _is_near(one: PlaneMarker, other: PlaneMarker) -> bool:
    """Whether both may be the place of one marker that rests."""
    return bool(np.linalg.norm(one.centre_m - other.centre_m) < MOVED_SIDES * other.side_m)
