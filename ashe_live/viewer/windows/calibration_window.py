"""The window of `ashe-live calibrate`: the camera's picture, where the board has been, and where it should go."""

from typing import Self

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Image, fixed_point
from ashe_live.core.camera import Size
from ashe_live.core.types import Frame
from ashe_live.render.hud import HudText
from ashe_live.tracking.boards.calibration_board import BoardView
from ashe_live.tracking.boards.calibration_guide import CUTS, CalibrationGuide
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.windows.picture_window import PictureWindow

# Okabe and Ito's orange and bluish green.
CORNER_BGR = (0, 159, 230)
KEPT_BGR = (115, 158, 0)
UNSEEN = 0.55  # brightness factor of the cells in which the board has not been seen yet


class CalibrationWindow:
    """Shows frames as they come. Used by the main thread only."""

    def __init__(self, name: str, size: Size) -> None:
        self._pictures = PictureWindow(f"ashe-live: calibrate {name}", size)

    def show(self, frame: Frame, view: BoardView | None, guide: CalibrationGuide, said: str | None) -> bool:
        """Shows one frame; returns False when the window is closed or Esc is pressed."""
        window = self._pictures.window
        if not window.screen.is_minimised:
            hint = (said,) if said else ()
            text = HudText(progress_lines(view, guide), (*hint, "Esc: end with the views so far"))
            self._pictures.show(guidance_picture(frame.image_bgr, view, guide), text)
        wants_end = any(request.command is Command.LEAVE for request in window.take_requests(0.0))
        return not (wants_end or window.is_closing)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._pictures.close()


def progress_lines(view: BoardView | None, guide: CalibrationGuide) -> tuple[str, ...]:
    state = f"{100 * guide.progress:.0f} %   views: {len(guide.kept)}"
    return (state, "no board in view" if view is None else (guide.wanted() or "enough"))


def guidance_picture(image_bgr: Image, view: BoardView | None, guide: CalibrationGuide) -> Image:
    """(h, w, 3) uint8: unseen cells darkened, the kept views' outlines, and the corners found now."""
    picture = image_bgr.copy()
    height, width = picture.shape[:2]
    columns, rows = (np.round(np.array(CUTS) * side).astype(int) for side in (width, height))
    for row, cells in enumerate(guide.covered()):
        for column, is_covered in enumerate(cells):
            if not is_covered:
                cell = picture[rows[row] : rows[row + 1], columns[column] : columns[column + 1]]
                cell[:] = (cell * UNSEEN).astype(np.uint8)
    line_px = max(1, round(height / 480))
    for kept in guide.kept:
        hull = cv2.convexHull(kept.view.corners_px.astype(np.float32))
        cv2.polylines(picture, [fixed_point(hull)], True, KEPT_BGR, line_px, cv2.LINE_AA, FRACTION_BITS)
    for corner in view.corners_px if view is not None else ():
        radius = 3 * line_px << FRACTION_BITS
        cv2.circle(picture, fixed_point(corner).tolist(), radius, CORNER_BGR, line_px, cv2.LINE_AA, FRACTION_BITS)
    return picture
