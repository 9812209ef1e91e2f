"""`ashe-live` alone: the camera, or the demo where there is none."""

import pytest

from ashe_live.capture.cameras import Device
from ashe_live.commands import demo, start, webcam
from ashe_live.commands.flags.parser import START
from ashe_live.commands.flags.settings_file import settings_path


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, str | None, str]]:
    """What was started instead of a window: command, camera and model."""
    started = []
    for module in (demo, webcam):
        name = module.__name__.rpartition(".")[2]
        monkeypatch.setattr(
            module, "run", lambda options, name=name: started.append((name, options.camera, *options.model)) or 0
        )
    return started


def connect(monkeypatch: pytest.MonkeyPatch, *numbers: int) -> None:
    monkeypatch.setattr(start, "connected", lambda: [Device(number, "a camera", None) for number in numbers])


def test_the_first_camera_there_is(run, started, monkeypatch):
    connect(monkeypatch, 2, 3)
    assert run().status == run("--model", "mug").status == 0
    assert started == [("webcam", "2", "cube"), ("webcam", "2", "mug")]


def test_without_a_camera_one_line_and_the_demo(run, started, monkeypatch):
    connect(monkeypatch)
    outcome = run("--model", "mug")
    assert started == [("demo", None, "mug")]
    assert (outcome.status, len(outcome.err)) == (0, 1)
    assert "no camera" in outcome.err[0]


def test_the_demo_says_which_flags_it_makes_no_use_of(run, started, monkeypatch):
    connect(monkeypatch)
    used = ("--model", "mug", "--light", "sun")
    own = ("--marker", "aruco:4x4_50:7", "--marker-size", "0.1", "--caster", "sphere:0.02", "--hfov", "70")
    (line,) = run(*used, *own).err
    assert [flag for flag in (*used, *own) if flag.startswith("--") and flag in line.split("no use of ")[1]] == [
        flag for flag in own if flag.startswith("--")
    ]
    assert not any("no use of" in line for line in run(*used).err)
    assert started == 2 * [("demo", None, "mug")]


def test_settings_for_a_table_of_ones_own_are_not_called_flags(run, started, monkeypatch, tmp_path):
    connect(monkeypatch)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    settings_path().parent.mkdir(parents=True, exist_ok=True)
    settings_path().write_text('marker = "aruco:4x4_50:7"\nmarker-size = 0.1\n')
    (line,) = run("--marker-size", "0.2").err
    assert line.endswith("it makes no use of --marker-size")
    assert started == [("demo", None, "cube")]


def test_a_camera_that_is_asked_for_is_not_replaced(run, started, monkeypatch):
    connect(monkeypatch)
    run("--camera", "7")
    assert started == [("webcam", "7", "cube")]


def test_the_demo_takes_the_options_of_the_start(run, instant, monkeypatch, tmp_path):  # noqa: ARG001
    connect(monkeypatch)
    report = tmp_path / "report.json"
    flags = ("--headless", "--frames", "3", "--quality", "fast", "--no-hide-marker")
    outcome = run(*flags, "--out", tmp_path / "o.mp4", "--report", report)
    assert outcome.status == 0
    assert report.exists()


def test_help_is_the_programs_or_the_options_of_the_start(run):
    assert "COMMAND" in run("--help").out[0]
    assert any("--camera" in line for line in run("--model", "mug", "--help").out)
    assert not any(START in line.split() for line in run("--help").out)
    assert START not in "".join(run("nosuch").err)
