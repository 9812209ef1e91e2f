"""Wrong use: one line that says what and where to read on, and status 2."""

import pytest

from ashe_live import quality
from ashe_live.commands.flags import option_groups
from ashe_live.commands.flags.options import parsed

COMMANDS = (
    "demo",
    "webcam",
    "play",
    "estimate",
    "marker",
    "cameras",
    "board",
    "calibrate",
    "settings",
    "doctor",
    "bench",
)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--wings"], "--wings"),
        (["--quality", "best"], "best"),
        (["fly"], "fly"),
        (["esitmate", "a.jpg"], "did you mean estimate?"),
        (["estimate", "a.jpg", "--jsn"], "did you mean --json?"),
        (["play", "a.mp4", "--markersize=0.1"], "did you mean --marker-size?"),
        (["estimate", "a.jpg", "--quality", "acurate"], "did you mean accurate?"),
        (["estimate", "a.jpg", "--repeat", "1e9"], "from 1 to 1000000000"),
        (["play"], "FILE"),
        (["play", "a.mp4", "--wings"], "--wings (see ashe-live play --help)"),
        (["play", "a.mp4", "b.mp4"], "unrecognized arguments: b.mp4"),
        (["estimate", "a.jpg", "--json", "b.jpg", "--wings"], "--wings"),
        (["estimate", "a.jpg", "--json", ""], "argument FILE"),
        (["play", "a.mp4", "--frames", "0"], "--frames"),
        (["play", "a.mp4", "--frames", "many"], "'many' is not a whole number"),
        (["play", "a.mp4", "--estimate-at", "-1"], "--estimate-at"),
        (["play", "a.mp4", "--size", "640"], "1280x720"),
        (["play", "a.mp4", "--quality", "best"], "best"),
        (["play", "a.mp4", "--hfov", "180"], "--hfov"),
        (["play", "a.mp4", "--hfov", "wide"], "'wide' is not a number"),
        (["play", "a.mp4", "--focal-px", "inf"], "--focal-px"),
        (["play", "a.mp4", "--focal-px", "nan"], "--focal-px"),
        (["play", "a.mp4", "--focal-px", "500", "--hfov", "60"], "not allowed with"),
        (["play", "a.mp4", "--hfov", "0.001"], "--hfov"),
        (["play", ""], "names no file"),
        (["play", "a.mp4", "--out", ""], "argument --out: it is empty"),
        (["play", "a.mp4", "--model", ""], "it is empty and names no model"),
        (["webcam", "--camera", ""], "it is empty and names no camera"),
        (["marker", "--out", ""], "argument --out: it is empty"),
        (["estimate", "a.jpg", "--debug", ""], "argument --debug: it is empty"),
        (["bench", "light", "--scenes", ""], "argument --scenes: it is empty"),
        (["estimate"], "FILE"),
        (["estimate", "a.jpg", ""], "names no file"),
        (["estimate", "a.jpg", "--marker-size", "0"], "--marker-size"),
        (["estimate", "a.jpg", "--repeat", "0"], "--repeat"),
        (["estimate", "a.jpg", "--estimator", "oracle"], "paper"),
        (["estimate", "a.jpg", "--marker", "qr:7"], "aruco:4x4_50:0"),
        (["estimate", "a.jpg", "--camera-file", "missing.json"], "missing.json"),
        (["marker"], "--out"),
        (["bench"], "WHAT"),
    ],
    ids=" ".join,
)
def test_wrong_use_is_one_line_and_status_2(run, arguments, said):
    outcome = run(*arguments)
    assert outcome.status == 2
    assert outcome.out == []
    lines = [line for line in outcome.err if "assumed" not in line]
    assert len(lines) == 1
    assert lines[0].startswith("ashe-live: ")
    assert said in lines[0]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(run, command):
    outcome = run(command, "--help")
    assert outcome.status == 0
    assert f"ashe-live {command}" in outcome.out[0]
    assert max(map(len, outcome.out)) <= 120


def test_help_and_version(run):
    outcome = run("--help")
    assert outcome.status == 0
    assert all(any(command in line for line in outcome.out) for command in COMMANDS)
    assert run("--version").out[0].startswith("ashe-live ")


def test_files_may_stand_before_and_after_flags() -> None:
    options = parsed(["estimate", "a.jpg", "b.jpg", "--hfov", "60", "c.jpg", "--json"])
    assert [str(file) for file in options.files] == ["a.jpg", "b.jpg", "c.jpg"]
    assert (options.hfov, options.json) == (60.0, True)


def test_the_qualities_that_are_offered_are_those_there_are() -> None:
    """The parser has names of its own, so that --help need not load what has the presets."""
    assert tuple(quality.QUALITIES) == option_groups.QUALITIES
