"""Kinds of values in JSON: each checks one, and copies it without what its kind does not name."""

import json
import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

from ashe_live.process.messages import printable

Json = dict[str, Any]
# A value's checked copy. The second argument says how many of each property of the document there are.
Kind = Callable[[Any, Mapping[str, int]], Any]

SHOWN_CHARACTERS = 40
LARGEST_INTEGER = 2**53  # that JSON carries between programs
LARGEST = 1e30  # of numbers: products of a few stay finite


class WrongValueError(Exception):
    """`where` grows on the way out, from the value to the document."""

    def __init__(self, what: str) -> None:
        super().__init__(what)
        self.what, self.where = what, ""

    def within(self, key: str | int) -> "WrongValueError":
        self.where = (f"[{key}]" if isinstance(key, int) else f".{key}") + self.where
        return self


@dataclass(frozen=True, slots=True)
class Required:
    kind: Kind


def object_of(fields: Mapping[str, Kind | Required]) -> Kind:
    def check(value: Any, counts: Mapping[str, int]) -> Json:
        if not isinstance(value, dict):
            raise WrongValueError(f"is {_shown(value)}, not an object")
        copy = {}
        for name, field in fields.items():
            if name not in value:
                if isinstance(field, Required):
                    raise WrongValueError("is missing").within(name)
                continue
            try:
                copy[name] = (field.kind if isinstance(field, Required) else field)(value[name], counts)
            except WrongValueError as error:
                raise error.within(name) from None
        return copy

    return check


def list_of(kind: Kind, length: int | None = None) -> Kind:
    def check(value: Any, counts: Mapping[str, int]) -> list[Any]:
        if not isinstance(value, list) or (length is not None and len(value) != length):
            wanted = "a list" if length is None else f"a list of {length} values"
            raise WrongValueError(f"is {_shown(value)}, not {wanted}")
        copy = []
        for place, item in enumerate(value):
            try:
                copy.append(kind(item, counts))
            except WrongValueError as error:
                raise error.within(place) from None
        return copy

    return check


def index_of(of: str) -> Kind:
    def check(value: Any, counts: Mapping[str, int]) -> int:
        count = counts.get(of, 0)
        if type(value) is not int or not 0 <= value < count:
            raise WrongValueError(f"is {_shown(value)}, and there are {count} {of}")
        return value

    return check


def integer_from(least: int) -> Kind:
    def check(value: Any, _: Mapping[str, int]) -> int:
        if type(value) is not int or not least <= value <= LARGEST_INTEGER:
            raise WrongValueError(f"is {_shown(value)}, not an integer from {least}")
        return value

    return check


def number(value: Any, _: Mapping[str, int]) -> float:
    # Before all else, as of an integer beyond the largest float nothing but this can be told.
    if type(value) in (int, float) and abs(value) > LARGEST:
        raise WrongValueError(f"is {_shown(value)}, too large a number: at most {LARGEST:g} is read")
    if type(value) not in (int, float) or math.isnan(value):
        raise WrongValueError(f"is {_shown(value)}, not a number")
    return float(value)


def share(value: Any, counts: Mapping[str, int]) -> float:
    return min(max(number(value, counts), 0.0), 1.0)


def text(value: Any, _: Mapping[str, int]) -> str:
    if not isinstance(value, str):
        raise WrongValueError(f"is {_shown(value)}, not a string")
    return value


def flag(value: Any, _: Mapping[str, int]) -> bool:
    if not isinstance(value, bool):
        raise WrongValueError(f"is {_shown(value)}, not true or false")
    return value


def one_of(choices: Collection[int | str]) -> Kind:
    def check(value: Any, _: Mapping[str, int]) -> Any:
        if isinstance(value, bool | list | dict) or value not in choices:
            raise WrongValueError(f"is {_shown(value)}, not one of {', '.join(map(str, choices))}")
        return value

    return check


def _shown(value: object) -> str:
    match value:
        case dict():
            return "an object"
        case list():
            return f"a list of {len(value)}"
        case _:
            return printable(json.dumps(value), SHOWN_CHARACTERS)
