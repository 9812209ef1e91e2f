"""Has read in a picture how a real object and its shadows are drawn: while pictures go on, by a thread of its own."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.lights.seen.shadow import SeenShadow, seen_shadows
from ashe_live.render.occlusion.drawn_body import Triangles, drawn_surface


class ReadBody(NamedTuple):
    """A body with what a picture says of it."""

    surface: Triangles  # as `drawn_surface`
    shadows: tuple[SeenShadow, ...]  # as `seen_shadows`


def read_body(proxy: Proxy, seen_in: TrackedFrame | None, lights: tuple[Light, ...]) -> ReadBody:
    """`seen_in`: a frame that shows the object where the body stands. `lights`: those in which it shows its shadows."""
    return ReadBody(drawn_surface(proxy, seen_in), seen_shadows(proxy, seen_in, lights))


@dataclass(frozen=True, slots=True, eq=False)
class _Coming:
    proxy: Proxy
    seen_in: TrackedFrame
    body: Future[ReadBody]


class DrawnBodyMaker:
    """Finding an outline takes 10 to 30 ms, and shadows as long, for which a window would stand."""

    def __init__(self) -> None:
        self._thread: ThreadPoolExecutor | None = None
        self._coming: _Coming | None = None

    def body(
        self, proxy: Proxy, seen_in: TrackedFrame | None, lights: tuple[Light, ...], waits: bool
    ) -> ReadBody | None:
        """As `read_body`; None while it is being read, unless the picture `waits`."""
        if waits or seen_in is None:
            return read_body(proxy, seen_in, lights)
        if self._coming is not None and not self._coming.body.done():
            return None
        made, self._coming = self._coming, None
        if made is not None and made.proxy is proxy and made.seen_in is seen_in:
            return made.body.result()
        self._thread = self._thread or ThreadPoolExecutor(1, "real object's outline")
        self._coming = _Coming(proxy, seen_in, self._thread.submit(read_body, proxy, seen_in, lights))
        return None

    def release(self) -> None:
        if self._thread is not None:
            self._thread.shutdown(wait=True, cancel_futures=True)
        self._thread = self._coming = None
