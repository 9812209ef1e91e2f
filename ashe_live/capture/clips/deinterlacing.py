"""Pictures woven of two fields, as camcorders record them, without the teeth along whatever moves.

The odd lines of such a picture were taken half a frame later than the even ones. FFmpeg's `bwdif` (after the BBC's
filter of Weston and Martin) keeps both where nothing moves, and where something does replaces the later ones.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import suppress

import av.error
from av.filter import Graph
from av.video.frame import VideoFrame

# One picture for one, and those that are not woven as they are.
OPTIONS = "mode=send_frame:deint=interlaced"


def progressive(videos: Iterable[VideoFrame]) -> Iterator[VideoFrame]:
    """As many pictures, with the same times; from the first woven one on, each comes when the next is there."""
    filtering: _Filter | None = None
    for video in videos:
        if filtering is not None and not filtering.takes(video):
            yield from filtering.rest()
            filtering = None
        if filtering is None and video.interlaced_frame:
            with suppress(av.error.FFmpegError):  # it wants a few lines: fewer stay as they are
                filtering = _Filter(video)
        if filtering is None:
            yield video
        else:
            yield from filtering.passed(video)
    if filtering is not None:
        yield from filtering.rest()


class _Filter:
    """For pictures of one size and format.

    It tells what moves by the pictures before and after. Without one before, it keeps every other line alone, of the
    whole picture: so the second counts as the one before the first as well.
    """

    def __init__(self, first: VideoFrame) -> None:
        self._kind = _kind(first)
        self._graph = Graph()
        self._graph.threads = 1  # more are taken from the renderer
        source = self._graph.add_buffer(
            width=first.width, height=first.height, format=first.format, time_base=first.time_base
        )
        weave, sink = self._graph.add("bwdif", OPTIONS), self._graph.add("buffersink")
        source.link_to(weave)
        weave.link_to(sink)
        self._graph.configure()
        self._held: deque[VideoFrame | None] = deque()  # of which nothing has come back yet; None: not to be shown
        self._first: VideoFrame | None = first  # until the second is there

    def takes(self, video: VideoFrame) -> bool:
        return _kind(video) == self._kind

    def passed(self, video: VideoFrame) -> Iterator[VideoFrame]:
        if self._first is video:
            return
        if self._first is not None:
            self._push(video, is_shown=False)
            self._push(self._first)
            self._first = None
        self._push(video)
        yield from self._pulled()

    def rest(self) -> Iterator[VideoFrame]:
        if self._first is not None:  # there is one alone
            self._push(self._first)
        self._graph.push(None)
        yield from self._pulled()

    def _push(self, video: VideoFrame, is_shown: bool = True) -> None:
        self._graph.push(video)
        self._held.append(video if is_shown else None)

    def _pulled(self) -> Iterator[VideoFrame]:
        while self._held:
            try:
                picture = self._graph.vpull()
            except (av.error.BlockingIOError, av.error.EOFError):
                return
            of = self._held.popleft()
            if of is not None:
                # The filter counts in halves of the clip's unit.
                picture.pts, picture.duration, picture.time_base = of.pts, of.duration, of.time_base
                yield picture


def _kind(video: VideoFrame) -> tuple[int, int, str]:
    return video.width, video.height, video.format.name
