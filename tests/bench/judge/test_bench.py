"""`ashe-live bench fit-judge` on the project's own scenes: tables that the package can load, the same ones again."""

import json

import pytest

from ashe_live.bench.judge.bench import JudgeBench
from ashe_live.bench.judge.fit import TABLES
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from ashe_live.light.explanation.judgement.judge_tables import read_tables


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The tables of two pictures, by one process and by two."""
    folders = [tmp_path_factory.mktemp(name) / "out" for name in ("one", "two")]
    for jobs, folder in enumerate(folders, start=1):
        JudgeBench([resource("assets", "scenes")], limit=2, jobs=jobs).run(folder)
    return [(folder / TABLES).read_text(encoding="utf-8") for folder in folders]


def test_the_same_pictures_give_the_same_tables_in_any_number_of_processes(written: list[str]) -> None:
    one, other = written
    assert one == other


def test_the_package_can_load_them(written: list[str]) -> None:
    text, _ = written
    tables = read_tables(text)
    assert tables.origin["pictures"] == 2
    assert json.loads(json.dumps(tables.as_json())) == json.loads(text)


def test_sets_without_a_known_light_get_a_line() -> None:
    with pytest.raises(UserError, match="no picture with a known light"):
        JudgeBench([resource("assets", "scenes")], limit=0).run()
