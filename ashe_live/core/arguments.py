"""Checks of arguments from Python, whose errors name the argument: TypeError for its kind, ValueError for its value.

`name` is the argument's name, as the caller wrote it.
"""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ashe_live.core.arrays import GivenImage, Image
from ashe_live.core.ranges import SIDE

Value = TypeVar("Value")


def instance(value: Value, kind: type[Any], name: str) -> Value:
    """Returns `value`, which must be of the class `kind`."""
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be {_a(kind)}, and is {_a(type(value))}")
    return value


def _a(kind: type[Any]) -> str:
    return f"{'an' if kind.__name__[0] in 'AEIOUaeiou' else 'a'} {kind.__name__}"


def text(value: str, name: str) -> str:
    """Returns `value`, which must be a str without NUL."""
    instance(value, str, name)
    if "\0" in value:
        raise ValueError(f"{name} has a NUL in it")
    return value


def text_or_path(value: str | os.PathLike[str], name: str) -> str:
    """Returns a str, or a path as one, without NUL."""
    if not isinstance(value, str | os.PathLike) or isinstance(os.fspath(value), bytes):
        raise TypeError(f"{name} must be a str or a Path, and is {_a(type(value))}")
    return text(os.fspath(value), name)


def path(value: str | os.PathLike[str], name: str) -> Path:
    """Returns a str or path as a Path."""
    return Path(text_or_path(value, name))


def one_of(value: str, choices: Iterable[str], name: str) -> str:
    """Returns `value`, which must be among `choices`."""
    known = list(choices)
    if text(value, name) not in known:
        raise ValueError(f"{name} {value!r} is not one of {', '.join(known)}")
    return value


def picture(value: GivenImage, name: str, channels: tuple[int, ...] = (3,)) -> Image:
    """Returns `value`, which must be (h, w, c) uint8 with c among `channels` and at least one pixel."""
    if not isinstance(value, np.ndarray):
        raise TypeError(f"{name} must be a NumPy array, and is a {type(value).__name__}")
    if value.ndim != 3 or value.shape[2] not in channels or value.dtype != np.uint8 or value.size == 0:
        shapes = " or ".join(f"(h, w, {count})" for count in channels)
        raise ValueError(f"{name} must be {shapes} uint8, and is {value.shape} {value.dtype}")
    return value


def picture_size(value: tuple[int, int], name: str) -> tuple[int, int]:
    """Returns (width, height), which must be whole pixels."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise TypeError(f"{name} must be (width, height), and is {value!r:.40}")
    for side in value:
        if isinstance(side, bool) or not isinstance(side, int | np.integer):
            raise TypeError(f"{name} must be two whole numbers, and has a {type(side).__name__}")
        SIDE.checked(int(side), f"a side of {name}")
    return int(value[0]), int(value[1])
