"""A folder for files that are needed for a moment only."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ashe_live.errors import UserError
from ashe_live.process.signals import ended_by_signals, signals_held


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """A new folder, removed at the end, also when a request to end comes meanwhile; for the main thread.

    Raises UserError where none can be made.
    """
    with ended_by_signals():  # SIGTERM and SIGHUP would end the process at once
        try:
            folder = tempfile.TemporaryDirectory(prefix="ashe-live-")
        except OSError as error:
            remedy = "free some space, or set TMPDIR to a folder that you may write to"
            raise UserError(f"no temporary file can be written ({error.strerror})", remedy) from error
        try:
            yield Path(folder.name)
        finally:
            with signals_held():
                folder.cleanup()
