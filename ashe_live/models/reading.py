"""Reads a person's model file in a process of its own, within limits.

Whatever a file does to its parser, the viewer goes on; and parsing text would hold the interpreter's lock for longer
than a picture lasts.
"""

from collections.abc import Callable
from typing import TypeVar

from ashe_live.errors import UserError
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import PlacedModel, placed_on_marker
from ashe_live.process.children import Limits
from ashe_live.process.isolated import NoAnswerError, isolated_call

Result = TypeVar("Result")

# The largest models that the limits of limits.py let pass take three quarters of each.
LIMITS = Limits(niceness=10, memory_bytes=2_000_000_000, processor_s=20, silent=True)
LONGEST_S = 120.0  # by the clock, where others use the processor or a disk does not answer


def read_model(name: str, marker_side_m: float, up: str | None = None) -> PlacedModel:
    """A shipped model by its name, or any model file by its path, `up` as in `load_model_file`.

    Raises UserError when it cannot be shown.
    """
    if name in model_names():
        return _read(name, marker_side_m, up)
    return read_isolated(_read, (name, marker_side_m, up), name)


def read_isolated(read: Callable[..., Result], arguments: tuple[object, ...], file: str) -> Result:
    """The result of `read(*arguments)` for a model's file, in a process of its own; functions as for `isolated_call`.

    Raises the UserError that it raises, and one for a file that no process has read to its end.
    """
    try:
        return isolated_call(read, arguments, "ashe-live model", LIMITS, LONGEST_S)
    except NoAnswerError as failure:
        raise UserError(
            f"the model file {file} could not be read ({failure})", "reduce it, or export it again"
        ) from None


def _read(name: str, marker_side_m: float, up: str | None) -> PlacedModel:
    return placed_on_marker(load_model(name, up), marker_side_m)
