"""The photos and clips that a person names: files, folders, and patterns that the shell has left as they are."""

import glob
import re
from collections.abc import Iterable, Iterator
from itertools import takewhile
from pathlib import Path

from ashe_live.capture.folder import pictures_in
from ashe_live.errors import UserError
from ashe_live.process.messages import print_message


def named_files(names: Iterable[Path]) -> list[Path]:
    """The files in the order of `names`; a folder stands for the photos and clips in it, a pattern for what it matches.

    Both are sorted, and one line says what is passed over in a folder. A name without a file is kept, so that opening
    it says what is wrong.
    """
    return [path for name in names for path in (_of(name) or [name])]


def _of(name: Path) -> list[Path]:
    try:
        is_folder, is_there = name.is_dir(), name.exists()
    except OSError:  # a name that is too long, a folder that must not be entered
        return [name]
    if is_folder:
        return _in_folder(name)
    # A file may have a pattern's characters in its name.
    if is_there or not glob.has_magic(str(name)):
        return [name]
    return sorted(path for path in _matching(name) if _is_file(path))


def _matching(pattern: Path) -> Iterator[Path]:
    """The paths that a shell would match: none hidden unless the pattern says so, and no links to folders followed.

    (glob.iglob follows links to folders; a few that lead back to their own folder make it go on for ever.)
    """
    parts = [part if part == "**" else re.sub(r"\*{2,}", "*", part) for part in pattern.parts[bool(pattern.anchor) :]]
    if parts[-1] == "**":  # for which pathlib returns folders only
        parts.append("*")
    root = Path(pattern.anchor)
    # The folders before the first of its characters are named in full, hidden ones and `..` too.
    named = sum(1 for _ in takewhile(lambda part: not glob.has_magic(part), parts))
    shows_hidden = any(part.startswith(".") for part in parts[named:])
    for path in root.glob("/".join(parts)):
        if shows_hidden or not any(part.startswith(".") for part in path.relative_to(root).parts[named:]):
            yield path


def _in_folder(folder: Path) -> list[Path]:
    try:
        pictures, note = pictures_in(folder, with_clips=True)
    except UserError:
        return []  # as the folder's own line will say
    if note is not None:
        print_message(note)
    return pictures


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # in a folder that must not be entered
        return False
