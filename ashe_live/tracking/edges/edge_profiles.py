"""Samples the light across each side of a square, and locates the rise from black to white in it."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.tracking.edges.lens import source_from_ideal

Light = NDArray[np.float32]

# Number of samples across an edge.
ACROSS = 25
FROM_INSIDE = np.linspace(-1, 1, ACROSS)
MIDDLES = ((FROM_INSIDE[1:] + FROM_INSIDE[:-1]) / 2).astype(np.float32)
HALF, TINY = np.float32(0.5), np.float32(1e-9)
# Least rise of an edge from black to white, over the encoded picture's range (whose curve is taken for a square root).
MIN_RISE = 12 / 255
# Smaller rises than this share of an edge's steepest one are noise.
NOISE_RISE = 0.15
# The window is centred on the edge this many times.
SHIFTS = 4
# Stands for light where there is no picture.
OUTSIDE = -1e3
LINEAR: Light = LINEAR_FROM_SRGB_8BIT.astype(np.float32)


def linear_light(grey: Image) -> Light:
    """(h, w) linear light in [0, 1] of an encoded picture (h, w)."""
    return np.asarray(cv2.LUT(grey, LINEAR), dtype=np.float32)


@dataclass(frozen=True, slots=True)
class LightPatch:
    """A part of the picture, asked for at ideal pixels."""

    light: Light  # (h, w) linear
    camera: Camera | None  # that took the picture; None where its pixels are ideal ones
    origin_px: Float  # (2,) of the whole picture, at which the part begins

    @property
    def is_distorted(self) -> bool:
        """Whether the picture's pixels are no ideal ones."""
        return self.camera is not None and self.camera.is_distorted

    def source_px(self, ideal_px: Float) -> Float:
        """(n, 2) pixels of the whole picture of ideal pixels (n, 2)."""
        return ideal_px if self.camera is None else source_from_ideal(self.camera, ideal_px)

    def at(self, x_px: Float, y_px: Float) -> Light:
        """Linear light at ideal pixels, x and y (ACROSS, s, samples), interpolated; negative where the picture ends."""
        if self.is_distorted:
            x_px, y_px = self.source_px(np.column_stack([x_px.ravel(), y_px.ravel()])).T.reshape(2, *x_px.shape)
        left, top = self.origin_px
        # OpenCV's remap wants fewer than 32768 rows or columns.
        x, y = (x_px - left).astype(np.float32), (y_px - top).astype(np.float32)
        rows = len(x_px), -1
        values = cv2.remap(
            self.light,
            x.reshape(rows),
            y.reshape(rows),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=OUTSIDE,
        )
        return np.asarray(values, dtype=np.float32).reshape(x_px.shape)


def edge_offsets(values: Light, reaches_px: Float, spreads_px: Float) -> tuple[Float, Float, Float]:
    """How far outwards the edge lies, in pixels, whether there is one, as 0 or 1, and each side's blur.

    `values` (ACROSS, s, samples) is the light across s sides, of one square or of several, from `reaches_px` (s,)
    within them to as far beyond them; `spreads_px` (s,) is the half width of the window in which an edge's place is
    measured. The first two results are (s, samples), the third is (s,) standard deviations in pixels. The edge is the
    centre of gravity of the rise from black to white; a fall, as from paper to ground, is none.
    """
    samples = values.shape[2]
    rises = np.maximum(values[1:] - values[:-1], 0)
    # In units of the window's half width. Single precision suffices, and whole arrays are faster than broadcast ones.
    unit = np.repeat((reaches_px / spreads_px).astype(np.float32)[:, None], samples, axis=1)
    step = np.float32(2 / (ACROSS - 1)) * unit
    centres = MIDDLES[:, None, None] * unit
    borders = (_rises_from_black(values).argmax(axis=0) + HALF) * step - unit
    rises_near = np.where(np.abs(centres - borders) <= 1, rises, np.float32(-1))
    offsets = (rises_near.argmax(axis=0) + HALF) * step - unit
    # A mean shift from the steepest place: a window fixed there would pull the centre of gravity towards noise.
    for _ in range(SHIFTS):
        away = centres - offsets
        weights = rises * np.maximum(1 - away * away, 0)
        total = weights.sum(axis=0)
        offsets = (weights * centres).sum(axis=0) / np.maximum(total, TINY)
    dark = values.min(axis=0)
    rise = np.sqrt(np.maximum(dark + total, 0)) - np.sqrt(np.maximum(dark, 0))
    is_edge = ((dark >= 0) & (rise >= MIN_RISE)).astype(np.float32)
    steep = is_edge * np.maximum(rises - NOISE_RISE * rises.max(axis=0), 0)
    away = centres - (steep * centres).sum(axis=0) / np.maximum(steep.sum(axis=0), TINY)
    squared = (steep * away * away).sum(axis=(0, 2)) / np.maximum(steep.sum(axis=(0, 2)), TINY)
    return offsets * spreads_px[:, None], is_edge.astype(np.float64), np.sqrt(squared) * spreads_px


def _rises_from_black(values: Light) -> Light:
    """(ACROSS - 1, ...) how steep the light (ACROSS, ...) rises, the more the nearer to its darkest.

    Of several rises the border's is the one from black. A floor in the sun is steeper above its paper than paper in the
    shade above its ink, in linear light; so the steps are compared in a curve like the eye's.
    """
    seen = np.sqrt(np.maximum(values, 0))
    before, after = seen[:-1], seen[1:]
    return np.asarray((after - before) * (2 * seen.max(axis=0) - before - after))
