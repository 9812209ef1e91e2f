"""Applies the lens's distortion to what was drawn for a pinhole camera, and puts it onto the original frame."""

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.render.canvas import Canvas
from ashe_live.render.framing import Rectangle
from ashe_live.render.programs import build_program, set_uniforms
from ashe_live.render.texture_units import UNIT_OF

GRID_PX = 8  # of the video, between places where the lens is computed exactly


class Lens:
    """The last pass for cameras with distortion."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "lens")
        self._rectangle = ctx.vertex_array(self._program, [])
        self._original: moderngl.Texture | None = None
        self._grid: tuple[Camera, moderngl.Texture] | None = None
        self._pinhole: tuple[Camera, Camera] | None = None
        self._bare, self._drawn = Canvas(ctx), Canvas(ctx)
        self._shown: Frame | None = None

    def pinhole_of(self, camera: Camera) -> Camera:
        """`wide_pinhole`, the same object for the same camera."""
        if self._pinhole is None or self._pinhole[0] is not camera:
            self._pinhole = camera, wide_pinhole(camera)
        return self._pinhole[1]

    def keep_bare(self, target: moderngl.Framebuffer) -> None:
        """Keeps a copy of the pinhole picture before anything is drawn on it."""
        _, framebuffer = self._bare.of_size(target.size)
        self._ctx.copy_framebuffer(framebuffer, target)

    def draw(self, target: moderngl.Framebuffer, tracked: TrackedFrame, viewport: Rectangle, region: Rectangle) -> None:
        """Replaces `target`'s `viewport`, in whose `region` (empty: nowhere) something was drawn since `keep_bare`."""
        bare, _ = self._bare.of_size(target.size)
        drawn, framebuffer = self._drawn.of_size(target.size)
        self._ctx.copy_framebuffer(framebuffer, target)
        textures = {
            "original": self._uploaded(tracked.frame),
            "bare": bare,
            "drawn": drawn,
            "straight_from_bent": self._grid_of(tracked.camera),
        }
        for name, texture in textures.items():
            texture.use(UNIT_OF[name])
        bounds = {"viewport": tuple(map(float, viewport)), "region": tuple(map(float, region))}
        set_uniforms(self._program, **bounds)
        target.use()
        self._ctx.viewport = viewport
        self._ctx.enable_only(moderngl.NOTHING)
        self._rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)

    def release(self) -> None:
        self._bare.release()
        self._drawn.release()
        if self._original is not None:
            self._original.release()
        if self._grid is not None:
            self._grid[1].release()
        self._original = self._grid = self._shown = None
        self._rectangle.release()
        self._program.release()

    def _uploaded(self, frame: Frame) -> moderngl.Texture:
        if self._original is None or self._original.size != frame.size:
            if self._original is not None:
                self._original.release()
            self._original = self._ctx.texture(frame.size, 4)
            self._original.repeat_x = self._original.repeat_y = False
            self._shown = None
        if self._shown is not frame:
            self._original.write(cv2.cvtColor(cv2.flip(frame.image_bgr, 0), cv2.COLOR_BGR2RGBA))
            self._shown = frame
        return self._original

    def _grid_of(self, camera: Camera) -> moderngl.Texture:
        if self._grid is None or self._grid[0] is not camera:
            if self._grid is not None:
                self._grid[1].release()
            nodes = straight_from_bent(camera, self.pinhole_of(camera))
            texture = self._ctx.texture((nodes.shape[1], nodes.shape[0]), 2, nodes.astype(np.float32), dtype="f4")
            texture.repeat_x = texture.repeat_y = False
            self._grid = camera, texture
        return self._grid[1]


def wide_pinhole(camera: Camera) -> Camera:
    """A camera of the same size without distortion that sees all that `camera` sees."""
    same = Camera(camera.size, camera.K, np.zeros(5), camera.source)
    reach = float(np.abs(2 * straight_from_bent(camera, same) - 1).max())
    K = camera.K.copy()
    # About the picture's centre, which is half a pixel from OpenCV's origin of pixels.
    centre = (np.array(camera.size) - 1) / 2
    K[:2, :2] /= max(reach, 1.0)
    K[:2, 2] = centre + (K[:2, 2] - centre) / max(reach, 1.0)
    return Camera(camera.size, K, np.zeros(5), camera.source)


def straight_from_bent(camera: Camera, pinhole: Camera) -> Float:
    """(rows, columns, 2): where `pinhole` sees what the lens maps to the nodes of a regular grid.

    Both in fractions of the picture, from its lower left corner.
    """
    width, height = camera.size
    across, up = np.meshgrid(
        np.linspace(0, 1, max(2, width // GRID_PX + 1)), np.linspace(0, 1, max(2, height // GRID_PX + 1))
    )
    # OpenCV's pixel centres are integers, and its rows run downwards.
    pixels = np.stack([across * width - 0.5, (1 - up) * height - 0.5], axis=-1)
    straight = cv2.undistortPoints(pixels.reshape(-1, 1, 2), camera.K, camera.dist, P=pinhole.K).reshape(pixels.shape)
    return np.stack([(straight[..., 0] + 0.5) / width, 1 - (straight[..., 1] + 0.5) / height], axis=-1)
