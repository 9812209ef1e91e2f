"""Has the surfaces made by which real objects are drawn: while pictures go on, by a thread of its own."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.occlusion.drawn_body import Triangles, drawn_surface


@dataclass(frozen=True, slots=True, eq=False)
class _Coming:
    proxy: Proxy
    seen_in: TrackedFrame
    surface: Future[Triangles]


class DrawnBodyMaker:
    """Finding an outline takes 10 to 30 ms, for which a window would stand."""

    def __init__(self) -> None:
        self._thread: ThreadPoolExecutor | None = None
        self._coming: _Coming | None = None

    def surface(self, proxy: Proxy, seen_in: TrackedFrame | None, waits: bool) -> Triangles | None:
        """As `drawn_surface`; None while it is being made, unless the picture `waits`."""
        if waits or seen_in is None:
            return drawn_surface(proxy, seen_in)
        if self._coming is not None and not self._coming.surface.done():
            return None
        made, self._coming = self._coming, None
        if made is not None and made.proxy is proxy and made.seen_in is seen_in:
            return made.surface.result()
        self._thread = self._thread or ThreadPoolExecutor(1, "real object's outline")
        self._coming = _Coming(proxy, seen_in, self._thread.submit(drawn_surface, proxy, seen_in))
        return None

    def release(self) -> None:
        if self._thread is not None:
            self._thread.shutdown(wait=True, cancel_futures=True)
        self._thread = self._coming = None
