"""The models that ship with the program, and how a name or a path becomes one."""

import os
from dataclasses import dataclass
from pathlib import Path

from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.models.loading import SUFFIXES, load_model_file
from ashe_live.models.mesh import Model

FIRST = "cube"
MOST_MODELS = 9  # at once


@dataclass(frozen=True, slots=True)
class ChosenModel:
    """A model by its name or path, and what it is to stand on."""

    name: str
    marker: str | None = None  # the spec of a marker of its own; None: the one that is followed


def model_names() -> tuple[str, ...]:
    """Names of the shipped models in the order of the number keys: the cube, then by alphabet."""
    names = {path.stem for path in resource("assets", "models").glob("*.glb")}
    return tuple(sorted(names, key=lambda name: (name != FIRST, name)))


def load_model(name_or_path: str, up: str | None = None) -> Model:
    """A shipped model by its name, or any model file by its path, `up` as in `load_model_file`.

    Raises UserError when it is neither.
    """
    return load_model_file(model_file(name_or_path), up)


def model_file(name_or_path: str) -> Path:
    """The file of a shipped model by its name, or that of any by its path, which need not be there if its suffix fits.

    Raises UserError for what is neither a name nor a path.
    """
    if name_or_path in model_names():
        return resource("assets", "models", f"{name_or_path}.glb")
    path = Path(name_or_path)
    if path.suffix.lower() in SUFFIXES or os.path.exists(path):  # noqa: PTH110 - of any name, also one that is too long
        return path
    raise UserError(
        f"there is no model '{name_or_path}'", f"choose one of {', '.join(model_names())}, or give a file's path"
    )
