"""Exceptions that no command foresees: words for those that the user can mend, and a report for the others."""

import os
import sys
import traceback
from pathlib import Path

from ashe_live.process.messages import printable


def outer_cause(error: Exception) -> str | None:
    """What to say if a file, a name or the machine caused the error; None if the program itself is at fault."""
    match error:
        case ImportError():
            return f"a part of the program cannot be loaded ({error}): ashe-live doctor says what is missing"
        case MemoryError():
            return "there is not enough memory for this: close other programs, or give something smaller"
        case RecursionError():
            return "something is nested too deeply in one of the files: export or write it again"
        case UnicodeError():
            return f"a name or a text cannot be encoded ({error}): rename or convert it"
        case OSError():
            return _refusal(error)
    return None


def fault(error: Exception) -> str:
    """The exception in a few words, with the place at which it was raised."""
    first_line = (str(error).strip() or "no message").splitlines()[0]
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {first_line}{where}"


def show_traceback(error: Exception) -> None:
    """Prints the traceback on standard error for a bug report, made printable, as it may quote what files contain."""
    for lines in traceback.format_exception(error):
        for line in lines.splitlines():
            indent = line[: len(line) - len(line.lstrip())]
            print(indent + printable(line), file=sys.stderr, flush=True)


def _refusal(error: OSError) -> str:
    try:
        os.getcwd()  # noqa: PTH109
    except OSError:
        return "the current folder has been deleted: change to one that is there"
    named = f" ({error.filename})" if error.filename is not None else ""
    return f"the system refuses: {error.strerror or error}{named}: check the files, folders and space that it needs"
