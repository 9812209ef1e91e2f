"""Very many cases: counted, what broke by its cause, each with the smallest case that shows it."""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings

from tests.fuzz.command_lines.case import Case
from tests.fuzz.command_lines.oracle import broken_promises
from tests.fuzz.command_lines.promises import Broken, by_cause
from tests.fuzz.command_lines.runner import Runner
from tests.fuzz.command_lines.strategies import cases

# Hypothesis stops soon after it has found something; a new batch goes on without looking at that again.
BATCH = 500
# What takes its time to show itself, or shows itself by chance, is kept as it was found.
SLOW_S = 1.0


class BrokenPromiseError(AssertionError):
    """Of one cause: a subclass for each, as Hypothesis tells faults apart by their types."""


@cache
def _broken_promise(cause: str) -> type[BrokenPromiseError]:
    return type(cause, (BrokenPromiseError,), {})


class Campaign:
    """Runs cases and remembers; `tell` gets a line about how far it is now and then."""

    def __init__(self, runner: Runner, tell: Callable[[str], None]) -> None:
        self._runner, self._tell = runner, tell
        self._known: dict[str, tuple[Broken, Case]] = {}
        self._counts: Counter[str] = Counter()
        self._statuses: Counter[str] = Counter()
        self._commands: Counter[str] = Counter()
        self._walls_s: list[float] = []

    def batches(self, count: int, first_seed: int) -> Iterator[None]:
        """Tries `count` cases, with those that shrinking takes, and hands over now and then."""
        begun, batch = time.monotonic(), 0
        while len(self._walls_s) < count:
            batch += 1
            self._batch(min(BATCH, count - len(self._walls_s)), first_seed * 1_000_000 + batch)
            took_s = time.monotonic() - begun
            self._tell(f"{len(self._walls_s)} of {count} cases in {took_s:.0f} s, {len(self._known)} causes")
            yield

    def summary(self) -> dict[str, Any]:
        """For JSON; `broken` by cause, the most frequent first."""
        walls_s = sorted(self._walls_s) or [0.0]
        return {
            "cases": len(self._walls_s),
            "median_s": walls_s[len(walls_s) // 2],
            "mean_s": sum(walls_s) / len(walls_s),
            "longest_s": walls_s[-1],
            "commands": dict(self._commands.most_common()),
            "statuses": dict(self._statuses.most_common()),
            "broken": {
                cause: {"times": times, "detail": str(self._known[cause][0]), "case": self._known[cause][1].to_json()}
                for cause, times in self._counts.most_common()
            },
        }

    def _batch(self, count: int, number: int) -> None:
        known_before = frozenset(self._known)

        @seed(number)
        @settings(
            max_examples=count,
            phases=[Phase.generate, Phase.shrink],
            derandomize=False,
            database=None,
            print_blob=False,
            report_multiple_bugs=False,
            suppress_health_check=list(HealthCheck),
        )
        @given(cases())
        def try_one(case: Case) -> None:
            for cause in self._try(case):
                if cause not in known_before and case.is_repeatable and self._walls_s[-1] < SLOW_S:
                    raise _broken_promise(cause)(cause)

        try:
            try_one()
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or not _is_about_a_promise(error):
                raise

    def _try(self, case: Case) -> list[str]:
        begun = time.monotonic()
        with self._runner.run(case) as outcome:
            broken = by_cause(broken_promises(case, outcome))
        self._walls_s.append(time.monotonic() - begun)
        self._statuses.update(str(ended.status) for ended in outcome.ended)
        self._commands[next(iter(case.arguments), "")[:12]] += 1
        self._counts.update(broken.keys())
        for cause, each in broken.items():
            if cause not in self._known:
                self._tell(f"new: {cause}: {each.detail[:300]}: {case.arguments}")
            if cause not in self._known or _size(case) < _size(self._known[cause][1]):
                self._known[cause] = each, case
        return sorted(broken)


def _size(case: Case) -> int:
    return len(case.to_json())


def _is_about_a_promise(error: BaseException) -> bool:
    """Hypothesis raises it alone, several in a group, or one that did not happen again as FlakyFailure."""
    inner = error.exceptions if isinstance(error, BaseExceptionGroup) else (error,)
    return all(isinstance(each, BrokenPromiseError) or type(each).__name__.startswith("Flaky") for each in inner)
