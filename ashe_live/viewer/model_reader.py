"""Reads a model for the viewer: small files in the thread that asks, large ones in a process of their own.

Parsing text holds the interpreter's lock for longer than a picture lasts; and whatever a file does to its parser, the
viewer goes on.
"""

import multiprocessing
import os
import signal
import sys
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path

from ashe_live.core.pipes import receive_value, send_value
from ashe_live.errors import UserError
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import PlacedModel, placed_on_marker

# Read in a few milliseconds at a time.
SMALL_FILE_BYTES = 2_000_000
NICENESS = 10
# Of address space. What the limits let pass takes less than half; text that is made to be many words takes more.
MAX_MEMORY_BYTES = 6 << 30


def read_model(name: str, marker_side_m: float) -> PlacedModel:
    """A shipped model by its name, or any model file by its path. Raises UserError when it cannot be shown."""
    with suppress(OSError):
        if Path(name).stat().st_size > SMALL_FILE_BYTES:
            return _read_apart(name, marker_side_m)
    return placed_on_marker(load_model(name), marker_side_m)


def _read_apart(name: str, marker_side_m: float) -> PlacedModel:
    context = multiprocessing.get_context("spawn")  # a fork would inherit the window's OpenGL and half-held locks
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(sender, name, marker_side_m), name="ashe-live model", daemon=True)
    process.start()
    # Else our own copy would keep the pipe open after the process has died.
    sender.close()
    try:
        outcome = receive_value(receiver)
    except EOFError:
        outcome = UserError(f"the model file {name} is too much for its reader", "reduce it, or export it again")
    finally:
        receiver.close()
        process.join()
    if isinstance(outcome, PlacedModel):
        return outcome
    raise outcome


def _answer(connection: Connection, name: str, marker_side_m: float) -> None:
    """Sends the model, or the UserError that says why there is none."""
    # Ctrl-C in the terminal reaches every process; the viewer's main one decides what comes of it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    _limit_memory()
    outcome: PlacedModel | UserError
    try:
        outcome = placed_on_marker(load_model(name), marker_side_m)
    except UserError as error:
        outcome = error
    # The viewer may be gone, and nobody wants the answer.
    with suppress(OSError):
        send_value(connection, outcome)


def _limit_memory() -> None:
    """Of this process, where the system can; a file that takes more is malformed like any other."""
    if sys.platform == "win32":
        return
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_AS)
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY_BYTES, most))
