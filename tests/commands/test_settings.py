"""Settings: as flags given first; flags win; what is wrong names the file; `ashe-live settings` shows what holds."""

import argparse
import tomllib
from pathlib import Path

import pytest

from ashe_live.commands.flags.options import parsed
from ashe_live.commands.flags.parser import build_parser, build_start_parser
from ashe_live.commands.flags.settings_file import COMMANDS, SETTINGS, settings_path
from tests.checkout import CHECKOUT


@pytest.fixture
def settle(tmp_path, monkeypatch: pytest.MonkeyPatch):
    """Writes the settings file of this test, and returns its path."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))

    def settle(content: str) -> Path:
        settings_path().parent.mkdir(exist_ok=True)
        settings_path().write_text(content)
        return settings_path()

    return settle


def test_a_setting_holds_until_a_flag_says_otherwise(settle):
    settle('quality = "fast"\nhfov = 70\nmodel = "mug"\nsize = "320x240"\ncamera = 2\nlight = "sun"\n')
    for arguments in (["webcam"], ["play", "a.mp4"]):
        options = parsed(arguments)
        assert (options.quality, options.hfov, options.model, options.size) == ("fast", 70.0, ("mug",), (320, 240))
    assert parsed(["webcam"]).camera == "2"
    assert parsed(["webcam", "--camera", "1"]).camera == "1"
    assert parsed(["play", "a.mp4", "--quality", "accurate"]).quality == "accurate"
    assert parsed(["play", "a.mp4", "--model", "tree"]).model == ("tree",), "not one more beside that of the settings"
    assert parsed(["estimate", "a.jpg"]).light == "sun"
    assert parsed(["estimate", "a.jpg", "--light", "lamp"]).light == "lamp"
    assert parsed(["estimate", "a.jpg"]).hfov == 70


SAME = {"camera-file": '"webcam.json"', "focal-px": "615", "hfov": "50"}  # what a camera sees, in several ways


@pytest.mark.parametrize("flag", SAME)
@pytest.mark.parametrize("key", SAME)
def test_a_flag_replaces_a_setting_that_says_the_same_in_another_way(settle, key, flag):
    settle(f"{key} = {SAME[key]}\n")
    options = vars(parsed(["webcam", f"--{flag}", "70"]))
    assert [each for each in SAME if options[each.replace("-", "_")] is not None] == [flag]
    assert str(options[flag.replace("-", "_")]) in ("70", "70.0")


def test_a_camera_file_is_beside_the_settings(settle):
    settle('camera-file = "webcam.json"\n')
    assert parsed(["webcam"]).camera_file == settings_path().parent / "webcam.json"


def test_a_setting_holds_for_every_command_that_has_its_flag():
    """Of those that show or estimate: what is printed, or measured, is not what is played."""
    of_commands = next(each for each in build_parser()._actions if isinstance(each, argparse._SubParsersAction))
    parsers = {**of_commands.choices, "start": build_start_parser()}
    for command in COMMANDS:
        flags = parsers[command]._option_string_actions
        assert {key for key in SETTINGS if command in SETTINGS[key].commands} == {
            key for key in SETTINGS if f"--{key}" in flags
        }


def test_the_demo_keeps_its_own_camera_and_the_bench_has_no_settings(settle):
    settle('hfov = 70\nquality = "accurate"\n')
    assert parsed(["demo"]).hfov is None
    assert parsed(["demo"]).quality == "accurate"
    assert parsed(["bench", "viewer"]).quality == "fast"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("hfov = 200", "hfov: '200'"),
        ('quality = "best"', "best"),
        ('light = "moon"', "moon"),
        ("hfow = 60", "did you mean hfov?"),
    ],
)
def test_a_value_that_its_flag_refuses_is_one_line_that_names_the_file(run, settle, content, said):
    path = settle(content)
    line = run("play", "a.mp4").refusal
    assert said in line
    assert str(path) in line
    assert run("play", "--help").status == 0
    assert run("bench", "--help").status == 0


@pytest.mark.parametrize("content", ['model = "xyzzy"', 'marker = "nope:1"', 'camera-file = "gone.json"'])
def test_a_value_that_turns_out_to_be_wrong_names_the_file_as_well(run, settle, content):
    path, clip = settle(content), str(CHECKOUT / "assets" / "clips" / "table.mp4")
    assert str(path) in run("play", clip, "--headless").refusal


def test_a_flag_that_is_wrong_is_not_the_files_fault(run, settle):
    path = settle('estimator = "prox"')
    assert str(path) not in run("play", "a.mp4", "--estimator", "proxyy", "--headless").refusal


def test_the_output_of_settings_is_a_settings_file_with_the_values_that_hold(run, settle):
    path = settle('quality = "fast"\nmarker-size = 0.1\nmodel = "a \\"mug\\".glb"\n')
    outcome = run("settings")
    assert outcome.status == 0
    assert str(path) in outcome.out[0]
    shown = tomllib.loads("\n".join(outcome.out))
    assert shown["quality"] == "fast"
    assert shown["marker-size"] == 0.1
    assert shown["model"] == 'a "mug".glb'
    assert set(shown) <= set(SETTINGS)
    assert all(any(key in line for line in outcome.out) for key in SETTINGS)
    settle("\n".join(outcome.out))
    assert tomllib.loads("\n".join(run("settings").out)) == shown


def test_without_a_file_the_defaults_hold(run, settle):  # noqa: ARG001 - an empty folder
    outcome = run("settings")
    assert outcome.status == 0
    assert "not there" in outcome.out[0]
    assert tomllib.loads("\n".join(outcome.out))["quality"] == "balanced"


@pytest.mark.parametrize("arguments", [[], ["demo"], ["webcam"], ["play", "a.mp4"], ["estimate", "a.jpg"]], ids=str)
def test_a_file_that_begins_as_the_defaults_changes_nothing(run, settle, arguments):
    """Above all, it names no marker, as the one in view would no longer be followed, and no camera: without a command
    the first one that is connected is opened, or the demo.
    """
    before = vars(parsed(arguments))
    settle("\n".join(run("settings").out))
    assert vars(parsed(arguments)) | {"from_settings": {}} == before


@pytest.mark.parametrize("key", SETTINGS)
def test_a_value_of_another_kind_is_refused_with_one_that_will_do(run, settle, key):
    settle(f"{key} = true")
    (line,) = run("play", "a.mp4").err
    settle(line.partition("write it like this: ")[2])
    parsed(["webcam"])


def test_the_page_names_every_key_and_its_example_holds(settle):
    page = (CHECKOUT / "docs" / "settings.md").read_text(encoding="utf-8")
    assert all(f"`{key}`" in page for key in SETTINGS)
    settle(page.split("```toml\n")[1].split("```")[0])
    assert parsed(["webcam"]).marker_size == 0.1
