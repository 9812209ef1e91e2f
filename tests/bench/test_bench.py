"""What all benches share: a record that is written part by part, whatever could not be measured."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from ashe_live.bench.bench import RESULTS, Bench
from ashe_live.core.contract import Json
from ashe_live.errors import UserError


class _Unmeasured(Bench):
    def parts(self) -> Iterator[Json]:
        yield {"rows": [{"ratio": math.nan, "within": (1.0, math.inf)}], "count": 2}


def test_what_could_not_be_measured_is_null_in_the_record(tmp_path: Path) -> None:
    record = _Unmeasured().run(tmp_path)
    written = json.loads((tmp_path / RESULTS).read_text(encoding="utf-8"))
    assert written["rows"] == record["rows"] == [{"ratio": None, "within": [1.0, None]}]
    assert written["count"] == 2


class _Counting(Bench):
    measured = 0

    def parts(self) -> Iterator[Json]:
        _Counting.measured += 1
        yield {}


def test_results_that_exist_are_refused_before_anything_is_measured_unless_they_may_be_overwritten(
    tmp_path: Path,
) -> None:
    (tmp_path / RESULTS).write_text("precious")
    with pytest.raises(UserError, match="--overwrite"):
        _Counting().run(tmp_path)
    assert (tmp_path / RESULTS).read_text() == "precious"
    assert _Counting.measured == 0
    _Counting().run(tmp_path, overwrite=True)
    assert _Counting.measured == 1
    assert json.loads((tmp_path / RESULTS).read_text())["schema"] == Bench.SCHEMA
