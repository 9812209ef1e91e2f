"""The window of `ashe-live marker --show`: the marker on a screen, where there is no printer."""

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
EXPLAINED = (
    "lay the screen flat, or film it as it stands; measure the black square's side in metres:",
    "ashe-live webcam --marker-size METRES      F: fullscreen, I: hide this, Esc: end",
)


def show_marker(spec: str, square_grey: Image) -> None:
    """Shows the marker until Esc. `square_grey`: (n, n) uint8, with its border. Raises UserError without a display."""
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
                pictures.show(on_white(square_grey, window.screen.size), HudText(hint=EXPLAINED if explains else ()))


def on_white(square_grey: Image, size: Size) -> Image:
    """(h, w, 3) uint8: the square as large as its white margin allows, in the middle."""
    width, height = size
    side = max(1, round(min(size) * (1 - 2 * MARGIN)))
    picture = np.full((height, width, 3), 255, np.uint8)
    left, top = (width - side) // 2, (height - side) // 2
    square = cv2.resize(square_grey, (side, side), interpolation=cv2.INTER_NEAREST_EXACT)
    picture[top : top + side, left : left + side] = square[..., None]
    return picture
