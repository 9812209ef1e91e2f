"""Where modules and libraries are looked for: not in the current folder, where anything may lie beside a clip."""

import os
import sys
import sysconfig
from pathlib import Path


def safe_module_path() -> list[str]:
    """Python's module path without the current folder, unless it is where this package or Python itself lies."""
    ours = {Path(__file__).parents[2], *map(Path, sysconfig.get_paths().values())}
    return [entry for entry in sys.path if entry and (Path(entry) in ours or not _is_current_folder(entry))]


def safe_library_path() -> str:
    """The dynamic linker's LD_LIBRARY_PATH for child processes, without the current folder.

    An empty entry means that folder, and OpenCV leaves one as it appends to what is unset when it is imported. So the
    path is never empty: nothing can lie in the null device.
    """
    return ":".join(filter(None, os.environ.get("LD_LIBRARY_PATH", "").split(":"))) or os.devnull


def _is_current_folder(entry: str) -> bool:
    try:
        return Path(entry).samefile(Path.cwd())
    except (OSError, ValueError):
        return False
