"""Which files of a folder this process has open, whatever else it opens and closes meanwhile in other threads."""

import contextlib
import os
from pathlib import Path

import pytest

OPEN_FILES = Path("/proc/self/fd")
needs_list_of_open_files = pytest.mark.skipif(not OPEN_FILES.is_dir(), reason="the system does not tell what is open")


def open_within(folder: Path) -> list[str]:
    """The folder itself as well, and files without a name in it."""
    found = []
    for number in list(OPEN_FILES.iterdir()):
        with contextlib.suppress(OSError):  # that of the listing itself, or one that was closed meanwhile
            found.append(os.readlink(number))  # noqa: PTH115 - Path.readlink would drop what the system adds
    return [each for each in found if each == str(folder) or each.startswith(f"{folder}{os.sep}")]
