"""The lens's distortion, by which the composite puts what was drawn for a pinhole camera onto the frame as it came."""

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.render.camera.in_frame import tangents_of_pixels
from ashe_live.render.gl.texture_units import UNIT_OF

GRID_PX = 8  # of the video, between places where the lens is computed exactly


class Lens:
    """Where a pinhole camera's picture is in the frames of a camera with distortion."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._grid: tuple[Camera, moderngl.Texture] | None = None
        self._pinhole: tuple[Camera, Camera] | None = None

    def pinhole_of(self, camera: Camera) -> Camera:
        """`wide_pinhole`, the same object for the same camera."""
        if self._pinhole is None or self._pinhole[0] is not camera:
            self._pinhole = camera, wide_pinhole(camera)
        return self._pinhole[1]

    def bind(self, camera: Camera) -> None:
        """For programs that read it as `straight_from_bent`."""
        if self._grid is None or self._grid[0] is not camera:
            self.release()
            nodes = straight_from_bent(camera, self.pinhole_of(camera))
            texture = self._ctx.texture((nodes.shape[1], nodes.shape[0]), 2, nodes.astype(np.float32), dtype="f4")
            texture.repeat_x = texture.repeat_y = False
            self._grid = camera, texture
        self._grid[1].use(UNIT_OF["straight_from_bent"])

    def release(self) -> None:
        if self._grid is not None:
            self._grid[1].release()
        self._grid = None


def wide_pinhole(camera: Camera) -> Camera:
    """A camera of the same size without distortion that sees all that `camera` sees."""
    same = camera.without_distortion()
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
    tangents = tangents_of_pixels(camera, pixels.reshape(-1, 2))
    straight = (tangents @ pinhole.K[:2, :2].T + pinhole.K[:2, 2]).reshape(pixels.shape)
    return np.stack([(straight[..., 0] + 0.5) / width, 1 - (straight[..., 1] + 0.5) / height], axis=-1)
