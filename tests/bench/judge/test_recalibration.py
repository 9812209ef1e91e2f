"""`ashe-live bench fit-judge --confidence` on the project's own scenes: other confidences by the same curves."""

from pathlib import Path

import pytest

from ashe_live.bench.judge.fit import TABLES
from ashe_live.bench.judge.recalibration import RecalibrationBench
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.judgement.judge_tables import read_tables


def test_the_curves_stay_and_the_tables_say_what_the_confidences_were_fitted_to(tmp_path: Path) -> None:
    RecalibrationBench([resource("assets", "scenes")], limit=3, every=2).run(tmp_path / "out")
    shipped = fitted_judge().tables.as_json()
    found = read_tables((tmp_path / "out" / TABLES).read_text(encoding="utf-8")).as_json()
    for stays in ("explanation", "split", "known_body"):
        assert found[stays] == shipped[stays]
    assert found["averages"] != shipped["averages"]
    assert found["origin"]["pictures"] == shipped["origin"]["pictures"]
    assert found["origin"]["confidence"]["pictures"] == 2
    assert found["origin"]["confidence"]["command"].endswith("--confidence --scenes scenes --limit 3 --every 2")


def test_sets_without_a_known_light_get_a_line() -> None:
    with pytest.raises(UserError, match="no picture with a known light"):
        RecalibrationBench([resource("assets", "scenes")], limit=0).run()
