"""The board that calibrates a camera: a chessboard whose white squares hold markers (ChArUco)."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, frozen_floats, set_frozen

# As many squares of 25 mm as fit onto A4 with the line of text. The dictionary is not that of the default marker, which
# may be in the same picture.
SQUARES = (7, 8)
MARKER_OVER_SQUARE = 0.72
DICTIONARY = cv2.aruco.DICT_5X5_50
# Side of a square as it is drawn: its marker's seven cells, and the white around that, are whole pixels too.
DRAWN_PX = 350
# Fewer corners than this, or all on one line, say nothing about a camera.
MIN_CORNERS = 8


@dataclass(frozen=True, slots=True)
class BoardView:
    """The board's inner corners as one picture shows them."""

    corners_px: Float  # (n, 2) source pixels
    points: Float  # (n, 3) the same corners on the board, squares: x right, y down, z away from the eye

    def __post_init__(self) -> None:
        count = len(self.corners_px)
        set_frozen(
            self,
            corners_px=frozen_floats(self.corners_px, (count, 2), "corners_px"),
            points=frozen_floats(self.points, (count, 3), "points"),
        )


class CalibrationBoard:
    """Finds itself in pictures. Its true size is of no matter: a camera's K and distortion have no metres in them."""

    squares = SQUARES

    def __init__(self) -> None:
        dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
        self._board = cv2.aruco.CharucoBoard(SQUARES, 1.0, MARKER_OVER_SQUARE, dictionary)
        self._detector = cv2.aruco.CharucoDetector(self._board)
        self._points = np.asarray(self._board.getChessboardCorners(), dtype=np.float64)

    def bitmap(self, size_px: tuple[int, int]) -> Image:
        """(h, w) uint8 picture of the board alone, `size_px` (width, height) large, all of it black or white."""
        # In some sizes squares of OpenCV's reach beyond its own picture, which is an error.
        whole = self._board.generateImage([DRAWN_PX * count for count in SQUARES], marginSize=0)
        return np.asarray(cv2.resize(whole, size_px, interpolation=cv2.INTER_NEAREST_EXACT), dtype=np.uint8)

    def find(self, grey: Image) -> BoardView | None:
        """The corners to be seen in `grey` (h, w) uint8, or None when there are too few to be of use."""
        corners, ids, _, _ = self._detector.detectBoard(grey)
        if ids is None or len(ids) < MIN_CORNERS:
            return None
        points = self._points[ids.ravel()]
        if min(len(np.unique(points[:, axis])) for axis in (0, 1)) < 2:
            return None
        return BoardView(np.asarray(corners, dtype=np.float64).reshape(-1, 2), points)
