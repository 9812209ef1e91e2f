"""Items handled by one call get the results that they would get alone, in their places."""

import pytest

from ashe_live.light.shape.batches import for_alike, for_groups, for_known


class Calls:
    """Squares numbers, and keeps what each call was for."""

    def __init__(self) -> None:
        self.made: list[list[int]] = []

    def __call__(self, items: list[int]) -> list[int]:
        self.made.append(items)
        return [item**2 for item in items]


def test_groups_are_handled_by_one_call_and_keep_what_is_theirs() -> None:
    squares = Calls()
    assert for_groups(squares, [[3, 1], [], [2]]) == [[9, 1], [], [4]]
    assert squares.made == [[3, 1, 2]]


def test_what_is_not_known_stays_so_and_is_not_asked_for() -> None:
    squares = Calls()
    assert for_known(squares, [None, 3, None, 2]) == [None, 9, None, 4]
    assert squares.made == [[3, 2]]


def test_one_call_has_items_of_one_key_alone_and_results_are_in_the_items_order() -> None:
    squares = Calls()
    assert for_alike(squares, [5, 2, 3, 4], key=lambda item: item % 2) == [25, 4, 9, 16]
    assert squares.made == [[2, 4], [5, 3]]
    assert for_alike(squares, [], key=abs) == []


def test_a_call_that_loses_an_item_is_a_fault() -> None:
    with pytest.raises(ValueError, match="shorter"):
        for_alike(lambda items: items[1:], [1, 2], key=lambda _: 0)
