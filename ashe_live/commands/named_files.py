"""The photos and clips that a person names: files, folders, and patterns that the shell has left as they are."""

import glob
import mimetypes
from collections.abc import Iterable, Iterator
from pathlib import Path

from ashe_live.capture.photo import SUFFIXES


def named_files(names: Iterable[Path]) -> list[Path]:
    """In the order of `names`: of a folder the photos and clips directly in it, of a pattern what it matches, sorted.

    A name that stands for nothing stays, so that whoever reads it says what is wrong with it.
    """
    return [path for name in names for path in (_of(name) or [name])]


def _of(name: Path) -> list[Path]:
    if name.is_dir():
        return sorted(path for path in _listed(name) if _is_named_as_picture(path))
    # A file may have a pattern's characters in its name.
    if name.exists() or not glob.has_magic(str(name)):
        return [name]
    # Not Path.glob, which needs to be told where a pattern's fixed part ends.
    matches = glob.iglob(str(name), recursive=True)  # noqa: PTH207
    return sorted(path for path in map(Path, matches) if path.is_file())


def _listed(folder: Path) -> Iterator[Path]:
    try:
        yield from folder.iterdir()
    except OSError:
        return  # not ours to read, as the folder's own line will say


def _is_named_as_picture(path: Path) -> bool:
    if path.name.startswith(".") or not path.is_file():
        return False
    return path.suffix.lower() in SUFFIXES or (mimetypes.guess_type(path.name)[0] or "").startswith("video/")
