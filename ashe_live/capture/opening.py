"""Opens a photo or a clip as a source of frames."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from ashe_live.capture.sources import Source
from ashe_live.core import arguments
from ashe_live.errors import UserError


def open_source(path: str | Path) -> Source:
    """The photo or clip in the file `path`, told apart by content. Raises UserError when there is neither.

    It is a context manager, has a `size` (width, height), and gives its frames one after another when iterated over,
    each with its `image_bgr`, `index` and `time_s`.
    """
    # Each kind loads a library of its own, which the other does not need.
    from ashe_live.capture.photo import PhotoSource, looks_like_photo

    path = arguments.path(path, "path")
    if looks_like_photo(path):
        return PhotoSource(path)
    from ashe_live.capture.clips.clip import ClipSource

    return ClipSource(path)


def openable(paths: Sequence[Path]) -> Iterator[Source]:
    """The photos and clips that can be opened, each open until the next one is asked for."""
    for path in paths:
        try:
            source = open_source(path)
        except UserError:
            continue
        with source:
            yield source
