"""What a process of the command line needs around its command: open streams, quiet libraries, an orderly end.

Only what Python has loaded at its start anyway is imported here: until `main` has begun, Ctrl-C is Python's.
"""

import io
import os
import signal
import sys
import warnings
from typing import TextIO

# Read by libraries as they load, here and in child processes.
ENVIRONMENT = {
    # Our matrices are small: more threads only wait for each other, six times as long for an estimate, and what they
    # compute has the same bits.
    "OPENBLAS_NUM_THREADS": "1",
    # What goes wrong is said by UserError, once, and not by libraries as well.
    "OPENCV_LOG_LEVEL": "SILENT",
    "PYTHONWARNINGS": "ignore",
    # Also what libraries start must not run what lies in the current folder: glfw does at its import.
    "PYTHONSAFEPATH": "1",
}
INTERRUPTED = 130


def main() -> None:
    """Runs the command that the arguments name, and ends the process with its exit status."""
    has_ctrl_c = signal.getsignal(signal.SIGINT) is not signal.SIG_IGN  # as under nohup
    if has_ctrl_c:
        # Nothing is begun yet that would have to be finished, and an import that is interrupted raises anything.
        signal.signal(signal.SIGINT, lambda _number, _stack: os._exit(INTERRUPTED))
    _leave_current_folder_out()
    _open_streams()
    for name, value in ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")

    from ashe_live.cli import run

    try:
        status = run(sys.argv[1:], _interruptible if has_ctrl_c else None)
    except SystemExit as end:  # argparse, after --help and wrong use
        status = end.code if isinstance(end.code, int) else 0
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done: the interpreter takes itself apart
    sys.exit(_flushed(status))


def _interruptible() -> None:
    """From now on Ctrl-C unwinds the stack, so that what was begun is finished."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def _leave_current_folder_out() -> None:
    """Of where modules are looked for: `python -m` has it first, and whatever lies beside a clip is not our code."""
    here = {"", os.path.abspath(os.curdir)} if os.path.isdir(os.curdir) else {""}  # noqa: PTH100, PTH112
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))  # noqa: PTH100, PTH120
    if sys.path and sys.path[0] in here - {home}:
        del sys.path[0]


def _open_streams() -> None:
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


def _flushed(status: int) -> int:
    """`status`, or another where standard output has not taken all that was written to it."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:  # its reader (`| head`) has what it wanted
            _discard(stream)
        except OSError as error:
            _discard(stream)
            if stream is sys.stdout:
                from ashe_live.core.messages import tell
                from ashe_live.errors import ExitStatus

                tell(f"cannot write to standard output ({error.strerror}): choose a place that has space left")
                status = ExitStatus.WRONG_USE
    return status


def _discard(stream: TextIO) -> None:
    """What is left in its buffer: else the interpreter tries once more at its end, and complains."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
