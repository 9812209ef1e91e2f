"""The end of this process, also while threads are left behind that nobody can wait for."""

import atexit
import os
import sys
import threading
from typing import NoReturn


def end_process(status: int) -> NoReturn:
    """Ends the process with an exit status. What it printed has to be flushed before."""
    if any(thread.daemon for thread in threading.enumerate()):
        # Such a thread may be inside a library written in C++. Where it next wants Python's lock, the interpreter that
        # takes itself apart (before Python 3.14) ends the thread, which C++ does not allow: it aborts the process.
        atexit._run_exitfuncs()  # as the interpreter does first: child processes are ended there
        os._exit(status)
    sys.exit(status)
