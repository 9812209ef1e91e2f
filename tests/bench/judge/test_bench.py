"""`ashe-live bench fit-judge` on the project's own scenes: tables that the package can load."""

import json
from pathlib import Path

import pytest

from ashe_live.bench.judge.bench import JudgeBench
from ashe_live.bench.judge.fit import TABLES
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.light.explanation.judgement.judge_tables import read_tables


def test_the_package_can_load_them(tmp_path: Path) -> None:
    JudgeBench([resource("assets", "scenes")], limit=2).run(tmp_path / "out")
    text = (tmp_path / "out" / TABLES).read_text(encoding="utf-8")
    tables = read_tables(text)
    assert tables.origin["pictures"] == 2
    assert json.loads(json.dumps(tables.as_json())) == json.loads(text)


def test_sets_without_a_known_light_get_a_line() -> None:
    with pytest.raises(UserError, match="no picture with a known light"):
        JudgeBench([resource("assets", "scenes")], limit=0).run()
