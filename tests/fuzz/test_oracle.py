"""The fuzzer's own eyes: every promise that a program can break is seen to be broken."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fuzz.command_lines.case import WORK, Case, Planted, case_from
from tests.fuzz.command_lines.oracle import broken_promises
from tests.fuzz.command_lines.strategies import outputs_in

SINS = {
    "traceback": "a documented status",
    "status": "a documented status",
    "silence": "one line about an error",
    "two lines": "one line about an error",
    "log": "only lines of its own on stderr",
    "endless line": "lines of a bounded length",
    "sequence": "no control character on stdout",
    "sequence on the terminal": "no name controls the terminal",
    "changed": "foreign files stay",
    "touched": "foreign files stay",
    "replaced": "foreign files stay",
    "removed": "foreign files stay",
    "left over": "nothing is left over",
    "half": "outputs are whole",
    "not written": "what was asked for is written",
    "survivor": "no process survives",
    "call": "no network",
    "foreign code": "no foreign code runs",
    "hang": "it ends",
    "none": None,
}
SINNER = Path(__file__).with_name("sinner.py")
# What never ends is not waited for as long as a crowded machine may take for what does.
IMPATIENT = {"hang": {"longest_s": 1.0}, "survivor": {"survives_for_s": 0.5}}


@pytest.mark.parametrize("sin", SINS)
def test_a_broken_promise_is_seen(runner, sin):
    case = Case(
        (sin, "{port}"),
        (Planted(f"{WORK}/clip.mp4", "material", "clip.mp4"), Planted(f"{WORK}/pickle.py", "code")),
        ("walk.json",) if sin in ("half", "not written") else (),
        stdout="terminal" if "terminal" in sin else "file",
    )
    with runner.run(case, script=SINNER, **IMPATIENT.get(sin, {})) as outcome:
        promises = {each.promise for each in broken_promises(case, outcome)}
        assert SINS[sin] in promises if SINS[sin] else promises == set()


def test_too_much_memory_is_seen(runner):
    case = Case(("none", "{port}"))
    with runner.run(case, script=SINNER) as outcome:
        greedy = replace(outcome, largest_bytes=3 << 30)
        assert [each.promise for each in broken_promises(case, greedy)] == ["memory below 2 GB"]


def test_what_arbitrary_words_ask_to_be_written_is_known():
    """Without a command it is the demo's recording, by the last `--out`; a colon makes no address of its name."""
    assert outputs_in(["--out", "crypto:clip.mp4"]) == ["crypto:clip.mp4"]
    assert outputs_in(["--out", "a.mp4", "--out", "b.mp4"]) == ["b.mp4"]
    assert outputs_in(["play", "a.mp4"]) == []


def test_a_kept_case_is_read_as_it_was_written():
    case = Case(
        ("play", "\udcff"),
        (Planted("work/a", "link", "\x1b"),),
        ("r.mp4",),
        {"HOME": None},
        {"work": 0o555},
        limits={"RLIMIT_FSIZE": 1},
        signals=((3, 2, True),),
    )
    assert case_from(json.loads(case.to_json())) == case
