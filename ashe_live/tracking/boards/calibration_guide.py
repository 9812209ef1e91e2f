"""Which views a calibration still lacks, in places and in tilts, and which frames are worth keeping as views."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera, Size
from ashe_live.core.transforms import angle_between
from ashe_live.errors import UserError
from ashe_live.tracking.boards.calibration import MIN_VIEWS, CameraCalibration, calibrate
from ashe_live.tracking.boards.calibration_board import BoardView

# The picture is divided into nine cells at these shares of its sides. The outer cells are narrower, as lenses distort
# more there.
CUTS = (0.0, 0.28, 0.72, 1.0)
PLACES = (
    ("upper left", "upper middle", "upper right"),
    ("middle left", "middle", "middle right"),
    ("lower left", "lower middle", "lower right"),
)
CORNERS_IN_CELL = 4
# With fewer cells covered, distortion would mostly be extrapolated.
MIN_COVERED = 6
# In VIEWS_PER_TILT views each, the board is turned by TILT_RAD or more, with one of its four edges towards the camera.
TILT_RAD = math.radians(17)
VIEWS_PER_TILT = 2
TILTS = (("right", (1, 0)), ("left", (-1, 0)), ("lower", (0, 1)), ("upper", (0, -1)))
ENOUGH_VIEWS = 14
MOST_VIEWS = 60
# A view is new if the board has moved by this share of the picture's diagonal, if the logarithm of its size has changed
# by this, or if it has been turned by this.
NEW_PLACE = 0.1
NEW_SCALE = 0.2
NEW_TURN_RAD = math.radians(9)


@dataclass(frozen=True, slots=True)
class KeptView:
    """A view with where it was, how the board stood, and how fast it moved."""

    view: BoardView
    frame_index: int
    middle: Float  # (2,) of its corners, in diagonals of the picture
    log_scale: float  # log of the squares' mean side in pixels
    normal: Float  # (3,) unit, out of the board's back, camera frame
    motion_px: float  # since the frame before, mean of the corners; infinite when there was none

    def is_like(self, other: "KeptView") -> bool:
        return (
            float(np.linalg.norm(self.middle - other.middle)) < NEW_PLACE
            and abs(self.log_scale - other.log_scale) < NEW_SCALE
            and angle_between(self.normal, other.normal) < NEW_TURN_RAD
        )


class CalibrationGuide:
    """Collects views that differ, each from the steadiest frame that showed it, and says what is missing."""

    def __init__(self, size: Size) -> None:
        self.size = size
        self.kept: list[KeptView] = []
        self.frames_with_board = 0
        self._camera = Camera.assumed(size)
        self._last: BoardView | None = None

    def add(self, view: BoardView | None, frame_index: int) -> bool:
        """Looks at what a frame showed of the board; True when that is kept as a view that was not there yet."""
        last, self._last = self._last, view
        if view is None:
            return False
        self.frames_with_board += 1
        new = self._described(view, frame_index, last)
        alike = next((at for at, kept in enumerate(self.kept) if kept.is_like(new)), None)
        if alike is not None:
            if new.motion_px < self.kept[alike].motion_px and len(view.points) >= len(self.kept[alike].view.points):
                self.kept[alike] = new
            return False
        if len(self.kept) < MOST_VIEWS:
            self.kept.append(new)
            return True
        return False

    def covered(self) -> list[list[bool]]:
        """Which of the 3 x 3 cells have been shown enough corners, row by row."""
        corners = np.concatenate([kept.view.corners_px for kept in self.kept]) if self.kept else np.empty((0, 2))
        edges = [np.array(CUTS) * side - 0.5 for side in self.size[::-1]]
        counts, _, _ = np.histogram2d(corners[:, 1], corners[:, 0], bins=edges)
        return [[bool(count >= CORNERS_IN_CELL) for count in row] for row in counts]

    def tilted(self) -> dict[str, int]:
        """In how many views the board's right, left, lower and upper edge was nearer, up to those needed."""
        return {
            edge: min(
                VIEWS_PER_TILT,
                sum(float(kept.normal[:2] @ towards) > math.sin(TILT_RAD) for kept in self.kept),
            )
            for edge, towards in TILTS
        }

    @property
    def progress(self) -> float:
        """From 0 to 1: the views, places and tilts that are needed."""
        have = min(len(self.kept), ENOUGH_VIEWS) + sum(map(sum, self.covered())) + sum(self.tilted().values())
        return have / (ENOUGH_VIEWS + 9 + VIEWS_PER_TILT * len(TILTS))

    def wanted(self) -> str | None:
        """A hint which view to show next; None when nothing is missing."""
        for name, count in self.tilted().items():
            if count < VIEWS_PER_TILT:
                again = ", once more, elsewhere in the picture" if count else ""
                return f"tilt the board: its {name} edge (in the picture) towards the camera{again}"
        if missing := self._places_missing():
            return f"bring the board to the {missing[0]} of the picture"
        return None if len(self.kept) >= ENOUGH_VIEWS else "show it from yet another side"

    def calibration(self) -> CameraCalibration:
        """From the views kept so far. Raises UserError, with what is missing, when they do not determine the camera."""
        if not self.frames_with_board:
            raise UserError(
                "there is no calibration board in any picture",
                "print one with `ashe-live board --out board.pdf`, and show all of it, sharp and well lit",
            )
        if len(self.kept) >= MIN_VIEWS:
            flat = [name for name, count in self.tilted().items() if not count]
            if len(flat) > len(TILTS) - 2:
                raise UserError("all views of the board are nearly frontal", self.wanted() or "tilt it to every side")
            if sum(map(sum, self.covered())) < MIN_COVERED:
                missing = ", ".join(self._places_missing())
                raise UserError(f"{missing} of the picture never showed the board", self.wanted() or "")
        return calibrate([kept.view for kept in self.kept], self.size)

    def _places_missing(self) -> list[str]:
        return [
            name
            for names, row in zip(PLACES, self.covered(), strict=True)
            for name, is_covered in zip(names, row, strict=True)
            if not is_covered
        ]

    def _described(self, view: BoardView, frame_index: int, last: BoardView | None) -> KeptView:
        _, rvec, tvec = cv2.solvePnP(
            view.points, view.corners_px, self._camera.K, self._camera.dist, flags=cv2.SOLVEPNP_IPPE
        )
        return KeptView(
            view=view,
            frame_index=frame_index,
            middle=view.corners_px.mean(axis=0) / math.hypot(*self.size),
            log_scale=math.log(self._camera.K[0, 0] / max(1e-9, float(tvec[2, 0]))),
            normal=np.asarray(cv2.Rodrigues(rvec)[0][:, 2], dtype=np.float64),
            motion_px=_motion(view, last),
        )


def _motion(view: BoardView, last: BoardView | None) -> float:
    """Mean way of the corners that both show, in pixels."""
    if last is None:
        return math.inf
    before = {tuple(point): corner for point, corner in zip(last.points, last.corners_px, strict=True)}
    ways = [
        float(np.linalg.norm(corner - before[tuple(point)]))
        for point, corner in zip(view.points, view.corners_px, strict=True)
        if tuple(point) in before
    ]
    return sum(ways) / len(ways) if ways else math.inf
