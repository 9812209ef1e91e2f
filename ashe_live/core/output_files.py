"""Promises kept for every file that is written: nothing is overwritten unasked, nothing is left half-written."""

import contextlib
import json
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from itertools import count
from pathlib import Path
from typing import Any

from ashe_live.errors import UserError


def check_output(path: Path, overwrite: bool) -> None:
    """Raises UserError when `path` cannot or must not be written; writes nothing."""
    if path.is_dir():
        raise UserError(f"{path} is a folder", "name a file in it")
    if not path.parent.is_dir():
        raise UserError(f"there is no folder {path.parent}", "create it or choose another")
    if path.exists() and not overwrite:
        raise UserError(f"{path} exists already", "choose another name or give --overwrite")


def make_folder(folder: Path) -> None:
    """The folder and what is above it, if they are not there yet. Raises UserError when that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise UserError(f"{folder} is a file, not a folder", "name a folder, there or not yet") from error
    except OSError as error:
        raise cannot_write(folder, error) from error


def check_folder(folder: Path, names: Iterable[str], overwrite: bool) -> None:
    """Makes the folder, so that nothing is done in vain. Raises UserError when one of `names` must not be written."""
    make_folder(folder)
    for name in names:
        check_output(folder / name, overwrite)


def cannot_write(path: Path, error: Exception) -> UserError:
    """What to raise when writing `path` failed."""
    reason = getattr(error, "strerror", None) or str(error)
    return UserError(f"cannot write {path} ({reason})", "choose a folder that you may write to and that has space left")


def partial_name(path: Path) -> Path:
    """Hidden and in the same folder, so that the finished file can be renamed in one step."""
    return path.with_name(f".{path.stem}.partial{path.suffix}")


@contextlib.contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Within, write to the path that this gives; at the end it becomes `path`, or nothing is left of it.

    Raises UserError when writing fails.
    """
    partial = partial_name(path)
    try:
        yield partial
        partial.replace(path)
    except OSError as error:
        raise cannot_write(path, error) from error
    finally:
        partial.unlink(missing_ok=True)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Whole or not at all. Raises UserError when `path` cannot be written, ValueError for NaN."""
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    with written_whole(path) as partial:
        partial.write_text(text, encoding="utf-8")


def unused_name(folder: Path, stem: str, suffix: str, at: datetime) -> Path:
    """`stem-20261121-140312.png` (suffix ".png"), with -2, -3... where that exists already."""
    return unused(folder / f"{stem}-{at:%Y%m%d-%H%M%S}{suffix}")


def unused(path: Path) -> Path:
    """`path`, with -2, -3... behind its stem where that exists already."""
    wanted, numbers = path, count(2)
    while path.exists():
        path = wanted.with_stem(f"{wanted.stem}-{next(numbers)}")
    return path
