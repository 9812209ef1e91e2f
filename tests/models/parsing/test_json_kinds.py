"""Kinds of values in JSON: what each takes, up to its limits, and how it names what it refuses."""

import json
import math
from typing import Any

import pytest

from ashe_live.models.parsing.json_kinds import (
    LARGEST,
    LARGEST_INTEGER,
    Kind,
    Required,
    WrongValueError,
    flag,
    index_of,
    integer_from,
    list_of,
    number,
    object_of,
    one_of,
    share,
    text,
)

COUNTS = {"nodes": 3}
MODES = one_of((0, 4, "BLEND"))
THING = object_of({"name": Required(text), "weights": list_of(number), "node": index_of("nodes")})


@pytest.mark.parametrize(
    ("kind", "value", "copy"),
    [
        (number, 2, 2.0),
        (number, -LARGEST, -LARGEST),
        (share, 1.5, 1.0),
        (share, -1, 0.0),
        (share, 0.25, 0.25),
        (text, "", ""),
        (flag, False, False),
        (integer_from(1), 1, 1),
        (integer_from(-5), LARGEST_INTEGER, LARGEST_INTEGER),
        (index_of("nodes"), 0, 0),
        (index_of("nodes"), 2, 2),
        (MODES, 4, 4),
        (MODES, "BLEND", "BLEND"),
        (list_of(number, 2), [1, 2], [1.0, 2.0]),
        (list_of(text), [], []),
        (THING, {"name": "a", "node": 1, "other": {}}, {"name": "a", "node": 1}),
    ],
)
def test_what_is_right_is_copied_without_what_is_not_named(kind: Kind, value: Any, copy: Any) -> None:
    found = kind(value, COUNTS)
    assert found == copy
    assert type(found) is type(copy)


@pytest.mark.parametrize(
    ("kind", "value", "said"),
    [
        (number, True, "is true, not a number"),
        (number, "1", 'is "1", not a number'),
        (number, math.nan, "is NaN, not a number"),
        (number, -1.1 * LARGEST, "too large a number"),
        (number, math.inf, "too large a number"),
        (number, 10**400, "too large a number"),
        (share, None, "is null, not a number"),
        (text, 1, "is 1, not a string"),
        (flag, 1, "is 1, not true or false"),
        (flag, "true", 'is "true", not true or false'),
        (integer_from(1), 0, "is 0, not an integer from 1"),
        (integer_from(1), 1.0, "is 1.0, not an integer from 1"),
        (integer_from(0), True, "is true, not an integer from 0"),
        (integer_from(0), LARGEST_INTEGER + 1, "not an integer from 0"),
        (index_of("nodes"), 3, "is 3, and there are 3 nodes"),
        (index_of("nodes"), -1, "is -1, and there are 3 nodes"),
        (index_of("nodes"), False, "is false, and there are 3 nodes"),
        (index_of("meshes"), 0, "is 0, and there are 0 meshes"),
        (MODES, 1, "is 1, not one of 0, 4, BLEND"),
        (MODES, False, "is false, not one of 0, 4, BLEND"),
        (MODES, [], "is a list of 0, not one of"),
        (list_of(number), {}, "is an object, not a list"),
        (list_of(number, 2), [1], "is a list of 1, not a list of 2 values"),
        (THING, [], "is a list of 0, not an object"),
    ],
)
def test_what_is_wrong_is_said(kind: Kind, value: Any, said: str) -> None:
    with pytest.raises(WrongValueError) as caught:
        kind(value, COUNTS)
    assert said in caught.value.what
    assert caught.value.where == ""


@pytest.mark.parametrize(
    ("value", "where"),
    [
        ({}, ".things[1].name"),
        ({"name": 3}, ".things[1].name"),
        ({"name": "a", "weights": [1, 2, "x"]}, ".things[1].weights[2]"),
        ({"name": "a", "node": 9}, ".things[1].node"),
        (None, ".things[1]"),
    ],
)
def test_where_it_is_grows_from_the_value_to_the_document(value: Any, where: str) -> None:
    document = json.loads(json.dumps({"things": [{"name": "right"}, value]}))
    with pytest.raises(WrongValueError) as caught:
        object_of({"things": list_of(THING)})(document, COUNTS)
    assert caught.value.where == where
