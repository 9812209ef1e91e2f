"""Has the surfaces made by which real objects are drawn: while pictures go on, by a thread of its own."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.render.occlusion.drawn_body import drawn_surface

Surface = tuple[Float, NDArray[np.uint32]]


@dataclass(frozen=True, slots=True, eq=False)
class _Coming:
    proxy: Proxy
    seen_in: TrackedFrame
    surface: Future[Surface]


class DrawnBodyMaker:
    """Finding an outline takes 10 to 30 ms, for which a window would stand."""

    def __init__(self) -> None:
        self._thread: ThreadPoolExecutor | None = None
        self._coming: _Coming | None = None

    def surface(self, proxy: Proxy, seen_in: TrackedFrame | None, waits: bool) -> Surface | None:
        """As `drawn_surface`; None while it is being made, unless the picture `waits`."""
        if waits or seen_in is None:
            return drawn_surface(proxy, seen_in)
        coming = self._coming
        if coming is None or (coming.surface.done() and not (coming.proxy is proxy and coming.seen_in is seen_in)):
            self._thread = self._thread or ThreadPoolExecutor(1, "real object's outline")
            self._coming = _Coming(proxy, seen_in, self._thread.submit(drawn_surface, proxy, seen_in))
            return None
        if not coming.surface.done():
            return None
        self._coming = None
        return coming.surface.result()

    def release(self) -> None:
        if self._thread is not None:
            self._thread.shutdown(wait=True, cancel_futures=True)
        self._thread = self._coming = None
