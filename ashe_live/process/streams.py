"""Standard streams in any state: closed, full, a pipe that nobody reads any more, an encoding of few letters."""

import io
import os
import sys
from typing import TextIO

from ashe_live.errors import ExitStatus
from ashe_live.process.messages import tell


def open_streams() -> None:
    """No file of ours may get the number of a standard stream that is closed: C libraries would write into it."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free
            setattr(sys, name, open(number, "r" if number == 0 else "w", encoding="utf-8", closefd=False))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # ASCII is no reason to end


def flushed(status: int) -> int:
    """`status`, or another where standard output has not taken all that was written to it."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:  # its reader (`| head`) has what it wanted
            _discard(stream)
        except OSError as error:
            _discard(stream)
            if stream is sys.stdout and status != ExitStatus.WRONG_USE:
                tell(f"cannot write to standard output ({error.strerror}): choose a place that has space left")
                status = ExitStatus.WRONG_USE
    return status


def _discard(stream: TextIO) -> None:
    """What is left in its buffer: else the interpreter tries once more at its end, and complains."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
