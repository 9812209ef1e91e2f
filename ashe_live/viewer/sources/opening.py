"""Opens a dropped file off the main thread; a file that cannot be shown changes nothing."""

import os
import re
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from ashe_live.capture.folder import is_named_as_picture, is_named_as_video
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.models.loading import SUFFIXES
from ashe_live.viewer.sources.background import in_background
from ashe_live.viewer.sources.pipeline import Pipeline

# Long enough for a disk that must spin up, or a network.
LONGEST_S = 20.0
FILE_URI = "file://"
MOST_CHARACTERS = 300_000  # of copied text, which may be anything
QUOTES = "\"'"
QUOTE_IN_QUOTES = "'\\''"
ESCAPED = re.compile(r"\\(\W)")
NAMING_OTHERS = {".gltf", ".obj", ".ply"}  # suffixes of models whose textures are files of their own
LONGEST_NAME = 255  # characters, of a file or folder on the systems in use


@dataclass(frozen=True, slots=True)
class Opened:
    """A source that plays, with its first tracked frame."""

    name: str
    pipeline: Pipeline
    first: TrackedFrame


# Opens the file, or the next camera, and starts a pipeline on it; raises UserError.
Opener = Callable[[Path | None], Pipeline]


class Opening:
    """Opens one file at a time; a later one replaces one that is being opened. Used by the main thread only."""

    def __init__(self, opener: Opener | None) -> None:
        """Without an opener nothing can be opened."""
        self._opener = opener
        self._progress = ""
        self._coming: Future[Opened] | None = None

    @property
    def progress(self) -> str | None:
        """The line that says what is being opened; None if nothing is."""
        return None if self._coming is None else self._progress

    def begin(self, path: Path | None) -> None:
        """Begins to open the file, or without one the next camera, where anything can be opened."""
        if self._opener is None:
            return
        opener = self._opener
        what = "another camera" if path is None else str(path)
        remedy = "plug it in again" if path is None else "convert it"
        self.close()
        self._progress = f"opening {what if path is None else path.name}"
        self._coming = in_background(
            "opening",
            lambda: _opened(opener, path),
            lambda reason: UserError(f"cannot open {what} ({reason})", remedy),
        )

    def take(self) -> Opened | None:
        """The source that has been opened, returned once; None until then. Raises UserError, once, if there is none."""
        if self._coming is None or not self._coming.done():
            return None
        coming, self._coming = self._coming, None
        return coming.result()

    def close(self) -> None:
        """Abandons the file that is being opened."""
        if self._coming is not None:
            self._coming.add_done_callback(_close_pipeline)
            self._coming = None


def _opened(opener: Opener, path: Path | None) -> Opened:
    pipeline = opener(path)
    try:
        first = pipeline.frames.take(LONGEST_S)
        if first is None:
            remedy = "plug it in again" if path is None else "copy it to a faster disk"
            raise UserError(f"{pipeline.name} has given no picture for {LONGEST_S:.0f} s", remedy)
    except BaseException:
        pipeline.close(0.0)
        raise
    return Opened(pipeline.name, pipeline, first)


def _close_pipeline(coming: "Future[Opened]") -> None:
    if coming.exception() is None:
        coming.result().pipeline.close(0.0)


def paths_in(text: str) -> tuple[str, ...]:
    """The files named in copied text, one a line, as file managers and shells write paths."""
    lines = [line for raw in text[:MOST_CHARACTERS].splitlines() if (line := raw.strip())]
    # Beside addresses, some file managers copy words of their own ("copy", "x-special/nautilus-clipboard").
    uris = [line for raw in lines if (line := raw.strip(QUOTES)).startswith(FILE_URI)]
    if uris:
        return tuple(map(_path_of_uri, uris))
    # A paragraph names no file, and would fill the window with the line that says so.
    return tuple(path for line in lines if (path := _path_of_line(line)) and not _is_too_long(path))


def _path_of_line(line: str) -> str:
    """A path as terminals write it: within quotes, with backslashes before its spaces, or in the home folder."""
    path = line.strip(QUOTES)
    if os.name == "posix":  # elsewhere a backslash separates folders, and no name has such a quote
        path = ESCAPED.sub(r"\1", path) if path == line else path.replace(QUOTE_IN_QUOTES, "'")
    # Path.expanduser would raise an error where there is no home folder.
    return os.path.expanduser(path) if path.startswith("~/") else path  # noqa: PTH111


def _is_too_long(path: str) -> bool:
    return any(len(part) > LONGEST_NAME for part in re.split(r"[/\\]", path))


def _path_of_uri(uri: str) -> str:
    # Copied text may be anything: urlsplit raises ValueError for some of it.
    _, _, path = uri.removeprefix(FILE_URI).partition("/")  # without the name of a host
    path = "/" + unquote(path, errors="surrogateescape")
    # On Windows a file's URL is file:///C:/name, with a slash too many.
    return path[1:] if path[2:3] == ":" else path


def of_each_kind(paths: Sequence[str]) -> tuple[list[str], list[str]]:
    """The models among files that were dropped together, and the sources; each once.

    Beside a model only videos count as sources, and photos if no model's file may name them as its own; other files
    that lie beside a model belong to it.
    """
    paths = list(dict.fromkeys(paths))
    suffixes = [Path(path).suffix.lower() for path in paths]
    models = [path for path, suffix in zip(paths, suffixes, strict=True) if suffix in SUFFIXES]
    if not models:
        return [], paths
    is_source = is_named_as_video if set(suffixes) & NAMING_OTHERS else is_named_as_picture
    return models, [path for path in paths if is_source(Path(path))]
