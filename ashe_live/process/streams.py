"""Standard streams in any state: closed, full, a pipe without a reader, an encoding with few letters."""

import io
import os
import sys
from typing import TextIO

from ashe_live.errors import ExitStatus
from ashe_live.process.messages import print_message


def open_streams() -> None:
    """Opens closed standard streams: else a file could get their numbers, and C libraries would write into it."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
            setattr(sys, name, open(number, "r" if number == 0 else "w", encoding="utf-8", closefd=False))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # an encoding as poor as ASCII must not end the program


def flushed(status: int) -> int:
    """`status`, or another one if standard output did not take all that was written to it."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:  # its reader (`| head`) has read what it wanted
            _discard(stream)
        except OSError as error:
            _discard(stream)
            if stream is sys.stdout and status != ExitStatus.WRONG_USE:
                print_message(f"cannot write to standard output ({error.strerror}): choose a place that has space left")
                status = ExitStatus.WRONG_USE
    return status


def _discard(stream: TextIO) -> None:
    """Discards what is left in the buffer, which the interpreter would otherwise try to write at its end, and fail."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
