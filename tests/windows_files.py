"""Files as Windows has them, on Linux: none that is open can be removed or replaced, and locks are of bytes."""

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ashe_live.files import new_file

OPEN_FILES = Path("/proc/self/fd")


def open_numbers(status: os.stat_result) -> Iterator[int]:
    """The numbers by which this process has a file open."""
    for number in [int(path.name) for path in OPEN_FILES.iterdir()]:
        with contextlib.suppress(OSError):  # that of the listing itself
            if os.path.samestat(os.fstat(number), status):
                yield number


class ByteLocks:
    """`msvcrt.locking`: of a byte from where the file stands, until the file that was opened is closed."""

    def __init__(self) -> None:
        self._locked: list[tuple[os.stat_result, int, int]] = []

    def locking(self, number: int, mode: int, byte_count: int) -> None:
        assert (mode, byte_count) == (2, 1)
        place, status = os.lseek(number, 0, os.SEEK_CUR), os.fstat(number)
        assert place + byte_count < 2**31
        for other, at, by in self._locked:
            if os.path.samestat(other, status) and at == place and by != number and by in open_numbers(other):
                raise OSError(errno.EACCES, "locked")
        self._locked.append((status, place, number))


def as_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until the test ends. Other programs' open files are not known."""
    if not OPEN_FILES.is_dir():
        pytest.skip("the system does not tell which files are open")
    monkeypatch.setattr(new_file, "fcntl", None)
    monkeypatch.setattr(new_file, "UNNAMED", 0)
    locks = ByteLocks()
    monkeypatch.setitem(sys.modules, "msvcrt", SimpleNamespace(locking=locks.locking, LK_NBLCK=2))
    for name in ("unlink", "remove", "rename", "replace"):
        monkeypatch.setattr(os, name, _refusing_open(getattr(os, name)))


def _refusing_open(change: Any) -> Any:
    def changed(*paths: Any, **how: Any) -> None:
        for path in paths:
            with contextlib.suppress(FileNotFoundError):
                if not how and any(open_numbers(os.lstat(path))):  # with a folder's number: tempfile's own way
                    raise PermissionError(errno.EACCES, "in use", path)
        change(*paths, **how)

    return changed
