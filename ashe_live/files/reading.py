"""What may be opened: only regular files. A pipe could block for ever, and a device may have no end."""

import json
import math
import os
import re
import stat
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote

from ashe_live.errors import UserError

ADDRESS = re.compile(r"(?P<scheme>https?|s?ftps?|rtsp|rtmp)://?(?P<rest>.+)", re.IGNORECASE | re.DOTALL)
FILE_ADDRESS = re.compile(r"file:/+(?:localhost/)?(?P<path>.+)", re.IGNORECASE | re.DOTALL)
MOST_SETTINGS_BYTES = 1_000_000  # of files that people write: settings, camera files


def opened(path: Path, may_be_empty: bool = False) -> BinaryIO:
    """Opens the file at `path`, or the one that a link there leads to; the caller must close it.

    Raises UserError when it is missing, not a regular file, not readable, or empty although it must not be.
    """
    try:
        # Checked before, as opening a device may have effects, and again once open, as the file may have been replaced.
        _check_kind(path, path.stat().st_mode)
        number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        stream = open(number, "rb")  # noqa: SIM115, PTH123
        try:
            status = os.fstat(number)
            _check_kind(path, status.st_mode)
            # Also what the system makes up as it is read (/proc), which has no size and may have no end, or block.
            if not may_be_empty and not (status.st_size and stream.peek(1)):
                raise _empty(path)
        except BaseException:
            stream.close()
            raise
        return stream
    except (FileNotFoundError, NotADirectoryError):
        raise _missing(path) from None
    except OSError as error:
        raise UserError(f"cannot read {path} ({error.strerror})", "check its name and permissions") from None
    except ValueError as error:  # the name has a NUL in it
        raise UserError(f"{str(path)!r} is no file's name ({error})", "check the name") from None


def as_given(path: Path) -> str:
    """The name of a file, or the address in its place: `Path` reduces the two slashes of that to one."""
    address = ADDRESS.match(str(path))
    return str(path) if address is None else f"{address['scheme']}://{address['rest']}"


def _empty(path: Path) -> UserError:
    return UserError(f"{path} is empty", "copy, record or export it again")


def _missing(path: Path) -> UserError:
    if ADDRESS.match(str(path)) is not None:
        said = f"{as_given(path)} is an address, and nothing is fetched from a network"
        return UserError(said, "save what it leads to, and give that file")
    if (address := FILE_ADDRESS.match(str(path))) is not None:
        named = unquote(address["path"], errors="surrogateescape")
        root = "" if named[1:2] == ":" else "/"  # on Windows it has a drive
        return UserError(f"{path} is the address of a file", f"give its path, {root}{named}")
    if str(path) == "-":
        return UserError("nothing is read from standard input", "name a file")
    return UserError(f"there is no file {path}", "check the name and the folder")


def read_bytes(path: Path, most_bytes: int = MOST_SETTINGS_BYTES, may_be_empty: bool = True) -> bytes:
    """The whole content. Raises UserError as `opened`, and for more than `most_bytes`."""
    with opened(path, may_be_empty) as stream:
        try:
            # Memory is reserved for the file's size, and not for all that is allowed.
            size = os.fstat(stream.fileno()).st_size
            content = stream.read(min(size, most_bytes) + 1) if size else b""
        except OSError as error:
            raise UserError(f"cannot read {path} ({error.strerror})", "copy it again") from error
    if len(content) > most_bytes:
        raise UserError(f"{path} is too large", f"give a file of {most_bytes:,} bytes or fewer")
    return content


def read_text(path: Path, most_bytes: int = MOST_SETTINGS_BYTES) -> str:
    """As `read_bytes`, decoded from UTF-8, with or without a byte order mark."""
    try:
        return read_bytes(path, most_bytes).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError(
            f"{path} is not UTF-8 text ({error.reason} at byte {error.start})", "name a text file, saved as UTF-8"
        ) from None


def read_json(path: Path, most_bytes: int = MOST_SETTINGS_BYTES, remedy: str = "write or export it again") -> Any:
    """As `read_text`, parsed. Raises UserError for what is not JSON, which has no NaN and no infinite numbers.

    `remedy`: what helps where it is not JSON.
    """
    text = read_text(path, most_bytes)
    if not text.strip():
        raise _empty(path)
    try:
        return json.loads(text, parse_constant=_refused, parse_float=_finite, parse_int=_whole)
    except (ValueError, RecursionError) as error:
        raise UserError(f"{path} is not JSON ({parsers_words(error)})", remedy) from None


def parsers_words(error: Exception) -> str:
    """A parser's own message; for one that has recursed too deeply, words about the text instead of Python's."""
    return "nested too deeply" if isinstance(error, RecursionError) else str(error)


def _refused(constant: str) -> None:
    raise ValueError(f"{constant} is no number")


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text[:16]} is too large a number")
    return value


def _whole(text: str) -> int:
    _finite(text)  # so that what reads it may compute with it
    return int(text)


def _check_kind(path: Path, mode: int) -> None:
    if stat.S_ISDIR(mode):
        raise UserError(f"{path} is a folder", "name a file in it")
    if not stat.S_ISREG(mode):
        raise UserError(f"{path} is a device or a pipe and not a file", "name a file")
