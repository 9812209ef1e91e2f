"""A window for pictures with text over them, where nothing is tracked."""

from typing import Self

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera, Size
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.quality import FAST
from ashe_live.render.hud import Hud, HudText
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.viewer.windows.glfw_window import GlfwWindow


class PictureWindow:
    """Used by the main thread only."""

    def __init__(self, title: str, size: Size) -> None:
        """Raises UserError when there is no display or no OpenGL 3.3."""
        self.window = GlfwWindow(title, size)
        self._renderer = SceneRenderer(self.window.context, FAST.render, self.window.screen.size)
        self._hud = Hud()

    def show(
        self, picture_bgr: Image, text: HudText, free_width: int | None = None, free_height: int | None = None
    ) -> None:
        """(h, w, 3) uint8, fitted into the window, which must not be minimised; the others as in `Hud.overlays`."""
        screen = self.window.screen
        if screen.size != self._renderer.size:
            self._renderer.resize(screen.size)
        frame = Frame(picture_bgr, 0, 0.0)
        camera = Camera.assumed(frame.size)
        overlays = self._hud.overlays(text, screen, free_width, free_height)
        self._renderer.render(Scene(TrackedFrame(frame, camera, None), overlays=overlays))
        self.window.present(self._renderer)
        self.window.swap()

    def close(self) -> None:
        self._renderer.release()
        self.window.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
