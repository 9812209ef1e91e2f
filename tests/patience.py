"""How long tests wait for what must come, and how."""

import time
from collections.abc import Callable

# Software rendering on a machine that others crowd sixfold; nothing waits this long when all is well.
PATIENCE_S = 240.0
POLL_S = 0.01


def await_that(condition: Callable[[], object], what: str = "it") -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"waited in vain for {what}"
        time.sleep(POLL_S)
