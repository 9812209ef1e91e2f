"""Types of arrays, the checks with which value types freeze theirs, and a few computations that many parts need."""

import itertools
import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cache, wraps
from typing import Any, TypeVar, TypeVarTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
Image = NDArray[np.uint8]
GivenImage = NDArray[Any]  # a caller's, checked when it comes: OpenCV's types do not say that pictures are uint8
Item = TypeVar("Item")
Owner = TypeVar("Owner")
Others = TypeVarTuple("Others")
Result = TypeVar("Result")

# The standard deviation of a normal variable over its median absolute deviation.
SIGMA_OVER_MAD = 1.48
# Multiples of the golden section of 1, or of a whole turn, taken modulo that, are spread evenly, however many.
GOLDEN_SHARE = (math.sqrt(5) - 1) / 2
GOLDEN_ANGLE_RAD = math.pi * (3 - math.sqrt(5))
# Binary places of the coordinates of polygons that OpenCV draws.
FRACTION_BITS = 4


def frozen_floats(values: ArrayLike, shape: tuple[int, ...], name: str) -> Float:
    """A read-only float64 copy of `values`; -1 in `shape` allows any length.

    An array that this function has returned before is returned as it is, so that its identity can stand for its
    values. Raises TypeError for what is not a number, ValueError when the shape differs or a value is not finite.
    """
    is_frozen = isinstance(values, np.ndarray) and values.base is None and not values.flags.writeable
    try:
        if (kind := np.asarray(values).dtype).kind not in "biufO":  # what NumPy would make floats of: text, dates, ...
            raise TypeError(f"they are {kind}")
        array = np.asarray(values, dtype=np.float64) if is_frozen else np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name} must be numbers of the shape {_shape_text(shape)} ({error})") from None
    if array.ndim != len(shape) or any(want not in (-1, got) for want, got in zip(shape, array.shape, strict=True)):
        raise ValueError(f"{name} has shape {array.shape}, not {_shape_text(shape)}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} holds a value that is not finite")
    array.flags.writeable = False
    return array


def _shape_text(shape: tuple[int, ...]) -> str:
    return str(shape).replace("-1", "n")


def frozen_view(array: NDArray[Any]) -> NDArray[Any]:
    """A read-only view of `array`, without a copy: what images of several megabytes deserve.

    A read-only view is returned as it is, so that its identity can stand for its values.
    """
    if array.base is not None and not array.flags.writeable:
        return array
    view = array.view()
    view.flags.writeable = False
    return view


def set_frozen(instance: object, **values: object) -> None:
    """Sets fields of a frozen dataclass; for use in its __post_init__, and on a copy that nobody else has yet."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)


def set_given_frozen(instance: object, **shapes: tuple[int, ...]) -> None:
    """Replaces each field by its `frozen_floats` of the given shape; one that is None, not measured, stays None."""
    for name, shape in shapes.items():
        if (values := getattr(instance, name)) is not None:
            set_frozen(instance, **{name: frozen_floats(values, shape, name)})


def set_views(instance: object, *names: str) -> None:
    """Replaces each array of these fields by its `frozen_view`; one that is None stays None."""
    for name in names:
        if (array := getattr(instance, name)) is not None:
            set_frozen(instance, **{name: frozen_view(np.asarray(array))})


def read_only_copies(cls: type[Owner]) -> type[Owner]:
    """Makes the arrays of a frozen dataclass read-only also in a deep copy and in one for another process.

    NumPy copies and unpickles arrays as writable ones, so that a value that came back from there could be changed.
    """

    def restored(self: Owner, state: Sequence[object] | Mapping[str, object]) -> None:
        values = state if isinstance(state, Mapping) else dict(zip(_names(self), state, strict=True))
        for value in values.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        set_frozen(self, **values)

    cls.__setstate__ = restored  # type: ignore[attr-defined]
    return cls


def _names(instance: object) -> list[str]:
    """Of the fields of a dataclass, those that a subclass adds too."""
    return [field.name for field in fields(cast(Any, instance))]


def same_objects(some: Sequence[object], others: Sequence[object]) -> bool:
    """Whether both hold the same objects in the same order; equal ones do not count."""
    return len(some) == len(others) and all(a is b for a, b in zip(some, others, strict=True))


def without(items: Iterable[Item], gone: Collection[Item]) -> list[Item]:
    """Those that are none of the objects in `gone`; equal ones do not count."""
    return [item for item in items if not any(item is other for other in gone)]


def distinct(items: Iterable[Item], are_alike: Callable[[Item, Item], bool], most: int | None = None) -> list[Item]:
    """The items in order, without those that are like an earlier one; `most` of them at most.

    are_alike: of an item and one that was kept before it.
    """
    kept: list[Item] = []
    for item in items:
        if len(kept) == most:
            break
        if not any(are_alike(item, other) for other in kept):
            kept.append(item)
    return kept


def cached_by_array(method: Callable[[Owner, Float], Result]) -> Callable[[Owner, Float], Result]:
    """Makes a method of one array compute each result once for its object: `functools.cache` takes no arrays.

    The object must have a __dict__, where the results are kept.
    """
    name = f"_{method.__name__}_by_array"

    @wraps(method)
    def cached(owner: Owner, array: Float) -> Result:
        results: dict[bytes, Result] = owner.__dict__.setdefault(name, {})
        key = np.ascontiguousarray(array).tobytes()
        if key not in results:
            results[key] = method(owner, array)
        return results[key]

    return cached


def once_for_each(function: Callable[[Owner, *Others], Result]) -> Callable[[Owner, *Others], Result]:
    """Makes a function of one object, and maybe of others, compute its result once for these.

    The first object must have a __dict__, where the result for the last others is kept.
    """
    name = f"_{function.__qualname__}_once"

    @wraps(function)
    def once(owner: Owner, *others: *Others) -> Result:
        known: tuple[tuple[*Others], Result] | None = owner.__dict__.get(name)
        if known is None or not same_objects(known[0], others):
            known = owner.__dict__[name] = others, function(owner, *others)
        return known[1]

    return once


def fixed_point(pixels: NDArray[Any], bits: int = FRACTION_BITS) -> NDArray[np.int32]:
    """Coordinates of any shape in 2 ** -bits pixels, rounded: as OpenCV draws polygons with `shift=bits`."""
    return np.asarray(np.round(pixels * 2**bits), dtype=np.int32)


def cross_2d(a: Float | Float32, b: Float | Float32) -> Float:
    """(...) third components of the cross products of vectors (..., 2): NumPy's own takes three dimensions."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def cross_3d(a: Float, b: Float) -> Float:
    """(3,) the cross product of two vectors (3,), of which NumPy's own takes ten times as long."""
    return np.array((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


@cache
def unit_circle(count: int, start: float = 0.0) -> Float:
    """(count, 2) points evenly around the unit circle, from x towards y, the first by `start` of a step from x.

    Shared by all who ask for it, and so read-only.
    """
    angles = (np.arange(count) + start) * (2 * math.pi / count)
    return frozen_view(np.column_stack([np.cos(angles), np.sin(angles)]))


def box_corners(bounds: Float) -> Float:
    """(8, 3) corners of a box given by its smallest and largest coordinates (2, 3)."""
    return np.array(list(itertools.product(*bounds.T)))


def median(values: Float | Float32) -> float:
    """The median of values (n,); np.median also checks for NaN, and takes several times as long."""
    middle = len(values) // 2
    partitioned = np.partition(values, middle)
    upper = partitioned[middle]
    return float(upper if len(values) % 2 else 0.5 * (upper + partitioned[:middle].max()))


def upper_median(values: Float | Float32) -> float:
    """The median of values (n,), or the upper of the two middle ones; many times as fast as NumPy's for few values."""
    return upper_quantile(values, 0.5)


def upper_quantile(values: Float | Float32, share: float) -> float:
    """The value (of n) that has `share` * n of them, rounded down, before it in rising order; `share` is below 1.

    Unlike NumPy's quantile it is one of the values, and not interpolated.
    """
    rank = int(share * len(values))
    return float(np.partition(values, rank)[rank])


def lowest_on_parabola(at: Float, values: Float) -> float:
    """Where the parabola through three points is lowest, between the outer two; the middle one where it has no bottom.

    at, values: (3,) of the points, `at` rising.
    """
    second, slope, _ = np.polyfit(at - at[1], values, 2)
    return float(np.clip(at[1] - slope / (2 * second), at[0], at[2])) if second > 0 else float(at[1])


def directions_on_spiral(count: int, first_z: float = 1.0, last_z: float = -1.0) -> Float:
    """(count, 3) unit vectors, evenly spread over the zone of the sphere between two z, by default all of it.

    A golden-angle spiral from the first to the last (Vogel, "A better way to construct the sunflower head", 1979).
    """
    z = first_z + (last_z - first_z) * (np.arange(count) + 0.5) / count
    azimuth = np.arange(count) * GOLDEN_ANGLE_RAD
    flat = np.sqrt(1 - z**2)
    return np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), z])
