"""A clock that goes on when it is told to, so that what a bench times is known exactly."""

from types import SimpleNamespace

import pytest


class FakeClock:
    """Stands in for the module `time`; the processor is half as busy as time passes, asleep not at all."""

    def __init__(self) -> None:
        self._wall_s, self._cpu_s = 100.0, 10.0

    def work(self, ms: float) -> None:
        self._wall_s += ms / 1e3
        self._cpu_s += ms / 2e3

    def wall_s(self) -> float:
        return self._wall_s

    def cpu_s(self) -> float:
        return self._cpu_s

    def sleep(self, seconds: float) -> None:
        assert seconds >= 0
        self._wall_s += seconds

    def install(self, monkeypatch: pytest.MonkeyPatch, *modules: str) -> None:
        """In place of `time` in these modules."""
        stand_in = SimpleNamespace(
            perf_counter=self.wall_s,
            monotonic=self.wall_s,
            process_time=self.cpu_s,
            thread_time=self.cpu_s,
            sleep=self.sleep,
        )
        for module in modules:
            monkeypatch.setattr(f"{module}.time", stand_in)
