"""Recordings that a killed program or a power cut left under their hidden names: given names that can be seen."""

import contextlib
import os
import re
import stat
from pathlib import Path

import av

from ashe_live.capture.recording.fragments import copy_whole_fragments, is_in_the_making, picture_count, published
from ashe_live.errors import UserError
from ashe_live.files.new_file import NO_LINK, NewFile, lock
from ashe_live.files.writing import unused

# As new_file.partial_path makes them.
HIDDEN_NAME = re.compile(r"\.(?P<stem>.*)\.[0-9a-f]{8}\.partial\.mp4", re.IGNORECASE | re.DOTALL)


def rescue_recordings(folder: Path) -> list[Path]:
    """Makes NAME-cut-short.mp4 of every one in `folder`, and removes what it was made of.

    Only regular files of this user that begin as our recordings do and that no running program has locked are taken
    for such; all others, and all that cannot be read or written, stay as they are.
    """
    rescued = []
    for partial in _hidden_in(folder):
        with contextlib.suppress(OSError, UserError, av.error.FFmpegError):
            path = _rescued(partial)
            if path is not None:
                rescued.append(path)
    return rescued


def _hidden_in(folder: Path) -> list[Path]:
    try:
        return sorted(path for path in folder.iterdir() if HIDDEN_NAME.fullmatch(path.name))
    except OSError:
        return []


def _rescued(partial: Path) -> Path | None:
    """None when it is not ours or still written to, or when there is nothing to play in it: then it goes as well."""
    # Not waiting, should it be a pipe.
    number = os.open(partial, os.O_RDWR | NO_LINK | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(number, "r+b") as stream:  # noqa: PTH123
        status = os.fstat(number)
        is_own = not hasattr(os, "geteuid") or status.st_uid == os.geteuid()
        if not (stat.S_ISREG(status.st_mode) and is_own and lock(stream) and is_in_the_making(stream)):
            return None
        with NewFile(_name_for(partial)) as fragments:
            copy_whole_fragments(stream, fragments.stream)
            pictures = picture_count(fragments.stream)
            rescued = published(fragments, pictures) if pictures else None
        # Another file that has been put in its place meanwhile stays.
        if os.path.samestat(status, partial.lstat()):
            try:
                partial.unlink()
            except PermissionError:  # Windows removes no file that is open; elsewhere nobody else takes it until then
                stream.close()
                partial.unlink()
        return rescued


def _name_for(partial: Path) -> Path:
    match = HIDDEN_NAME.fullmatch(partial.name)
    assert match is not None
    return unused(partial.with_name(f"{match['stem']}-cut-short.mp4"))
