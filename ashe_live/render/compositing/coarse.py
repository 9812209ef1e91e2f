"""The layers, blurred as the video's colours are: at half the resolution, and along one axis after the other.

Nothing in so wide a blur is as fine as a pixel, and a Gaussian is the product of its rows and columns.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Size
from ashe_live.render.gl.canvas import Canvas
from ashe_live.render.gl.framing import Rectangle, corner_pixels, grown
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.passes.surface import Surface

# px²: the mean of 2 x 2 pixels has 1/4; interpolated a quarter of the way between two of them it gets 3/4 more.
LEAST_VARIANCE = 1.0
MOST_TAPS = 6  # to each side of the middle; a wider blur is cut off there
KERNEL_SIGMAS = 2.0  # of a Gaussian within its kernel's reach


class CoarseBlur(NamedTuple):
    """A Gaussian at half the resolution."""

    variance: float  # of its kernel, in pixels of half the resolution
    taps: int  # to each side of the middle one, which it has at least one of

    @classmethod
    def of(cls, variance_px2: float) -> "CoarseBlur":
        """The blur whose result has this variance, in pixels of the framebuffer; at least LEAST_VARIANCE."""
        variance = max(variance_px2 - LEAST_VARIANCE, 0.0) / 4
        return cls(variance, min(MOST_TAPS, max(1, math.ceil(KERNEL_SIGMAS * math.sqrt(variance)))))

    @property
    def reach_px(self) -> int:
        """How far a pixel of the framebuffer counts."""
        return 2 * self.taps + 3


class CoarseLayers:
    """A surface's layers, blurred at half the resolution; read by programs as `coarse_light` and `coarse_gone`."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._programs = programs
        # What is finished, and what is blurred in rows alone.
        self._layers, self._in_rows = (Canvas(ctx, 4, "f2", count=2) for _ in range(2))
        self._rectangle = WholeRectangle(ctx)

    def draw(self, surface: Surface, region: Rectangle, viewport: Rectangle, blur: CoarseBlur, spread: int) -> None:
        """Blurs `surface`'s layers where they are looked up in `region`, beside which they must be empty.

        As far as `blur.reach_px` beyond it. Beyond the border of the video, which is in `viewport`, they go on as they
        are there. Their alpha also says where the layers are even as far as `spread` pixels of half the resolution
        around. Leaves another framebuffer bound.
        """
        width, height = surface.size
        size = (width + 1) // 2, (height + 1) // 2
        wanted = _halved(grown(region, 2, surface.size))
        in_rows = _above_and_below(wanted, blur.taps, size)
        surface.bind_layers()
        halving = self._programs.get("compositing/halved")
        set_uniforms(halving, **corner_pixels(viewport))
        self._draw_into(self._layers, size, grown(wanted, blur.taps, size), halving)
        program = self._programs.get("compositing/coarse", taps=blur.taps, spread=min(spread, blur.taps))
        set_uniforms(program, weights=line_weights(*blur))
        for target, within, along in ((self._in_rows, in_rows, (1, 0)), (self._layers, wanted, (0, 1))):
            set_uniforms(program, along=along)
            self._draw_into(target, size, within, program)

    def bind(self) -> None:
        self._layers.bind("coarse_light", "coarse_gone")

    def release(self) -> None:
        for held in (self._layers, self._in_rows, self._rectangle):
            held.release()

    def _draw_into(self, target: Canvas, size: Size, within: Rectangle, program: moderngl.Program) -> None:
        framebuffer = target.of_size(size)
        framebuffer.scissor = within
        self._rectangle.fill(framebuffer, program)
        target.bind("added_light", "removed")


def _halved(rectangle: Rectangle) -> Rectangle:
    """All pixels of half the resolution in which it lies."""
    left, bottom, width, height = rectangle
    return left // 2, bottom // 2, (left + width + 1) // 2 - left // 2, (bottom + height + 1) // 2 - bottom // 2


def _above_and_below(rectangle: Rectangle, by: int, size: Size) -> Rectangle:
    left, bottom, width, height = rectangle
    lowest = max(0, bottom - by)
    return left, lowest, width, min(size[1], bottom + height + by) - lowest


@lru_cache(maxsize=4)
def line_weights(variance: float, taps: int) -> Float:
    """(taps + 1,) of a line's middle and its neighbours on either side, which sum to 1 and have that variance.

    As a Gaussian that is cut off has too little, its own is raised.
    """
    at = np.arange(-taps, taps + 1)
    if variance <= 0:
        return np.where(at[taps:] == 0, 1.0, 0.0)
    low, high = variance / 40, 40.0 * variance
    for _ in range(40):
        raised = math.sqrt(low * high)
        line = np.exp(-(at**2) / (2 * raised))
        line /= line.sum()
        low, high = (raised, high) if float(line @ at**2) < variance else (low, raised)
    return np.asarray(line[taps:], np.float64)
