"""What all benches share: a record that is written part by part, whatever could not be measured."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

from ashe_live.bench.bench import RESULTS, Bench
from ashe_live.core.contract import Json


class _Unmeasured(Bench):
    def parts(self) -> Iterator[Json]:
        yield {"rows": [{"ratio": math.nan, "within": (1.0, math.inf)}], "count": 2}


def test_what_could_not_be_measured_is_null_in_the_record(tmp_path: Path) -> None:
    record = _Unmeasured().run(tmp_path)
    written = json.loads((tmp_path / RESULTS).read_text(encoding="utf-8"))
    assert written["rows"] == record["rows"] == [{"ratio": None, "within": [1.0, None]}]
    assert written["count"] == 2
