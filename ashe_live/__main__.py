"""`ashe-live` and `python -m ashe_live`."""

import os
import signal

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not so under nohup
    # Nothing is begun yet that would have to be finished, and an import that is interrupted raises anything.
    signal.signal(signal.SIGINT, lambda _number, _stack: os._exit(130))

from ashe_live.cli import main

if __name__ == "__main__":
    main()
