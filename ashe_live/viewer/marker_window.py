"""The window of `ashe-live marker --show`: the marker on a screen, for those who have no printer at hand."""

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import ASSUMED_HFOV_DEG, Camera, Size
from ashe_live.core.quality import FAST
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.render.hud import Hud, HudText
from ashe_live.render.renderer import Renderer
from ashe_live.render.scene import Scene
from ashe_live.viewer.controls import Command
from ashe_live.viewer.window import Window

SIDE_PX = 720
# White around the square, over the window's side; the rest of the screen may be dark.
MARGIN = 0.12
FRAME_S = 0.1
EXPLAINED = (
    "lay the screen flat, or film it as it stands; measure the black square's side in metres:",
    "ashe-live webcam --marker-size METRES      F: fullscreen, I: hide this, Esc: end",
)


def show_marker(spec: str, square_grey: Image) -> None:
    """Until Esc. `square_grey`: (n, n) uint8, the marker with its black border. Raises UserError without a display."""
    with Window(f"ashe-live: marker {spec}", (SIDE_PX, SIDE_PX)) as window:
        renderer = Renderer(window.context, FAST.render, window.framebuffer_size)
        hud = Hud()
        explains = True
        while not window.is_closing:
            for request in window.take_requests(FRAME_S):
                if request.command is Command.QUIT:
                    renderer.release()
                    return
                if request.command is Command.FULLSCREEN:
                    window.toggle_fullscreen()
                if request.command is Command.TOGGLE_HUD:
                    explains = not explains
            size = window.framebuffer_size
            if min(size) < 1:
                continue
            if size != renderer.size:
                renderer.resize(size)
            picture = Frame(on_white(square_grey, size), 0, 0.0)
            overlays = hud.overlays(HudText(hint=EXPLAINED if explains else ()), size, window.content_scale)
            camera = Camera.from_hfov(size, ASSUMED_HFOV_DEG, "assumed")
            renderer.render(Scene(TrackedFrame(picture, camera, None), overlays=overlays))
            renderer.present(window.context.screen)
            window.swap()
        renderer.release()


def on_white(square_grey: Image, size: Size) -> Image:
    """(h, w, 3) uint8: the square as large as its white margin allows, in the middle."""
    width, height = size
    side = max(1, round(min(size) * (1 - 2 * MARGIN)))
    picture = np.full((height, width, 3), 255, np.uint8)
    left, top = (width - side) // 2, (height - side) // 2
    square = cv2.resize(square_grey, (side, side), interpolation=cv2.INTER_NEAREST_EXACT)
    picture[top : top + side, left : left + side] = square[..., None]
    return picture
