"""The markers that are followed as one rigid object, and where the corners of each are on it."""

from collections.abc import Container, Sequence
from typing import NamedTuple

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.cube.beside import BESIDE_NUMBER, FlatBeside
from ashe_live.tracking.cube.folding import OF_FOLDED_CUBE, Folding
from ashe_live.tracking.edges.lens import source_from_ideal
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.layout import Layout, Member, members_of
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.poses.pose import Sighting, pose_of_squares

# Once a cube's folds are known, only this many of its faces are measured in a frame: measuring all three takes half as
# long again.
FACES_MEASURED = 2


class Posed(NamedTuple):
    """The pose by the squares of a frame, and what it was computed from."""

    pose: MarkerPose | None
    squares: dict[int, FittedSquare]  # by member, without the flat marker beside a cube if that has moved
    # Of these squares, a cube's on its nominal faces: folds are learned by the camera, and bear out whatever its focal
    # length is.
    sightings: list[Sighting]


class MarkerMembers:
    """One marker, those of a sheet, or a cube's faces, with the flat marker beside it once it is known where that lies.

    A cube is folded by hand, and no two are alike: where its corners are is learned. For use by one thread at a time.
    """

    def __init__(self, marker: Marker | Layout, side_m: float) -> None:
        """side_m: a black square's side, or the measure of the body that the markers are printed on."""
        self.side_m = side_m
        self.beside = FlatBeside(marker.beside) if isinstance(marker, Layout) and marker.beside else None
        self._given = members_of(marker)
        self._folding = Folding(side_m) if isinstance(marker, Layout) and marker.is_cube else None

    @property
    def all(self) -> tuple[Member, ...]:
        """The members whose place is known, in the order of their numbers."""
        if self.beside is None or self.beside.corners is None:
            return self._given
        return *self._given, Member(self.beside.marker, self.beside.corners / self.side_m)

    def corners(self, number: int) -> Float:
        """(4, 3) metres, marker frame: the corners of a member."""
        if self._folding is not None and number < BESIDE_NUMBER:
            return self._folding.corners(number)
        return self.side_m * self.all[number].corners

    def faces_among(self, several: Sequence[Sequence[Float]]) -> dict[int, Float]:
        """Corners (4, 2), of the cube's faces among what was found of all members: the first of each."""
        if self._folding is None:
            return {}
        return {number: found[0] for number, found in enumerate(several[:BESIDE_NUMBER]) if len(found)}

    def sighting(self, number: int, square: FittedSquare) -> Sighting:
        """A member's corners with the square that was seen of it."""
        return Sighting(self.corners(number), square)

    def forget_folds(self) -> None:
        """For another camera: what looks like folds by a wrong focal length is none."""
        if self._folding is not None:
            self._folding = Folding(self.side_m)

    def projected(self, camera: Camera, T_cam_marker: Float, excluding: Container[int]) -> dict[int, Float]:
        """Corners (4, 2), picture pixels, of all members where a pose (4, 4) has them, `excluding` some."""
        numbers = [number for number in range(len(self.all)) if number not in excluding]
        if not numbers:
            return {}
        ideal = project(camera, T_cam_marker, np.concatenate([self.corners(number) for number in numbers]))
        corners = zip(numbers, ideal.reshape(-1, 4, 2), strict=True)
        return {number: source_from_ideal(camera, each) for number, each in corners if np.isfinite(each).all()}

    def seen_px(self, squares: dict[int, FittedSquare], pose: MarkerPose, camera: Camera) -> dict[int, Float]:
        """By member, the corners (4, 2), picture pixels, of a frame's squares; of a single marker those of its pose."""
        if len(self.all) == 1:
            return {0: pose.corners_px}
        return {number: source_from_ideal(camera, square.corners_px) for number, square in squares.items()}

    def in_order_of_worth(self, numbers: list[int]) -> list[int]:
        """The same numbers, but the marker beside a cube first, which is measured in addition to the faces."""
        return sorted(numbers, key=lambda number: number != BESIDE_NUMBER) if self.beside is not None else numbers

    def most_measured(self, numbers: list[int]) -> int:
        """How many of the members with these numbers are worth being measured in a frame."""
        if self._folding is None or self._folding.wants_all:
            return len(numbers)
        return FACES_MEASURED + (BESIDE_NUMBER in numbers)

    def pose(
        self, squares: dict[int, FittedSquare], camera: Camera, previous: MarkerPose | None, refines: bool
    ) -> Posed:
        """The pose by the squares of a frame, by member.

        previous: the pose of the frame before. refines: as in `pose_of_squares`. If the flat marker beside a cube has
        moved, its place is forgotten.
        """
        seen = [self.sighting(number, square) for number, square in squares.items()]
        if self._folding is None:
            return Posed(pose_of_squares(seen, camera, self.side_m, previous, refines), squares, seen)
        nominal = [Sighting(self.side_m * self.all[number].corners, square) for number, square in squares.items()]
        pose = pose_of_squares(seen, camera, self.side_m, previous, refines, OF_FOLDED_CUBE)
        if self.beside is not None and self.beside.has_moved(squares, pose, camera):
            self.beside.forget()
            faces_alone = {number: square for number, square in squares.items() if number != BESIDE_NUMBER}
            return self.pose(faces_alone, camera, previous, refines)
        if pose is None:
            return Posed(None, squares, nominal)
        faces = {number: one for number, one in zip(squares, seen, strict=True) if number < BESIDE_NUMBER}
        if faces and self._folding.add(faces, pose.T_cam_marker, camera):
            seen = [self.sighting(number, square) for number, square in squares.items()]
            pose = pose_of_squares(seen, camera, self.side_m, pose, refines, OF_FOLDED_CUBE) or pose
        return Posed(self._folding.stated(pose), squares, nominal)
