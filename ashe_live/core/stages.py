"""The stages of an estimate by name, and the time that each has taken."""

import time


class StageClock:
    """Measures milliseconds by stage from its creation on; the time between two `end`s belongs to the second's."""

    def __init__(self) -> None:
        self._begin = self._last = time.perf_counter()
        self._stages: dict[str, float] = {}

    def end(self, stage: str) -> None:
        """Books the time since the last `end` under `stage`."""
        now = time.perf_counter()
        self._stages[stage] = self._stages.get(stage, 0.0) + 1000 * (now - self._last)
        self._last = now

    def timing_ms(self) -> dict[str, float]:
        """Milliseconds by stage, and as "total" those since the beginning."""
        return {**self._stages, "total": 1000 * (time.perf_counter() - self._begin)}
