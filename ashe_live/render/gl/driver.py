"""What draws, a GPU or the processor in its place, and the cheapest way to clear a part of a framebuffer on it."""

from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from ashe_live.render.gl.framing import Rectangle

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software")  # in what rasterisers without a GPU call themselves
# A software rasteriser clears a part by drawing a rectangle, at 2.4 to 6.8 ns a pixel, and all of it by filling memory,
# at 0.2 to 1.2 ns (Mesa 22.3).
WHOLE_FROM = 0.2  # share of the area from which on all of it is cleared


def is_software(info: dict[str, str]) -> bool:
    """Whether a context with this `info` uses no GPU, so that every sample of a pixel costs the processor's time."""
    renderer = info["GL_RENDERER"].lower()
    return any(word in renderer for word in SOFTWARE)


def clear_part(framebuffer: moderngl.Framebuffer, region: Rectangle, depth: float = 1.0) -> None:
    """Sets colours to 0 and depth to `depth` in `region`, and perhaps elsewhere."""
    is_large = region[2] * region[3] > WHOLE_FROM * framebuffer.width * framebuffer.height
    _end_scissor(framebuffer)
    framebuffer.clear(depth=depth, viewport=None if is_large else region)


@contextmanager
def within_scissor(framebuffer: moderngl.Framebuffer, region: Rectangle) -> Iterator[None]:
    """Binds a framebuffer; while this is active, only `region` of it is drawn into or copied to."""
    # moderngl tells OpenGL of a scissor only when the framebuffer is bound after it was set.
    framebuffer.scissor = region
    framebuffer.use()
    try:
        yield
    finally:
        _end_scissor(framebuffer)


def _end_scissor(framebuffer: moderngl.Framebuffer) -> None:
    framebuffer.scissor = None  # type: ignore[assignment]  # moderngl's stub knows no "none"
