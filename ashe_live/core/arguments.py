"""Checks of arguments from Python, whose errors name the argument: TypeError for its kind, ValueError for its value.

`name` is the argument's name, as the caller wrote it.
"""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float, GivenImage, Image, frozen_floats, set_frozen
from ashe_live.core.ranges import SIDE, VARIANCE, Range

Value = TypeVar("Value")
# A correlation that is further beyond 1, or from its mirror image in the matrix, does not come from rounding.
CORRELATED_WITHIN = 1e-4


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


def whole_number(value: int, allowed: Range, name: str) -> int:
    """Returns `value`, also of NumPy, as an int, which must be within that range."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} must be a whole number {allowed}, and is {_a(type(value))}")
    return int(allowed.checked(int(value), name))


def set_given_numbers(instance: object, **ranges: Range) -> None:
    """Replaces each field of a frozen dataclass by its number within that range; None, not measured, stays None."""
    for name, allowed in ranges.items():
        if (given := getattr(instance, name)) is not None:
            set_frozen(instance, **{name: allowed.checked(given, name)})


def covariance(value: ArrayLike, size: int, name: str) -> Float:
    """Returns (size, size) as `frozen_floats`, which must be symmetric, with no negative variance in any direction."""
    array = frozen_floats(value, (size, size), name)
    if _is_definite(array):
        return array
    for variance in array.diagonal():
        VARIANCE.checked(float(variance), f"a variance in {name}")
    sigmas = np.sqrt(array.diagonal())
    products, rounding = np.outer(sigmas, sigmas), np.finfo(np.float64).tiny
    # Halves, as the difference of the largest numbers is none.
    if (np.abs(array / 2 - array.T / 2) > CORRELATED_WITHIN / 2 * products + rounding).any():
        raise ValueError(f"{name} is not symmetric, and so no covariance")
    correlations = np.divide(array, products, out=np.zeros_like(array), where=products > rounding)
    is_beyond = np.abs(array) > (1 + CORRELATED_WITHIN) * products + rounding
    if is_beyond.any() or np.linalg.eigvalsh(correlations)[0] < -CORRELATED_WITHIN:
        raise ValueError(f"{name} is no covariance: it has a negative variance in some direction")
    return array


def _is_definite(array: Float) -> bool:
    """Whether a matrix (n, n) is clearly a covariance: what is measured in each frame is, and soon found out to be."""
    least = array.diagonal().min()
    if least <= 0 or np.abs(array).max() > VARIANCE.high:
        return False
    if np.abs(array - array.T).max() > CORRELATED_WITHIN * least:
        return False
    try:
        np.linalg.cholesky(array)
    except np.linalg.LinAlgError:
        return False
    return True


def set_given_covariances(instance: object, **sizes: int) -> None:
    """Replaces each field of a frozen dataclass by its `covariance` of that size; None, not measured, stays None."""
    for name, size in sizes.items():
        if (given := getattr(instance, name)) is not None:
            set_frozen(instance, **{name: covariance(given, size, name)})
