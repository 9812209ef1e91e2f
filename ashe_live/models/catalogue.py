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
    if name_or_path in model_names():
        return load_model_file(resource("assets", "models", f"{name_or_path}.glb"), up)
    path = Path(name_or_path)
    if path.suffix.lower() in SUFFIXES or os.path.exists(path):  # noqa: PTH110 - of any name, also one that is too long
        return load_model_file(path, up)
    raise UserError(
        f"there is no model '{name_or_path}'", f"choose one of {', '.join(model_names())}, or give a file's path"
    )
