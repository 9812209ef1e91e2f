"""The process of the command line: what it needs around a command, the command, and an orderly end."""

import argparse
import io
import os
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

from ashe_live.commands.flags.options import parsed, with_origin
from ashe_live.errors import ExitStatus, UserError
from ashe_live.process.ending import end_process
from ashe_live.process.messages import print_message
from ashe_live.process.module_path import safe_module_path, safe_search_paths
from ashe_live.process.unexpected_errors import outer_cause

# Read by libraries as they load, here and in child processes.
ENVIRONMENT = {
    # Our matrices are small: more threads only wait for each other, six times as long for an estimate, and what they
    # compute has the same bits.
    "OPENBLAS_NUM_THREADS": "1",
    # What goes wrong is said by UserError, once, and not by libraries as well.
    "OPENCV_LOG_LEVEL": "SILENT",
    # Also what libraries start must not run what lies in the current folder: glfw does at its import.
    "PYTHONSAFEPATH": "1",
}


def main() -> None:
    """Runs the command that the arguments name, and ends the process with its exit status."""
    sys.path[:] = safe_module_path()  # `python -m` has the current folder first
    _open_streams()
    for name, value in ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    if not _keeps_shaders():
        os.environ["MESA_SHADER_CACHE_DISABLE"] = "true"  # it says so on standard error, as if something were wrong
    os.environ.update(safe_search_paths())  # before OpenCV appends to it
    # As of OpenCV above. What is set for all of a person's Python programs is not meant for this one: pyrr cannot be
    # compiled where its warnings are errors.
    os.environ["PYTHONWARNINGS"] = "ignore"
    sys.warnoptions[:] = _warnings_of_flags()  # children would get others as flags
    warnings.simplefilter("ignore")
    try:
        status = run(sys.argv[1:], _interruptible)
    except SystemExit as end:  # argparse, after --help and wrong use
        status = end.code if isinstance(end.code, int) else ExitStatus.ANSWERED
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done: the interpreter takes itself apart
    end_process(status)


def _open_streams() -> None:
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


def _keeps_shaders() -> bool:
    """Whether Mesa's OpenGL has a folder for what it compiles: in the home that the system knows, whatever HOME is."""
    named = os.environ.get("MESA_SHADER_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    try:
        import pwd

        folder = Path(named) if named else Path(pwd.getpwuid(os.getuid()).pw_dir) / ".cache"
    except (ImportError, KeyError):  # Windows; a user whom the system does not know, for whom nothing is kept
        return True
    place = folder if os.access(folder, os.F_OK) else folder.parent
    return os.access(place, os.W_OK | os.X_OK) and place.is_dir()


def _warnings_of_flags() -> list[str]:
    """Those that stand for other flags of Python's (-X dev, -b): starting a child fails where one is missing."""
    of_flags = ["default"] if sys.flags.dev_mode else []
    if sys.flags.bytes_warning:
        of_flags.append(f"{'error' if sys.flags.bytes_warning > 1 else 'default'}::BytesWarning")
    return of_flags


def _interruptible() -> None:
    """From now on Ctrl-C unwinds the stack, so that what was begun is finished."""
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:  # as under nohup
        signal.signal(signal.SIGINT, signal.default_int_handler)


def run(arguments: Sequence[str], begins: Callable[[], None] | None = None) -> int:
    """Parses, runs the command, and returns its exit status; what a user can mend becomes one line on stderr.

    `begins` is called when all is loaded and the command itself is next.
    """
    options: argparse.Namespace | None = None
    try:
        options = parsed(arguments)
        command: Callable[[argparse.Namespace], int] = import_module(f"ashe_live.commands.{options.command}").run
        if begins is not None:
            begins()
        return int(command(options))
    except UserError as error:
        print_message(with_origin(error, options))
    except KeyboardInterrupt:
        return ExitStatus.INTERRUPTED
    except BrokenPipeError:  # the reader (`| head`) has what it wanted
        return ExitStatus.ANSWERED
    except Exception as error:
        if (cause := outer_cause(error)) is None:
            raise
        print_message(cause)
    return ExitStatus.WRONG_USE
