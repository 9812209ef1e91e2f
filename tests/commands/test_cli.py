"""Wrong use: one line that says what and where to read on, and status 2."""

import argparse
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from ashe_live import __version__, quality
from ashe_live.commands.flags import command_parser, option_groups, values
from ashe_live.commands.flags.options import parsed
from ashe_live.commands.flags.parser import build_parser, build_start_parser
from ashe_live.models import catalogue, loading

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
        (["films/a.mp4"], "looks like a file: ashe-live play FILE shows it"),
        (["a.jpg", "--quality", "fast"], "looks like a file: ashe-live play FILE shows it"),
        (["models/mug.GLB"], "looks like a file: ashe-live demo --model FILE shows it"),
        (["estimate", "a.jpg", "--jsn"], "did you mean --json?"),
        (["play", "a.mp4", "--markersize=0.1"], "did you mean --marker-size?"),
        (["estimate", "a.jpg", "--quality", "acurate"], "did you mean accurate?"),
        (["estimate", "a.jpg", "--repeat", "1e9"], "from 1 to 1000000000"),
        (["estimate", "a.jpg", "--views", "1" + 400 * "0"], "is not a whole number from 1 to 12"),
        (["play"], "FILE"),
        (["play", "a.mp4", "--wings"], "--wings (see ashe-live play --help)"),
        (["play", "a.jpg", "b.jpg", "c.jpg"], "one FILE is shown, and 3 are given: ashe-live estimate takes several"),
        (["webcam", "1"], "unrecognized arguments: 1: did you mean --camera 1?"),
        (["play", "a.mp4", "mug.glb"], "did you mean --model mug.glb?"),
        (["marker", "--out", "m.pdf", "--id", "5"], "unrecognized arguments: --id 5 (see ashe-live marker --help)"),
        (["play", "a.mp4", "--", "--headles"], "unrecognized arguments: --headles (see ashe-live play --help)"),
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
        (["estimate", "a.jpg", "--marker-size", "80"], "to 10 m: for 80 mm write 0.08"),
        (["marker"], "--out"),
        (["marker", "--out", "a.pdf", "--marker", "cube+"], "there is no marker ''"),
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


@pytest.mark.parametrize("arguments", [["play"], ["estimate", "a.jpg"], ["play", "--headless", "--out", "b.png"]])
def test_of_a_file_whose_name_begins_as_a_flag_it_is_said_how_to_name_it(run, arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = run(*arguments, "-1.jpg")
    assert outcome.status == 2
    assert "for the file" not in outcome.err[0]
    Path("-1.jpg").write_bytes(b"x")
    outcome = run(*arguments, "-1.jpg")
    assert outcome.status == 2
    assert outcome.err[0].endswith(f": for the file -1.jpg give .{os.sep}-1.jpg (see ashe-live {arguments[0]} --help)")


def test_a_file_that_is_called_as_a_flag_is_leaves_it_one(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("--headless").write_bytes(b"x")
    assert "for the file" not in run("play", "--headless", "--out", "b.png").err[0]


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
    outcome = run("--version")
    assert (outcome.status, outcome.out, outcome.err) == (0, [f"ashe-live {__version__}"], [])


def test_files_may_stand_before_and_after_flags() -> None:
    options = parsed(["estimate", "a.jpg", "b.jpg", "--hfov", "60", "c.jpg", "--json"])
    assert [str(file) for file in options.files] == ["a.jpg", "b.jpg", "c.jpg"]
    assert (options.hfov, options.json) == (60.0, True)


def test_behind_two_dashes_every_word_is_a_file() -> None:
    options = parsed(["estimate", "a.jpg", "--json", "--", "b.jpg", "-c.jpg", "--jsn", "--"])
    assert [str(file) for file in options.files] == ["a.jpg", "b.jpg", "-c.jpg", "--jsn", "--"]
    assert options.json


def test_the_qualities_that_are_offered_are_those_there_are() -> None:
    """The parser has names of its own, so that --help need not load what has the presets."""
    assert tuple(quality.QUALITIES) == option_groups.QUALITIES


def test_the_models_that_the_parser_knows_are_those_there_are() -> None:
    assert command_parser.MODEL_SUFFIXES == loading.SUFFIXES
    assert catalogue.model_names() == option_groups.SHIPPED_MODELS


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """The parser itself, and those of its commands."""
    yield parser
    for action in parser._actions:
        for each in dict(action.choices).values() if isinstance(action, argparse._SubParsersAction) else ():
            yield from parsers(each)


OFFERED = [
    (parser, action)
    for parser in (*parsers(build_parser()), build_start_parser())
    for action in parser._actions
    if not isinstance(action, argparse._SubParsersAction)
]
TAKING_VALUES = [(parser, action) for parser, action in OFFERED if action.option_strings and action.nargs != 0]
NUMBERS = (
    values.side_m,
    values.millimetres,
    values.focal_px,
    values.angle_deg,
    values.count,
    values.index,
    values.views,
)


def named(part: object) -> str | None:
    """The command or the option, for a test's name."""
    if isinstance(part, argparse.Action):
        return part.option_strings[0] if part.option_strings else part.dest
    return part.prog if isinstance(part, argparse.ArgumentParser) else None


@pytest.mark.parametrize(("parser", "action"), OFFERED, ids=named)
def test_help_says_what_a_command_does_and_of_every_option_what_it_is_and_its_default(
    parser: argparse.ArgumentParser, action: argparse.Action
) -> None:
    assert parser.description or parser.prog == build_start_parser().prog  # whose help is the program's
    assert action.help
    default = action.default
    if default is not argparse.SUPPRESS and isinstance(default, str | int | float | tuple) and default:
        assert "default" in action.help


@pytest.mark.parametrize(("parser", "action"), TAKING_VALUES, ids=named)
def test_no_option_takes_what_is_no_value(
    parser: argparse.ArgumentParser, action: argparse.Action, capsys: pytest.CaptureFixture[str]
) -> None:
    flag = action.option_strings[0]
    wrong = ["--", *(("", "nan", "inf", "-1e308", "6cm", "1,5") if action.type in NUMBERS else ())]
    for value in wrong:
        with pytest.raises(SystemExit) as ended:
            parser.parse_args([f"{flag}={value}"])
        assert ended.value.code == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert f"argument {flag}" in line
        assert f"{parser.prog} --help" in line
