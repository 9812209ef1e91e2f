"""What an estimator answers: the times of its stages."""

import time
from collections.abc import Iterator

import pytest

from ashe_live.core.light_estimate import StageClock


def test_each_stage_gets_the_time_since_the_one_before_and_the_total_all_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    moments: Iterator[float] = iter((10.0, 10.25, 10.5, 11.5, 12.0))
    monkeypatch.setattr(time, "perf_counter", lambda: next(moments))
    clock = StageClock()
    for stage in ("segment", "fit", "segment"):
        clock.end(stage)
    assert clock.timing_ms() == {"segment": 1250.0, "fit": 250.0, "total": 2000.0}
