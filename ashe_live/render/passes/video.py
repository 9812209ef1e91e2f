"""The video in the background: uploaded once a frame, copied where the size fits, drawn scaled where it does not."""

import cv2
import moderngl
import numpy as np
from cv2.typing import MatLike

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.types import TrackedFrame
from ashe_live.render.gl.framing import Rectangle
from ashe_live.render.gl.programs import build_program, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.passes.frame_texture import FrameTexture

WHOLE_VIEWPORT = (-1.0, -1.0, 1.0, 1.0)
# Below this size on the screen over that of the frame, bilinear lookups miss pixels, so that fine cloth shows moire.
REDUCED_BELOW = 0.6


class Video:
    """The latest frame as a texture, bottom row first."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "screen/screen")
        self._rectangle = WholeRectangle(ctx)
        self._texture: FrameTexture | None = None
        self._shown: TrackedFrame | None = None
        self._lens: tuple[Camera, Camera, MatLike, MatLike] | None = None  # with the maps from the latter to the former
        self._pinhole: Camera | None = None

    def show(self, tracked: TrackedFrame, viewport: Rectangle, pinhole: Camera | None = None) -> None:
        """Uploads the frame unless it is there already, and readies the sampler for `viewport`.

        Where that is much smaller than the frame, each of its pixels is the mean of those of the frame that it shows.

        `pinhole`: as a camera with its K and without distortion sees it; as it came if None.
        """
        size = tracked.frame.size
        if max(viewport[2:]) < REDUCED_BELOW * max(size):
            size = viewport[2], viewport[3]
        if self._texture is None or self._texture.size != size:
            self._release_texture()
            self._texture = FrameTexture(self._ctx, size)
        shown = self._shown
        is_same = shown is not None and shown.frame is tracked.frame and shown.camera is tracked.camera
        if not (is_same and self._pinhole is pinhole):
            image = tracked.frame.image_bgr
            if pinhole is not None and tracked.camera.is_distorted:
                image = self._without_distortion(image, tracked.camera, pinhole)
            if size != tracked.frame.size:
                image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
            self._texture.write(image)
            self._shown, self._pinhole = tracked, pinhole
        nearest_or_linear = moderngl.NEAREST if viewport[2:] == size else moderngl.LINEAR
        self._texture.texture.filter = nearest_or_linear, nearest_or_linear

    def copy_or_draw(self, target: moderngl.Framebuffer, viewport: Rectangle) -> None:
        """Fills `viewport` of a colour-only, single-sample framebuffer."""
        assert self._texture is not None
        if viewport == (0, 0, *target.size) and target.size == self._texture.size:
            # A software rasteriser copies memory a hundred times as fast as it shades.
            self._ctx.copy_framebuffer(target, self._texture.framebuffer)
            return
        target.use()
        if viewport != (0, 0, *target.size):
            target.clear()
        self._ctx.viewport = viewport
        self.draw()

    def draw(self) -> None:
        """Draws into the current viewport."""
        self._ctx.disable(moderngl.DEPTH_TEST | moderngl.BLEND)
        assert self._texture is not None
        self._texture.texture.use(UNIT_OF["picture"])
        set_uniforms(self._program, rectangle=WHOLE_VIEWPORT)
        self._rectangle.draw(self._program)

    def bind(self) -> None:
        """For programs that read it as `video`."""
        assert self._texture is not None
        self._texture.texture.use(UNIT_OF["video"])

    def release(self) -> None:
        self._release_texture()
        self._rectangle.release()
        self._program.release()

    def _release_texture(self) -> None:
        if self._texture is not None:
            self._texture.release()
        self._texture = self._shown = None

    def _without_distortion(self, image: Image, camera: Camera, pinhole: Camera) -> Image:
        """The frame as a pinhole camera sees it, which is what OpenGL draws."""
        if self._lens is None or self._lens[0] is not camera or self._lens[1] is not pinhole:
            maps = cv2.initUndistortRectifyMap(camera.K, camera.dist, np.eye(3), pinhole.K, camera.size, cv2.CV_16SC2)
            self._lens = (camera, pinhole, *maps)
        _, _, coarse, fine = self._lens
        straight = cv2.remap(image, coarse, fine, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(straight, dtype=np.uint8)
