"""Other markers flat on the plane of the one that is followed: where each lies there, which its corners tell alone.

With the plane known, a square's place on it has four unknowns (x, y, turn, side) and eight measurements, so that no
second pose has to be chosen, and noise moves it by a fraction of what it moves a marker's own pose by.
"""

import cmath
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.ranges import MARKER_SIDE
from ashe_live.core.square import PlaneMarker, square_corners
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame, MarkerPose
from ashe_live.tracking.edges.lens import source_from_ideal
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.search import Expected, along_edges, anywhere, refined

# Markers that are not in view are looked for this often.
SEARCH_EVERY_S = 0.2
# A marker whose corners, projected onto the plane, differ from a square by more than this RMS (in sides of that square)
# does not lie on it. A wrong focal length makes a marker that lies flat differ by less, an upright one differs by more.
MOST_BENT = 0.1
# Averaging begins anew when a marker has moved by this many of its sides, or turned by this many radians, or when its
# side has changed by as large a share.
MOVED_SIDES, TURNED_RAD = 0.01, 0.01
# The running mean weighs a new frame by at least one over this number.
AVERAGED = 30


@dataclass(slots=True)
class _Held:
    """Where a marker lies on the plane: complex numbers, x + iy."""

    centre: complex  # metres
    side: complex  # its length in metres and its angle: the print's x axis, as long as a side
    frames: int = 0  # averaged so far

    def add(self, centre: complex, side: complex) -> None:
        length = abs(self.side)
        if abs(centre - self.centre) > MOVED_SIDES * length or abs(side / self.side - 1) > TURNED_RAD:
            self.centre, self.side, self.frames = centre, side, 1
            return
        self.frames = min(self.frames + 1, AVERAGED)
        self.centre += (centre - self.centre) / self.frames
        self.side += (side - self.side) / self.frames


class PlaneMarkers:
    """Looks for some markers in frame after frame. For use by one thread at a time."""

    def __init__(self, markers: Sequence[Marker]) -> None:
        self._markers = tuple(markers)
        self.reset()

    def reset(self) -> None:
        """Forgets where they were: the next frame has nothing to do with the last one."""
        self._held: dict[int, _Held] = {}
        self._searched_s: float | None = None

    def found(
        self, frame: Frame, camera: Camera, pose: MarkerPose | None, preset: TrackingPreset
    ) -> tuple[PlaneMarker, ...]:
        """The markers that lie flat in a frame, given the pose of the followed one; none if that is not in view."""
        if pose is None or not self._markers:
            return ()
        seen = self._where_they_were(frame, camera, pose, preset)
        missing = [number for number in range(len(self._markers)) if number not in seen]
        is_due = self._searched_s is None or not 0 <= frame.time_s - self._searched_s < SEARCH_EVERY_S
        if missing and is_due:
            self._searched_s = frame.time_s
            seen |= self._searched(missing, frame, camera, preset)
        lying = []
        for number, square in sorted(seen.items()):
            place = _on_plane(square, camera, pose)
            if place is None:
                self._held.pop(number, None)
                continue
            held = self._held.setdefault(number, _Held(*place))
            held.add(*place)
            if (length := abs(held.side)) in MARKER_SIDE:
                centre_m = np.array((held.centre.real, held.centre.imag))
                lying.append(PlaneMarker(self._markers[number].spec, centre_m, cmath.phase(held.side), length))
        return tuple(lying)

    def _where_they_were(
        self, frame: Frame, camera: Camera, pose: MarkerPose, preset: TrackingPreset
    ) -> dict[int, FittedSquare]:
        """The squares found where they were, by number; a marker that has been lifted or covered is forgotten."""
        seen = {}
        for number, held in list(self._held.items()):
            corners = held.centre + _complex(square_corners(1.0)) * held.side
            on_plane = np.column_stack([corners.real, corners.imag, np.zeros(4)])
            expected_px = source_from_ideal(camera, project(camera, pose.measured_T_cam_marker, on_plane))
            square = None
            if np.isfinite(expected_px).all():
                expected = Expected(self._markers[number], expected_px)
                (square,) = along_edges([expected], frame.image_bgr, camera, preset.edge_samples)
            if square is None:
                del self._held[number]
            else:
                seen[number] = square
        return seen

    def _searched(
        self, numbers: Sequence[int], frame: Frame, camera: Camera, preset: TrackingPreset
    ) -> dict[int, FittedSquare]:
        """The squares of the markers `numbers` that are found anywhere in the frame."""
        markers = [self._markers[number] for number in numbers]
        several = anywhere(markers, frame.image_bgr, preset.detection_width_px, thorough=False)
        seen = {}
        for number, marker, found in zip(numbers, markers, several, strict=True):
            square = refined(marker, frame.image_bgr, camera, found[0], preset.edge_samples) if found else None
            if square is not None:
                seen[number] = square
        return seen


def _on_plane(square: FittedSquare, camera: Camera, pose: MarkerPose) -> tuple[complex, complex] | None:
    """Centre and side of the square on the plane nearest to where the corners meet it; None where it does not lie flat.

    Least squares for a similarity of the plane, in complex numbers: z = centre + side c for each corner c of a unit
    square.
    """
    points = raycast_to_plane(camera, pose.measured_T_cam_marker, square.corners_px)
    if not np.isfinite(points).all():
        return None
    corners, unit = _complex(points), _complex(square_corners(1.0))
    centre = complex(corners.mean())
    side = complex(np.vdot(unit, corners - centre) / np.vdot(unit, unit).real)
    bent = np.sqrt(np.mean(np.abs(centre + side * unit - corners) ** 2))
    return (centre, side) if bent <= MOST_BENT * abs(side) else None


def _complex(points: Float) -> np.ndarray:
    """(n,) complex of (n, 2 or 3) points."""
    return points[:, 0] + 1j * points[:, 1]
