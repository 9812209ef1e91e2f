"""What the code respects of systems that the tests do not run on (docs/reliability.md lists them as untested)."""

import re
import subprocess
import sys
from datetime import datetime
from pathlib import Path, PureWindowsPath

from ashe_live.files.new_file import partial_path
from ashe_live.files.writing import unused_name
from tests.checkout import CHECKOUT

SOURCES = {path: path.read_text(encoding="utf-8") for path in (CHECKOUT / "ashe_live").rglob("*.py")}

# Windows has none of these modules and names. The libraries come first: each has its own ways for every system.
LOAD_ALL_WITHOUT_UNIX = """
import importlib, os, pkgutil, signal, sys, time
import multiprocessing, subprocess, tempfile
import av, cv2, cv2_enumerate_cameras, glfw, moderngl, numpy, PIL.Image, platformdirs, rich.console
for name in ("resource", "fcntl", "pwd", "grp", "termios"):
    sys.modules[name] = None
for module, name in ((os, "nice"), (os, "sched_getaffinity"), (os, "getloadavg"), (signal, "SIGHUP")):
    delattr(module, name)
package = importlib.import_module("ashe_live")
for module in pkgutil.walk_packages(package.__path__, "ashe_live."):
    if module.name != "ashe_live.__main__":
        importlib.import_module(module.name)
"""


def test_every_module_loads_where_unixs_own_are_missing() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOAD_ALL_WITHOUT_UNIX], capture_output=True, text=True, cwd=CHECKOUT, check=False
    )
    assert done.returncode == 0, done.stderr


def test_names_of_files_are_allowed_on_every_system(tmp_path: Path) -> None:
    path = unused_name(tmp_path, "ashe-live", ".mp4", datetime(2026, 11, 21, 14, 3, 12))
    for each in (path, partial_path(path)):
        assert not set(each.name) & set('<>:"/\\|?*')
        assert PureWindowsPath(each.name).name == each.name


def test_processes_are_spawned_and_never_forked() -> None:
    """A fork inherits half-held locks and the window's OpenGL; macOS and Windows do not have it."""
    for path, source in SOURCES.items():
        assert "os.fork" not in source, path
        assert set(re.findall(r'get_context\("(\w+)"\)', source)) <= {"spawn"}, path
        assert not re.search(r"multiprocessing\.(Process|Pool|Queue)\b", source), path


def test_windows_are_glfws_alone_and_none_of_its_calls_is_for_one_system_only() -> None:
    users = {path.relative_to(CHECKOUT).as_posix() for path, source in SOURCES.items() if "import glfw" in source}
    assert users
    assert all(user.startswith("ashe_live/viewer/") or user == "ashe_live/commands/doctor.py" for user in users)
    for path, source in SOURCES.items():
        assert not re.search(r"glfw\.\w*(x11|wayland|win32|cocoa|glx)", source, re.IGNORECASE), path
