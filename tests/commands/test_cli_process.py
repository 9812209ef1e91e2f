"""The process around a command: standard streams in any state, and what lies in the current folder."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.e2e.signals import ignore_none

ASHE_LIVE = Path(sys.executable).with_name("ashe-live")
ANSWERS = [["--help"], ["settings"], ["estimate", "gone.jpg", "--json"]]


def run_in_shell(line: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """`line` in bash, where $A is ashe-live."""
    variables = {**os.environ, "A": str(ASHE_LIVE), "HOME": str(folder), **environment}
    return subprocess.run(
        ["bash", "-c", line],
        cwd=folder,
        env=variables,
        capture_output=True,
        text=True,
        errors="surrogateescape",
        preexec_fn=ignore_none,
    )


@pytest.mark.parametrize("command", ANSWERS, ids=" ".join)
def test_a_reader_that_leaves_is_no_error(command: list[str], tmp_path: Path) -> None:
    done = run_in_shell(f"$A {' '.join(command)} | true; exit ${{PIPESTATUS[0]}}", tmp_path)
    # Whether the reader has gone before the first line or after the last is chance.
    assert done.returncode in ((0, 2) if "gone.jpg" in command else (0,))
    assert done.stderr == ""


def test_without_a_reader_what_else_was_asked_for_is_written(tmp_path: Path) -> None:
    done = run_in_shell("(exec $A estimate gone.jpg --sheet sheet.html) | true; exit ${PIPESTATUS[0]}", tmp_path)
    assert done.returncode == 2
    assert "gone.jpg" in (tmp_path / "sheet.html").read_text()


@pytest.mark.parametrize("command", ANSWERS, ids=" ".join)
def test_an_answer_that_cannot_be_written_is_an_error(command: list[str], tmp_path: Path) -> None:
    done = run_in_shell(f"$A {' '.join(command)} > /dev/full", tmp_path)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "standard output" in done.stderr


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&-", "<&- >&- 2>&-"])
def test_a_closed_stream_is_as_if_nobody_read_it(closed: str, tmp_path: Path) -> None:
    done = run_in_shell(f"$A marker --out marker.png {closed}", tmp_path)
    assert done.returncode == 0
    assert done.stderr == ""
    assert (tmp_path / "marker.png").read_bytes().startswith(b"\x89PNG")


def test_any_name_can_be_said_in_ascii(tmp_path: Path) -> None:
    line = r"""$A estimate $'b\xc3\xa4\xff\e[2Jd.jpg'"""
    done = run_in_shell(line, tmp_path, PYTHONIOENCODING="ascii", LC_ALL="C")
    assert done.returncode == 2
    assert done.stdout.isascii()
    assert "\x1b" not in done.stdout
    assert done.stdout.count("\n") == 1


@pytest.mark.parametrize("module", ["signal", "numpy"])
def test_ctrl_c_while_all_is_loaded_ends_at_once_and_in_silence(module: str, tmp_path: Path) -> None:
    """Interrupted where the program's first import begins, and where the first heavy one does."""
    (tmp_path / "sitecustomize.py").write_text(
        f"""
import _signal, sys  # `signal` itself would be loaded before the program loads it
class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "{module}":
            _signal.raise_signal(_signal.SIGINT)
sys.meta_path.insert(0, Interrupting())
"""
    )
    done = run_in_shell("$A play gone.mp4", tmp_path, PYTHONPATH=str(tmp_path))
    assert done.returncode == 128 + signal.SIGINT
    assert done.stdout + done.stderr == ""


def test_what_lies_in_the_current_folder_is_not_imported(tmp_path: Path) -> None:
    """Not by `python -m` either, which puts that folder first, once the program itself has begun."""
    canary = tmp_path / "canary"
    for name in ("platformdirs", "numpy", "rich", "argparse", "tomllib", "signal", "sysconfig", "pathlib"):
        (tmp_path / f"{name}.py").write_text(f"open({str(canary)!r}, 'a').write('{name} ')")
    for start in ("$A", f"{sys.executable} -m ashe_live"):
        assert run_in_shell(f"{start} estimate gone.jpg", tmp_path).returncode == 2
    assert not canary.exists(), canary.read_text()


@pytest.mark.parametrize("entry", ["", "."])
def test_nor_is_what_the_environment_looks_for_there(tmp_path: Path, entry: str) -> None:
    """An empty entry means that folder, as `export PYTHONPATH=$PYTHONPATH:/lib` makes one; nor in child processes."""
    canary = tmp_path / "canary"
    for name in ("platformdirs", "numpy", "argparse", "tomllib", "multiprocessing", "pickle", "signal", "ctypes"):
        (tmp_path / f"{name}.py").write_text(f"open({str(canary)!r}, 'a').write('{name} ')")
    for name in ("uname", "ldconfig", "gcc", "python"):
        (tmp_path / name).write_text(f"#!/bin/sh\necho {name} >> {canary}\n")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "dot.ppm").write_bytes(b"P6 1 1 255\n\0\0\0")
    folders = {name: f"{entry}:{os.environ.get(name, os.devnull)}" for name in ("PYTHONPATH", "PATH")}
    shown = run_in_shell("$A play dot.ppm --model triangle.obj --headless --hfov 60", tmp_path, **folders)
    assert shown.returncode == 3, shown.stderr  # a picture without a marker
    assert "Traceback" not in run_in_shell("$A doctor", tmp_path, **folders).stderr
    assert not canary.exists(), canary.read_text()


def test_warnings_that_are_errors_elsewhere_are_none_here(tmp_path: Path) -> None:
    """Nor in a child process, which reads the model: libraries, compiled for the first time, warn of their own code."""
    (tmp_path / "triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "dot.ppm").write_bytes(b"P6 1 1 255\n\0\0\0")
    command = "$A play dot.ppm --model triangle.obj --headless --hfov 60 --out shown.png"
    done = run_in_shell(command, tmp_path, PYTHONWARNINGS="error", PYTHONPYCACHEPREFIX=str(tmp_path / "compiled"))
    assert "Traceback" not in done.stderr
    assert done.returncode == 3  # a picture without a marker
    assert (tmp_path / "shown.png").exists()


def test_where_the_graphics_library_can_keep_nothing_it_says_nothing(tmp_path: Path) -> None:
    """As of a user without a home of his own, in a container: Mesa had a line of its own beside every answer."""
    (tmp_path / "dot.ppm").write_bytes(b"P6 1 1 255\n\0\0\0")
    command = "unset MESA_SHADER_CACHE_DIR; $A play dot.ppm --headless --hfov 60 --quality fast --out shown.png"
    done = run_in_shell(command, tmp_path, XDG_CACHE_HOME=str(tmp_path / "missing" / "cache"))
    assert done.returncode == 3  # a picture without a marker
    assert all(line.startswith("ashe-live: ") for line in done.stderr.splitlines()), done.stderr


@pytest.mark.parametrize("flags", ["-X dev", "-b", "-bb -W error"])
def test_python_s_own_flags_do_not_keep_it_from_starting_processes(flags: str, tmp_path: Path) -> None:
    """As of PYTHONDEVMODE, which is set for all of a person's Python programs."""
    (tmp_path / "model.obj").write_text("v 0 0 0\nf 1 1 1\n")
    done = run_in_shell(
        f'"$PYTHON" {flags} -m ashe_live estimate a.png --caster model.obj', tmp_path, PYTHON=sys.executable
    )
    assert done.returncode == 2
    assert "model.obj holds no triangle" in done.stderr
