"""`ashe-live` and `python -m ashe_live`. What comes first here comes before anything else is imported."""

import os
import sys

try:
    try:
        current_folder = os.getcwd()  # noqa: PTH109 - pathlib would have to be imported
    except OSError:  # it has been deleted
        current_folder = ""
    if sys.path[0] in ("", current_folder) and os.path.dirname(os.path.dirname(__file__)) != sys.path[0]:  # noqa: PTH120
        del sys.path[0]  # where `python -m` looks for modules first

    import signal

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not so under nohup
        # Nothing is begun yet that would have to be finished, and an import that is interrupted raises anything.
        signal.signal(signal.SIGINT, lambda _number, _stack: os._exit(130))
except BaseException:  # Ctrl-C in these milliseconds, in which Python's own answer is a traceback
    os._exit(130)

from ashe_live.cli import main

if __name__ == "__main__":
    main()
