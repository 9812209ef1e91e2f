"""Many small problems handled by one call: their arrays are so small that NumPy's overhead for a call dominates.

Each function hands items to `call`, which takes a list and gives one result for each item in the same order.
"""

from collections.abc import Callable, Iterable, Sequence

from ashe_live.core.arrays import Item, Result


def for_groups(call: Callable[[list[Item]], Iterable[Result]], groups: Sequence[Sequence[Item]]) -> list[list[Result]]:
    """The results for the items of all groups, in these groups."""
    results = iter(call([item for group in groups for item in group]))
    return [[next(results) for _ in group] for group in groups]


def for_known(call: Callable[[list[Item]], Iterable[Result]], items: Sequence[Item | None]) -> list[Result | None]:
    """The results for the items that are not None, in their places; None for the others."""
    results = iter(call([item for item in items if item is not None]))
    return [None if item is None else next(results) for item in items]


def for_alike(
    call: Callable[[list[Item]], Iterable[Result]], items: Sequence[Item], key: Callable[[Item], int]
) -> list[Result]:
    """The results in the items' order, where one call takes only items of one key, as their arrays have one shape."""
    keys = [key(item) for item in items]
    results: dict[int, Result] = {}
    for one in sorted(set(keys)):
        places = [place for place, other in enumerate(keys) if other == one]
        results.update(zip(places, call([items[place] for place in places]), strict=True))
    return [results[place] for place in range(len(items))]
