"""The end of this process: what it printed is out, and no thread that is left behind is waited for."""

import atexit
import os
import sys
import threading
from typing import NoReturn, TextIO

from ashe_live.errors import ExitStatus
from ashe_live.process.messages import print_message


def end_process(status: int) -> NoReturn:
    """Ends the process with this status, or another one if standard output did not take all that was written to it."""
    status = _flushed(status)
    if threading.active_count() > 1:
        # A daemon thread may be inside a library written in C++. Where it next wants Python's lock, the interpreter
        # that takes itself apart (before Python 3.14) ends the thread, which C++ does not allow: it aborts the process.
        # For any other thread the interpreter waits, as for one that makes the cover of a marker for ten seconds.
        atexit._run_exitfuncs()  # as the interpreter does first: child processes are ended there
        os._exit(status)
    sys.exit(status)


def _flushed(status: int) -> int:
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
