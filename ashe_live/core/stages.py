"""Where an estimate's time goes."""

import time


class StageClock:
    """Milliseconds by stage, from its making on; what runs between two `end`s belongs to the second one's stage."""

    def __init__(self) -> None:
        self._begin = self._last = time.perf_counter()
        self._stages: dict[str, float] = {}

    def end(self, stage: str) -> None:
        """Books the time since the last `end` under `stage`."""
        now = time.perf_counter()
        self._stages[stage] = self._stages.get(stage, 0.0) + 1000 * (now - self._last)
        self._last = now

    def timing_ms(self) -> dict[str, float]:
        """By stage, with the time since the beginning as "total"."""
        return {**self._stages, "total": 1000 * (time.perf_counter() - self._begin)}
