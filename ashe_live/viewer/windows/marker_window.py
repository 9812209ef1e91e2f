"""The window of `ashe-live marker --show`: the marker on a screen, where there is no printer."""

from collections.abc import Sequence

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.hud import HudText
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.windows.picture_window import PictureWindow

SIDE_PX = 720
# Width of the white around the square, as a fraction of the window's side; the rest of the screen may be dark.
MARGIN = 0.12
FRAME_S = 0.1
LEAST_TEXT = 0.6  # width of the explanation beside the marker, as a fraction of the window's height


def show_marker(spec: str, square_grey: Image, flags: Sequence[str]) -> None:
    """Shows the marker until Esc. `square_grey`: (n, n) uint8, with its border. Raises UserError without a display.

    `flags`: those by which a camera looks for it, but for its size.
    """
    explained = (
        "lay the screen flat, or film it as it stands      F: fullscreen, I: hide this, Esc: end",
        " ".join(["measure the black square: ashe-live webcam", *flags, "--marker-size METRES"]),
    )
    with PictureWindow(f"ashe-live: marker {spec}", (SIDE_PX, SIDE_PX)) as pictures:
        window = pictures.window
        explains = True
        while not window.is_closing:
            for request in window.take_requests(FRAME_S):
                if request.command is Command.LEAVE:
                    return
                if request.command is Command.FULLSCREEN:
                    window.toggle_fullscreen()
                if request.command is Command.TOGGLE_HUD:
                    explains = not explains
            if not window.screen.is_minimised:
                size = window.screen.size
                text = HudText(hint=explained if explains else ())
                beside = room_beside(size)
                pictures.show(on_white(square_grey, size), text, beside, room_below(size) if beside is None else None)


def room_beside(size: Size) -> int | None:
    """Pixels from the left that text may have so that it does not reach the marker; None: there is too little room."""
    width, height = size
    room = (width - height) // 2
    return room if room > LEAST_TEXT * height else None


def room_below(size: Size) -> int:
    """Pixels from below that text may have so that it does not reach the marker."""
    return max(1, (size[1] - _square_side(size)) // 2)


def on_white(square_grey: Image, size: Size) -> Image:
    """(h, w, 3) uint8: the square as large as its white margin allows, in the middle."""
    width, height = size
    side = _square_side(size)
    picture = np.full((height, width, 3), 255, np.uint8)
    left, top = (width - side) // 2, (height - side) // 2
    square = cv2.resize(square_grey, (side, side), interpolation=cv2.INTER_NEAREST_EXACT)
    picture[top : top + side, left : left + side] = square[..., None]
    return picture


def _square_side(size: Size) -> int:
    return max(1, round(min(size) * (1 - 2 * MARGIN)))
