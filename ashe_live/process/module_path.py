"""Where modules, programs and libraries are looked for: not in the current folder, where a clip lies among anything."""

import os
import sys
import sysconfig
from pathlib import Path


def safe_module_path() -> list[str]:
    """Python's module path without the current folder, unless it is where this package or Python itself lies."""
    ours = {Path(__file__).parents[2], *map(Path, sysconfig.get_paths().values())}
    return [entry for entry in sys.path if entry and (Path(entry) in ours or not _is_current_folder(entry))]


def safe_search_paths() -> dict[str, str]:
    """The environment's lists of folders to search for modules, programs and libraries, without the current folder.

    An empty entry means that folder: OpenCV leaves one in LD_LIBRARY_PATH as it appends to what is unset when it is
    imported, so that is never empty (nothing can lie in the null device). Without a PATH the system's own holds.
    """
    safe = {
        name: os.pathsep.join(
            entry for entry in os.environ[name].split(os.pathsep) if entry and not _is_current_folder(entry)
        )
        for name in ("PYTHONPATH", "PATH", "LD_LIBRARY_PATH")
        if name in os.environ
    }
    if "PATH" in safe:
        safe["PATH"] = safe["PATH"] or os.defpath
    return safe | {"LD_LIBRARY_PATH": safe.get("LD_LIBRARY_PATH") or os.devnull}


def _is_current_folder(entry: str) -> bool:
    try:
        return Path(entry).samefile(Path.cwd())
    except (OSError, ValueError):
        return False
