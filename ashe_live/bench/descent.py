"""Fits figures to a cost that has no derivatives."""

from collections.abc import Callable, Sequence
from itertools import product


def coordinate_descent(
    start: Sequence[float],
    cost: Callable[[Sequence[float]], float],
    factors: Sequence[float],
    limits: Sequence[tuple[float, float]],
    gain: float = 1e-9,
) -> list[float]:
    """The positive figures with the least `cost` that multiplying one of them at a time leads to from `start`.

    factors: by which each is multiplied and divided, from coarse to fine, each until none lowers the cost by `gain`.
    limits: the least and the largest value of each.
    """
    best, least = list(start), cost(start)
    for factor in factors:
        improves = True
        while improves:
            improves = False
            for place, by in product(range(len(best)), (factor, 1 / factor)):
                lowest, highest = limits[place]
                tried = [*best[:place], min(max(by * best[place], lowest), highest), *best[place + 1 :]]
                if (tried_cost := cost(tried)) < least - gain:
                    best, least, improves = tried, tried_cost, True
    return best
