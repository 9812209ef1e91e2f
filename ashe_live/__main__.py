"""`ashe-live` and `python -m ashe_live`. What comes first here comes before anything else is imported."""

import os
import sys

try:
    try:
        current_folder = os.getcwd()  # noqa: PTH109 - pathlib would have to be imported
    except OSError:  # it has been deleted
        current_folder = ""
    # `python -m`, and an empty entry of PYTHONPATH, look for modules there first; Python itself or this package may be.
    ours = {os.path.dirname(os.path.dirname(__file__)), os.path.dirname(os.__file__)}  # noqa: PTH120
    sys.path[:] = [entry for entry in sys.path if entry not in ("", current_folder) or entry in ours]

    import signal

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not so under nohup
        # Nothing is begun yet that would have to be finished, and an import that is interrupted raises anything.
        signal.signal(signal.SIGINT, lambda _number, _stack: os._exit(130))
except BaseException:  # Ctrl-C in these milliseconds, in which Python's own answer is a traceback
    os._exit(130)

from ashe_live.cli import main

if __name__ == "__main__":
    main()
