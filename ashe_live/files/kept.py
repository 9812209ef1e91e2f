"""What is kept between runs, in the user's configuration folder."""

import contextlib
import os
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import platformdirs

from ashe_live.errors import UserError
from ashe_live.files.new_file import lock_number
from ashe_live.files.reading import read_json
from ashe_live.files.writing import write_json

# How long one window waits for another, which needs a few milliseconds; the person's picture stands meanwhile.
LONGEST_WAIT_S, LOOK_EVERY_S = 2.0, 0.005
FOLDER = getattr(os, "O_DIRECTORY", 0)  # Windows opens none anyway
# Where nothing is found and nothing can be written.
NOWHERE = Path("/dev/null/ashe-live")


def configuration_file(name: str) -> Path:
    """The path at which a file of that name is kept, whether it exists or not; in NOWHERE for a user without a home.

    Services and containers run as such users, with no HOME. A relative folder, as of `HOME=.`, would be anybody's.
    """
    try:
        folder = platformdirs.user_config_path("ashe-live", appauthor=False)
    except RuntimeError:  # of some versions of platformdirs; others name a folder called "~"
        folder = NOWHERE
    return (folder if folder.is_absolute() else NOWHERE) / name


class KeptObject:
    """A JSON object in a file. A file that cannot be read or written counts as missing."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> dict[str, Any]:
        try:
            content = read_json(self._path)
        except UserError:
            return {}
        return content if isinstance(content, dict) else {}

    @contextlib.contextmanager
    def alone(self) -> Iterator[None]:
        """Within this, what is read may be written with a change: others of `alone` wait, so that no change is lost.

        Where the system cannot lock a folder, or another program holds the lock for too long, all goes on without.
        """
        with contextlib.ExitStack() as held:
            with contextlib.suppress(OSError):
                number = os.open(self._path.parent, os.O_RDONLY | FOLDER)  # a pipe in its place would be waited for
                held.callback(os.close, number)
                until_s = time.monotonic() + LONGEST_WAIT_S
                while _is_locked(number) and time.monotonic() < until_s:
                    _wait()
            yield

    def write(self, content: Mapping[str, Any]) -> None:
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_json(self._path, content, overwrite=True)
        except (OSError, UserError):
            return


def _is_locked(number: int) -> bool:
    """By another; else it is locked now, or OSError is raised, as where nothing can be."""
    try:
        lock_number(number)
    except BlockingIOError:
        return True
    return False


def _wait() -> None:
    time.sleep(LOOK_EVERY_S)
