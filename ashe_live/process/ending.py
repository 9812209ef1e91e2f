"""The end of this process, which waits for no thread that is left behind."""

import atexit
import os
import sys
import threading
from typing import NoReturn


def end_process(status: int) -> NoReturn:
    """Ends the process with an exit status. What it printed has to be flushed before."""
    if threading.active_count() > 1:
        # A daemon thread may be inside a library written in C++. Where it next wants Python's lock, the interpreter
        # that takes itself apart (before Python 3.14) ends the thread, which C++ does not allow: it aborts the process.
        # For any other thread the interpreter waits, as for one that makes the cover of a marker for ten seconds.
        atexit._run_exitfuncs()  # as the interpreter does first: child processes are ended there
        os._exit(status)
    sys.exit(status)
