"""A file in the making: written beside where it will stand, and put there whole, in one step, or not at all.

Until then it has no name where the system can do that (O_TMPFILE), so that nothing of it is left whatever happens; or
a hidden name of its own that nobody could foresee, created exclusively and locked as long as somebody writes to it.
"""

import contextlib
import os
import secrets
import stat
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from ashe_live.errors import UserError

try:
    import fcntl
except ImportError:  # Windows, where a file that is open can be neither renamed nor removed
    fcntl = None  # type: ignore[assignment]

TOKEN_BYTES = 4
# Of a name in characters, so that with its token no name is longer than the 255 bytes that most systems allow.
KEPT_STEM = 40
# Not on every system: where they are missing, what they forbid is checked by name.
NO_LINK = getattr(os, "O_NOFOLLOW", 0)
UNNAMED = getattr(os, "O_TMPFILE", 0)
NUMBERED_FILES = Path("/proc/self/fd")


class NewFile:
    """`stream` is written to; then `publish` or `discard`. A context manager, which discards what is not published."""

    def __init__(self, path: Path, overwrite: bool = False, is_recoverable: bool = False) -> None:
        """Takes nothing away from `path` yet. One that `is_recoverable` has a hidden name all the while.

        Raises UserError as `check_output`.
        """
        _check_name(path, overwrite)
        self.path = path  # where it will stand, and after `publish` where it does
        self._overwrite = overwrite
        try:
            self.partial, number = _created(path, is_recoverable)
        except OSError as error:
            raise cannot_write(path, error) from error
        self.stream: BinaryIO = open(number, "w+b")  # noqa: SIM115, PTH123
        lock(self.stream)

    def publish(self, beside: bool = False) -> Path:
        """Puts it in its place, which is returned; may raise OSError, and is then still there to be discarded.

        What has appeared there meanwhile is replaced only where `overwrite` says so. Else it is `beside` that, under
        the next name that is free, or UserError.
        """
        self.stream.flush()
        if fcntl is None:
            self.stream.close()
        wanted, numbers = self.path, count(2)
        while not self._put(self.path):
            if not beside:
                raise _is_there(wanted)
            self.path = wanted.with_stem(f"{wanted.stem}-{next(numbers)}")
        self.partial = None
        self.stream.close()
        return self.path

    def discard(self) -> None:
        """Leaves nothing; may be called twice, and after `publish`."""
        with contextlib.suppress(OSError):
            self.stream.close()
        if self.partial is not None:
            self.partial.unlink(missing_ok=True)
            self.partial = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.discard()

    def _put(self, path: Path) -> bool:
        """False when something is there that must stay."""
        if self._overwrite:
            _check_name(path, overwrite=True)
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
        """Gives it another name, which must be free."""
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
        """For file systems without hard links (FAT): the name is taken first, exclusively, then replaced."""
        if self.partial is None:
            raise OSError("the file has no name and cannot be given one")
        try:
            os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
        except FileExistsError:
            return False
        self.partial.replace(path)
        return True


def check_output(path: Path, overwrite: bool) -> None:
    """Raises UserError when `path` cannot or must not be written. For a moment a new file is in its folder."""
    _check_name(path, overwrite)
    try:
        partial, number = _created(path, is_recoverable=False)
        os.close(number)
        if partial is not None:
            partial.unlink()
    except OSError as error:
        raise cannot_write(path, error) from error


def cannot_write(path: Path, error: Exception) -> UserError:
    """What to raise when writing `path` failed."""
    reason = getattr(error, "strerror", None) or str(error)
    return UserError(f"cannot write {path} ({reason})", "choose a folder that you may write to and that has space left")


def partial_path(path: Path) -> Path:
    """Hidden and in the same folder, so that the finished file can be put in its place in one step."""
    return path.with_name(f".{path.stem[:KEPT_STEM]}.{secrets.token_hex(TOKEN_BYTES)}.partial{path.suffix[:KEPT_STEM]}")


def lock(stream: BinaryIO) -> bool:
    """Locks an open file as long as it is open; False when somebody else has, or where the system cannot tell."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _created(path: Path, is_recoverable: bool) -> tuple[Path | None, int]:
    """Its hidden name, if it has one, and its number among the open files. Raises OSError."""
    if UNNAMED and not is_recoverable and NUMBERED_FILES.is_dir():
        with contextlib.suppress(OSError):  # a file system that cannot, or a folder that must not be written to
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
    return UserError(
        f"{path} exists already", "choose another name, or say that it is to be replaced (--overwrite, overwrite=True)"
    )
