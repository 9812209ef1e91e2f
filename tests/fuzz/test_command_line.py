"""Command lines as processes, in hostile folders and circumstances: not one promise is broken."""

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from tests.fuzz.command_lines.campaign import Campaign
from tests.fuzz.command_lines.case import read_cases
from tests.fuzz.command_lines.oracle import broken_promises
from tests.fuzz.command_lines.strategies import cases

KEPT = read_cases(Path(__file__).with_name("corpus"))
FEW = settings(max_examples=12, suppress_health_check=list(HealthCheck))  # --fuzz-cases hunts


@pytest.mark.parametrize("name", KEPT)
def test_what_once_broke_a_promise_breaks_none(runner, name):
    with runner.run(KEPT[name]) as outcome:
        broken = broken_promises(KEPT[name], outcome)
        assert not broken, "\n".join(map(str, broken))


@FEW
@given(case=cases())
def test_no_command_line_breaks_a_promise(runner, case):
    with runner.run(case) as outcome:
        broken = broken_promises(case, outcome)
        assert not broken, "\n".join(map(str, broken))


def test_no_command_line_of_very_many_breaks_a_promise(runner, capsys, pytestconfig):
    count = pytestconfig.getoption("fuzz_cases", None)
    if count is None:
        pytest.skip("a long run: --fuzz-cases N --fuzz-seed N --fuzz-summary FILE.json")

    def tell(line: str) -> None:
        with capsys.disabled():
            print(line, flush=True)

    path = pytestconfig.getoption("fuzz_summary")
    campaign = Campaign(runner, tell)
    for _ in campaign.batches(count, pytestconfig.getoption("fuzz_seed")):
        summary = campaign.summary()
        if path is not None:
            path.write_text(json.dumps(summary, indent=1), encoding="utf-8")
    assert summary["broken"] == {}, "\n".join(summary["broken"])
