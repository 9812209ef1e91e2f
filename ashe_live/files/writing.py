"""Files that are written at once: nothing is overwritten unasked, nothing is left half-written."""

import contextlib
import errno
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from itertools import count
from pathlib import Path
from typing import Any

from ashe_live.errors import UserError
from ashe_live.files.new_file import NewFile, cannot_write, check_output

STEM_CHARACTERS = 48  # of a stem: they have up to 4 bytes each, and names at most 255


def make_folder(folder: Path) -> None:
    """Makes the folder and its parents if they are missing. Raises UserError when that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise UserError(f"{folder} is a file, not a folder", "name a folder, which need not exist yet") from error
    except (OSError, ValueError) as error:
        raise cannot_write(folder, error) from error


def check_folder(folder: Path, names: Iterable[str] = (), overwrite: bool = False) -> None:
    """Raises UserError when the folder, or one of `names` in it, cannot or must not be written; makes nothing."""
    there = folder.absolute()
    try:
        while not _exists(there):
            there = there.parent
        if not there.is_dir():
            raise UserError(
                f"{folder if there == folder.absolute() else there} is a file, not a folder",
                "name a folder, which need not exist yet",
            )
        if not os.access(there, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except (OSError, ValueError) as error:
        raise cannot_write(folder, error) from error
    for name in names if there == folder.absolute() else ():
        check_output(folder / name, overwrite)


def _exists(path: Path) -> bool:
    """Whether anything is there, a link that leads nowhere too. Raises OSError and ValueError for what is no name."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def check_outputs(outputs: Iterable[Path | None], inputs: Iterable[Path | None], overwrite: bool) -> None:
    """Raises UserError when one of `outputs` cannot or must not be written, or is also another or one of `inputs`."""
    read = {name for path in inputs if path is not None for name in _names_of(path)}
    written: set[object] = set()
    for path in outputs:
        if path is not None:
            names = _names_of(path)
            if names & read:
                raise UserError(f"{path} is also read, and would be replaced", "give each output a file of its own")
            if names & written:
                raise UserError(f"{path} is named twice", "give each output a file of its own")
            written |= names
            check_output(path, overwrite)


def _names_of(path: Path) -> set[object]:
    """What two paths to one file have in common, also by hard links and where capitals do not matter."""
    names: set[object] = {os.path.realpath(path)}
    with contextlib.suppress(OSError):
        status = path.stat()
        names.add((status.st_dev, status.st_ino))
    return names


@contextlib.contextmanager
def written_whole(path: Path, overwrite: bool = False, beside: bool = False) -> Iterator[NewFile]:
    """Yields a file to whose `stream` the caller writes; at the end it is complete at `path`, or nothing is left.

    Results that took long should be put `beside` a file that has appeared at `path` meanwhile, rather than lost; the
    `path` of what is yielded then says where. Raises UserError when writing fails.
    """
    try:
        with NewFile(path, overwrite, beside=beside) as file:
            yield file
            file.publish(beside)
    except OSError as error:
        raise cannot_write(path, error) from error


def write_json(path: Path, content: Mapping[str, Any], overwrite: bool = False, beside: bool = False) -> Path:
    """Writes the whole file or nothing; returns its path. Raises UserError as `written_whole`, ValueError for NaN."""
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    with written_whole(path, overwrite, beside) as file:
        file.stream.write(text.encode("utf-8"))
    return file.path


def unused_name(folder: Path, stem: str, suffix: str, at: datetime) -> Path:
    """`stem-20261121-140312.png` (suffix ".png"), with -2, -3... where that exists already.

    A stem that is too long for a name is cut.
    """
    return unused(folder / f"{stem[:STEM_CHARACTERS]}-{at:%Y%m%d-%H%M%S}{suffix}")


def unused(wanted: Path) -> Path:
    """`wanted`, with -2, -3... behind its stem where that exists already."""
    path, numbers = wanted, count(2)
    while os.path.lexists(path):  # which raises nothing where the folder does not answer: writing will say that
        path = wanted.with_stem(f"{wanted.stem}-{next(numbers)}")
    return path
