"""Where modules are looked for: not in the current folder, where a clip may lie beside a file named like a module."""

import sys
import sysconfig
from pathlib import Path


def safe_module_path() -> list[str]:
    """Python's module path without the current folder, unless it is where this package or Python itself lies."""
    ours = {Path(__file__).parents[2], *map(Path, sysconfig.get_paths().values())}
    return [entry for entry in sys.path if entry and (Path(entry) in ours or not _is_current_folder(entry))]


def _is_current_folder(entry: str) -> bool:
    try:
        return Path(entry).samefile(Path.cwd())
    except (OSError, ValueError):
        return False
