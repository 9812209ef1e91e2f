"""Finds the shaders and assets: inside the installed package, or in the checkout beside it."""

from importlib.resources import files
from pathlib import Path

PACKAGE = "ashe_live"


def resource(folder: str, *parts: str) -> Path:
    """Path of a file in `shaders` or `assets`. Raises FileNotFoundError when neither place has it."""
    package = Path(str(files(PACKAGE)))
    for root in (package, package.parent):
        path = root.joinpath(folder, *parts)
        if path.exists():
            return path
    raise FileNotFoundError(f"{'/'.join((folder, *parts))} is neither in the package nor in the checkout")
