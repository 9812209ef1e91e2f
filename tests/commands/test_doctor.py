"""`ashe-live doctor`: one line a check, whatever is broken; status 0 exactly when the demo can run."""

import os
import platform
import re
import sys
import tempfile
import tomllib

import pytest

from ashe_live.capture import cameras
from ashe_live.capture.cameras import Device
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.commands import doctor
from ashe_live.commands.flags.settings_file import settings_path
from ashe_live.errors import UserError
from ashe_live.files.resources import resource
from tests.checkout import CHECKOUT


@pytest.fixture
def no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


def broken() -> str:
    raise UserError("it is broken", "mend it")


def failing() -> str:
    raise RuntimeError("two\nlines")


@pytest.mark.usefixtures("no_display")
def test_every_check_has_its_line_and_the_demo_can_run_without_a_display(run):
    outcome = run("doctor")
    assert outcome.status == 0, outcome.out
    assert len(outcome.out) == len(doctor.CHECKS) + 1
    lines = dict(zip(doctor.CHECKS, outcome.out, strict=False))
    assert all(name in line for name, line in lines.items())
    for name in ("versions", "packages", "files", "offscreen pictures", "H.264 video"):
        assert lines[name].startswith("works")
    for name in ("display", "window"):
        assert lines[name].startswith("does not work")
    said = {line.partition(name)[2].strip() for name, line in lines.items()}
    assert len(said) == len(lines), "what helps is said once"
    assert outcome.out[-1] == "The demo can run: ashe-live demo"


@pytest.mark.parametrize("name", ["packages", "files", "offscreen pictures", "H.264 video"])
@pytest.mark.parametrize("check", [broken, failing])
def test_what_the_demo_needs_decides_the_status(run, monkeypatch, name, check):
    well = dict.fromkeys(doctor.CHECKS, lambda: "well")
    monkeypatch.setattr(doctor, "CHECKS", {**well, "display": broken, "window": broken, "camera": broken})
    assert run("doctor").status == 0
    monkeypatch.setitem(doctor.CHECKS, name, check)
    outcome = run("doctor")
    assert outcome.status == 2
    assert len(outcome.out) == len(doctor.CHECKS) + 1
    assert name in outcome.out[-1]


def test_with_a_display_the_window_decides(run, monkeypatch):
    monkeypatch.setattr(doctor, "CHECKS", {**dict.fromkeys(doctor.CHECKS, lambda: "well"), "H.264 video": broken})
    assert run("doctor").status == 0
    monkeypatch.setitem(doctor.CHECKS, "window", broken)
    assert run("doctor").status == 2


@pytest.mark.usefixtures("no_display")
def test_a_probe_answers_from_its_own_process():
    assert doctor.isolated_probe(doctor.offscreen_probe).startswith("OpenGL")
    with pytest.raises(UserError, match="there is none") as caught:
        doctor.isolated_probe(doctor._display)
    assert "ssh" in caught.value.remedy


@pytest.mark.parametrize("death", [failing, os.abort])
def test_a_probe_that_dies_is_reported_with_a_remedy(death):
    with pytest.raises(UserError, match="trying OpenGL failed") as caught:
        doctor.isolated_probe(death)
    assert "driver" in caught.value.remedy


def test_what_is_there_is_said_by_name_and_place():
    assert [each.split()[0] for each in doctor.CHECKS["packages"]().split(", ")] == list(doctor.PACKAGES)
    assert doctor.CHECKS["files"]() == str(resource("assets"))


def test_a_fault_without_words_is_named_by_its_kind(run, monkeypatch):
    def silent():
        raise ZeroDivisionError

    monkeypatch.setattr(doctor, "CHECKS", {**dict.fromkeys(doctor.CHECKS, lambda: "well"), "camera": silent})
    (line,) = (line for line in run("doctor").out if " camera " in line)
    assert line.endswith(" ZeroDivisionError: install ashe-live again, or report this")


def test_a_window_is_tried_where_there_is_a_display(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(doctor, "isolated_probe", lambda probe: f"tried {probe.__name__}")
    assert doctor.CHECKS["window"]() == "tried window_probe"


def test_a_package_that_is_missing_is_named_with_how_to_install_it(monkeypatch):
    monkeypatch.setattr(doctor, "PACKAGES", ("numpy", "ashe-live-never-made"))
    with pytest.raises(UserError, match="ashe-live-never-made is not installed") as caught:
        doctor.CHECKS["packages"]()
    assert caught.value.remedy == f"{sys.executable} -m pip install ashe-live-never-made"


@pytest.mark.parametrize("missing", ["shaders", "models", "table.mp4"])
def test_an_installation_without_its_files_is_said_to_be_made_again(monkeypatch, missing):
    def found(*parts):
        if parts[-1] == missing:
            raise FileNotFoundError(f"{'/'.join(parts)} is nowhere")
        return resource(*parts)

    monkeypatch.setattr(doctor, "resource", found)
    with pytest.raises(UserError, match=f"{missing} is nowhere: install ashe-live again"):
        doctor.CHECKS["files"]()


def test_a_recording_that_cannot_be_read_again_is_a_finding_and_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert doctor.CHECKS["H.264 video"]() == "recorded and read again"
    monkeypatch.setattr(ClipSource, "read", lambda _clip: None)
    with pytest.raises(UserError, match="cannot be read"):
        doctor.CHECKS["H.264 video"]()
    assert list(tmp_path.iterdir()) == []


def test_cameras_are_listed_as_the_flag_takes_them(monkeypatch):
    monkeypatch.setattr(cameras, "connected", lambda: [Device(0, "Laptop", None), Device(2, "C920", "/dev/video2")])
    assert doctor.CHECKS["camera"]() == "0: Laptop, 2: C920"
    monkeypatch.setattr(cameras, "connected", list)
    with pytest.raises(UserError, match="none is connected"):
        doctor.CHECKS["camera"]()


@pytest.mark.parametrize(("renderer", "is_slow"), [("llvmpipe (LLVM 15.0.6, 256 bits)", True), ("GeForce RTX", False)])
def test_who_draws_is_said_and_that_it_is_slow(renderer, is_slow):
    said = doctor._described({"GL_VERSION": "4.5", "GL_RENDERER": renderer})
    assert said.startswith(f"OpenGL 4.5, {renderer}")
    assert ("--quality fast" in said) == is_slow


def test_a_display_that_there_is_works(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    assert doctor.CHECKS["display"]() == "there is one"


def test_settings_are_said_to_be_there_or_not(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert doctor.CHECKS["settings"]() == f"{settings_path()} (not there, defaults hold)"
    settings_path().parent.mkdir()
    settings_path().write_text("hfov = 60")
    assert doctor.CHECKS["settings"]() == str(settings_path())


def test_broken_settings_are_a_finding_and_no_end(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    settings_path().parent.mkdir()
    settings_path().write_text("hfov = 200")
    with pytest.raises(UserError, match="hfov: '200'"):
        doctor.CHECKS["settings"]()


def test_what_is_checked_is_what_the_package_asks_for(monkeypatch):
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    assert {re.match(r"[\w-]+", each)[0] for each in project["dependencies"]} == set(doctor.PACKAGES)
    lowest, beyond = (int(minor) for minor in re.findall(r"3\.(\d+)", project["requires-python"]))
    for minor in range(lowest - 1, beyond + 1):
        monkeypatch.setattr(sys, "version_info", (3, minor, 0, "final", 0))
        monkeypatch.setattr(platform, "python_version", lambda minor=minor: f"3.{minor}.0")
        if lowest <= minor < beyond:
            assert "Python" in doctor.CHECKS["versions"]()
        else:
            with pytest.raises(UserError, match="is not supported"):
                doctor.CHECKS["versions"]()
