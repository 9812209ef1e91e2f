"""The ground's local mean brightness, from which its relief deviates; the cover in place of the marker's sheet."""

import math

import moderngl

from ashe_live.render.camera.relief import MEANS_ACROSS
from ashe_live.render.cover.marker_cover import SeenCover
from ashe_live.render.gl.canvas import Canvas
from ashe_live.render.gl.framing import Rectangle, grown
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle

SPLINE_REACH = 2  # texels to either side of a place that count there


class GroundMeans:
    """Means of the ground before it is darkened; read by programs as `ground_mean`."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._programs = programs
        self._rectangle = WholeRectangle(ctx)
        self._canvas = Canvas(ctx, 1, "f2")

    def draw(self, within: Rectangle, viewport: Rectangle, cover: SeenCover | None, bends: bool) -> tuple[float, float]:
        """Draws the means that count in `within`, pixels of the framebuffer; returns how many are across and up
        `viewport`. Video and, if it `bends`, lens must be bound. Leaves another framebuffer bound.
        """
        left, bottom, width, height = viewport
        means = float(MEANS_ACROSS), MEANS_ACROSS * height / width
        framebuffer = self._canvas.of_size((MEANS_ACROSS, math.ceil(means[1])))
        program = self._programs.get("compositing/ground_mean", covers=cover is not None, bends=bends)
        set_uniforms(program, viewport=tuple(map(float, viewport)), means=means)
        if cover is not None:
            cover.bind(program)
        per_px = means[0] / width
        lower = math.floor((within[0] - left) * per_px), math.floor((within[1] - bottom) * per_px)
        upper = math.ceil((within[0] + within[2] - left) * per_px), math.ceil((within[1] + within[3] - bottom) * per_px)
        used = (*lower, upper[0] - lower[0], upper[1] - lower[1])
        framebuffer.scissor = grown(used, SPLINE_REACH, framebuffer.size)
        self._rectangle.fill(framebuffer, program)
        self._canvas.bind("ground_mean")
        return means

    def release(self) -> None:
        self._rectangle.release()
        self._canvas.release()
