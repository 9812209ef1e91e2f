"""A new file, written in the folder of its final path, and put there complete and in one step, or not at all.

Until then it has no name if the system supports that (O_TMPFILE), so that nothing is left whatever happens. Otherwise
it has a hidden, random name, is created exclusively, and is locked while it is written.
"""

import contextlib
import os
import secrets
import stat
from importlib import import_module
from itertools import count
from pathlib import Path
from typing import Any, BinaryIO, Self

from ashe_live.errors import UserError

try:
    import fcntl
except ImportError:  # on Windows, where an open file can be neither renamed nor removed
    fcntl = None  # type: ignore[assignment]

TOKEN_BYTES = 4
# Characters of the stem that a hidden name keeps: with its token it stays within the 255 bytes that most systems allow.
KEPT_STEM = 40
# These flags are missing on some systems, where what they forbid is checked by name.
NO_LINK = getattr(os, "O_NOFOLLOW", 0)
UNNAMED = getattr(os, "O_TMPFILE", 0)
NUMBERED_FILES = Path("/proc/self/fd")
LOCKED_BYTE = 2**31 - 2  # on Windows, where nobody else can read what is locked: the last of which `msvcrt` knows


class NewFile:
    """Write to `stream`, then `publish` or `discard`. As a context manager it discards what is not published."""

    def __init__(self, path: Path, overwrite: bool = False, is_recoverable: bool = False, beside: bool = False) -> None:
        """Leaves `path` untouched for now. A file that `is_recoverable` has a hidden name in any case.

        `beside`: it will be published beside what is there. Raises UserError as `check_output`.
        """
        if not (beside and os.path.lexists(path)):
            _check_name(path, overwrite)
        self.path = path  # the final path; after `publish` the one that it really has
        self.overwrite = overwrite
        try:
            self.partial, number = _created(path, is_recoverable)
        except OSError as error:
            raise cannot_write(path, error) from error
        self.stream: BinaryIO = open(number, "w+b")  # noqa: SIM115, PTH123
        lock(self.stream)

    def publish(self, beside: bool = False) -> Path:
        """Puts the file at its final path, and returns that. May raise OSError; the file can still be discarded then.

        A file that has appeared there meanwhile is replaced only with `overwrite`. Otherwise this one is put `beside`
        it, under the next free name, or UserError is raised.
        """
        self.follow_folder()
        self.stream.flush()
        if fcntl is None:
            self.stream.close()
        wanted, numbers = self.path, count(2)
        while not self._put(self.path, self.overwrite and self.path == wanted, beside):
            if not beside:
                raise _is_there(wanted)
            self.path = wanted.with_stem(f"{wanted.stem}-{next(numbers)}")
        self.partial = None
        self.stream.close()
        return self.path

    def publish_or_keep(self) -> Path:
        """As `publish`, beside what is there. Where nothing can be added to the folder, the hidden name stays.

        For a file that is worth keeping. Raises OSError when it has no name.
        """
        try:
            return self.publish(beside=True)
        except OSError:
            if self.partial is None or not self.partial.exists():
                raise
            kept, self.partial = self.partial, None
            return kept

    def discard(self) -> None:
        """Removes all traces of an unpublished file that can be removed; may be called twice, and after `publish`."""
        self.follow_folder()
        with contextlib.suppress(OSError):
            self.stream.close()
        if self.partial is not None:
            with contextlib.suppress(OSError):
                self.partial.unlink()

    def follow_folder(self) -> None:
        """Puts right `path` and the hidden name if the folder was renamed meanwhile, where the system tells."""
        with contextlib.suppress(OSError, ValueError):  # of a file that is closed
            if not (self.partial or self.path.parent).exists():
                folder = (NUMBERED_FILES / str(self.stream.fileno())).readlink().parent
                self.path = folder / self.path.name
                self.partial = None if self.partial is None else folder / self.partial.name

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.discard()

    def _put(self, path: Path, overwrite: bool, beside: bool) -> bool:
        """Returns False if something is at `path` that must stay."""
        if overwrite:
            try:
                _check_name(path, overwrite=True)
            except UserError:  # a link, or a folder
                if beside:
                    return False
                raise
            if self.partial is None:
                hidden = partial_path(path)
                self._link(hidden)
                self.partial = hidden
            self.partial.replace(path)
            return True
        try:
            self._link(path)
        except FileExistsError:
            return False
        except OSError:
            return self._moved_onto_reservation(path)
        if self.partial is not None:
            self.partial.unlink()
        return True

    def _link(self, path: Path) -> None:
        """Gives the file another name, which must be free."""
        if self.partial is not None:
            os.link(self.partial, path)
            return
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            # With a folder's number the system call is linkat, which follows /proc's link to the unnamed file.
            os.link(NUMBERED_FILES / str(self.stream.fileno()), path, src_dir_fd=folder, follow_symlinks=True)
        finally:
            os.close(folder)

    def _moved_onto_reservation(self, path: Path) -> bool:
        """For file systems without hard links (FAT): reserves the name exclusively first, then replaces it."""
        if self.partial is None:
            raise OSError("the file has no name and cannot be given one")
        try:
            os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
        except FileExistsError:
            return False
        try:
            self.partial.replace(path)
        except BaseException:
            path.unlink()  # ours, and empty
            raise
        return True


def check_output(path: Path, overwrite: bool) -> None:
    """Raises UserError when `path` cannot or must not be written, by creating a file in its folder for a moment."""
    _check_name(path, overwrite)
    try:
        partial, number = _created(path, is_recoverable=False)
        os.close(number)
        if partial is not None:
            partial.unlink()
    except OSError as error:
        raise cannot_write(path, error) from error


def cannot_write(path: Path, error: Exception) -> UserError:
    """The error to raise when writing `path` has failed."""
    reason = getattr(error, "strerror", None) or str(error)
    return UserError(f"cannot write {path} ({reason})", "choose a folder that you may write to and that has space left")


def partial_path(path: Path) -> Path:
    """A hidden name in the same folder, from which the finished file can be moved to its path in one step."""
    return path.with_name(f".{path.stem[:KEPT_STEM]}.{secrets.token_hex(TOKEN_BYTES)}.partial{path.suffix[:KEPT_STEM]}")


def lock(stream: BinaryIO) -> bool:
    """Locks a file while it is open; False if another process holds the lock, or if its file system has no locks."""
    try:
        lock_number(stream.fileno())
    except OSError:
        return False
    return True


def lock_number(number: int) -> None:
    """As `lock`, of a file or folder by its descriptor. Raises BlockingIOError if another process holds the lock."""
    if fcntl is None:
        _lock_on_windows(number)
    else:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _lock_on_windows(number: int) -> None:
    """Locks a byte, which need not be there, from where the file stands. Raises OSError where it is locked."""
    msvcrt: Any = import_module("msvcrt")
    place = os.lseek(number, 0, os.SEEK_CUR)
    os.lseek(number, LOCKED_BYTE, os.SEEK_SET)
    try:
        msvcrt.locking(number, msvcrt.LK_NBLCK, 1)
    finally:
        os.lseek(number, place, os.SEEK_SET)


def _created(path: Path, is_recoverable: bool) -> tuple[Path | None, int]:
    """Creates the file: its hidden name, if it has one, and its file descriptor. Raises OSError."""
    if UNNAMED and not is_recoverable and NUMBERED_FILES.is_dir():
        with contextlib.suppress(OSError):  # the file system may not support it, or the folder may be read-only
            return None, os.open(path.parent, UNNAMED | os.O_RDWR, 0o666)
    partial = partial_path(path)
    binary = getattr(os, "O_BINARY", 0)
    return partial, os.open(partial, os.O_CREAT | os.O_EXCL | os.O_RDWR | NO_LINK | binary, 0o666)


def _check_name(path: Path, overwrite: bool) -> None:
    try:
        mode = path.lstat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        if not path.parent.is_dir():
            raise UserError(f"there is no folder {path.parent}", "create it or choose another") from None
        return
    except (OSError, ValueError) as error:  # a folder that must not be entered, a name that is too long, or none at all
        raise cannot_write(path, error) from error
    if stat.S_ISDIR(mode):
        raise UserError(f"{path} is a folder", "name a file in it")
    if not stat.S_ISREG(mode):
        kind = "a link" if stat.S_ISLNK(mode) else "a device or a pipe"
        raise UserError(f"{path} is {kind} and not a file", "choose another name")
    if not overwrite:
        raise _is_there(path)


def _is_there(path: Path) -> UserError:
    return UserError(f"{path} exists already", "choose another name, or replace it by --overwrite (overwrite=True)")
