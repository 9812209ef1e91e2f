"""What the tracker remembers of a frame for the next one: the pose, the picture, and how each marker was moving."""

from collections.abc import Container, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.types import Frame, MarkerPose
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.search import NEAR_PX


@dataclass(frozen=True, slots=True)
class Memory:
    """The last frame in which the marker was seen, for the next one."""

    time_s: float
    image_bgr: Image
    pose: MarkerPose
    corners_px: dict[int, Float]  # by member, (4, 2) picture pixels
    velocities_px_s: dict[int, Float]  # by member, (4, 2)
    aligned_sigmas: dict[int, float]  # by member, as in FittedSquare
    bridged: int  # frames in a row
    is_predictable: bool  # each member was where its motion had led one to expect it

    def of_members(self, numbers: Container[int]) -> "Memory":
        """Without members of other numbers."""
        kept = {number: corners_px for number, corners_px in self.corners_px.items() if number in numbers}
        return self if len(kept) == len(self.corners_px) else replace(self, corners_px=kept)

    def expected_px(self, time_s: float) -> dict[int, Float]:
        """By member, the corners (4, 2), picture pixels, at `time_s` if it moves on as it did."""
        return {
            number: corners_px + (time_s - self.time_s) * self.velocities_px_s.get(number, np.zeros((4, 2)))
            for number, corners_px in self.corners_px.items()
        }

    def nearest(self, number: int, found: Sequence[Float]) -> Float:
        """Of several markers (4, 2) like a member, the nearest to its last place, or else the first, the likeliest."""
        last_px = self.corners_px.get(number)
        if last_px is None:
            return found[0]
        return min(found, key=lambda corners: float(np.linalg.norm(corners.mean(axis=0) - last_px.mean(axis=0))))


def remembered(
    frame: Frame,
    pose: MarkerPose,
    corners_px: dict[int, Float],
    squares: dict[int, FittedSquare],
    bridged: int,
    last: Memory | None,
) -> Memory:
    """The memory of `frame`, in which members were seen at `corners_px` (4, 2) as `squares`, and of the `last` one.

    `bridged`: how many frames in a row have been bridged, with this one.
    """
    velocities: dict[int, Float] = {}
    is_predictable = False
    if last is not None and frame.time_s > last.time_s:
        elapsed_s = frame.time_s - last.time_s
        for number in corners_px.keys() & last.corners_px.keys():
            velocities[number] = (corners_px[number] - last.corners_px[number]) / elapsed_s
        is_predictable = _was_expected(velocities, last, elapsed_s)
    sigmas = {number: square.aligned_sigma for number, square in squares.items()}
    return Memory(
        time_s=frame.time_s,
        image_bgr=frame.image_bgr,
        pose=pose,
        corners_px=corners_px,
        velocities_px_s=velocities,
        aligned_sigmas=sigmas,
        bridged=bridged,
        is_predictable=is_predictable,
    )


def _was_expected(velocities: dict[int, Float], last: Memory, elapsed_s: float) -> bool:
    """Whether every member that was seen before moved on as it did, to within NEAR_PX."""
    changes = [
        (velocity - last.velocities_px_s.get(number, np.zeros((4, 2)))) * elapsed_s
        for number, velocity in velocities.items()
    ]
    return all(float(np.abs(change).max()) <= NEAR_PX for change in changes)
