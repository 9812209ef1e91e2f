"""`ashe-live doctor`: what works on this machine, how to mend what does not, and whether the demo can run.

Every check tries the thing itself. Heavy packages are imported by their own checks only, as one may be what is broken.
"""

import argparse
import os
import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from ashe_live import __version__
from ashe_live.commands.flags.options import parsed
from ashe_live.commands.flags.settings_file import settings_path
from ashe_live.errors import ExitStatus, UserError
from ashe_live.files.kept import NOWHERE
from ashe_live.files.resources import resource
from ashe_live.process.children import Limits
from ashe_live.process.isolated import NoAnswerError, isolated_call
from ashe_live.process.messages import print_answer, printable
from ashe_live.process.temporary import temporary_folder
from ashe_live.render.gl.driver import is_software

PACKAGES = (
    *("numpy", "opencv-contrib-python-headless", "moderngl", "glfw", "av", "pillow", "pyrr", "rich"),
    *("dracopy", "mapbox-earcut", "pi-heif", "cv2-enumerate-cameras", "platformdirs"),
)
PROBE_S = 30.0  # a driver that takes longer will not give a picture


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of one check."""

    name: str
    works: bool
    said: str


def run(_options: argparse.Namespace) -> int:
    findings = {}
    for name, check in CHECKS.items():
        finding = findings[name] = _tried(name, check)
        print_answer(f"{'works' if finding.works else 'does not work':<14} {name:<19} {finding.said}")
    missing = [name for name in needed_for_demo(findings["display"].works) if not findings[name].works]
    if missing:
        print_answer(f"The demo cannot run: mend {', '.join(missing)}.")
        return ExitStatus.WRONG_USE
    print_answer("The demo can run: ashe-live demo")
    return ExitStatus.ANSWERED


def needed_for_demo(has_display: bool) -> tuple[str, ...]:
    """The checks that must succeed: for the demo in a window, or without a display as a video."""
    return "packages", "files", *(("window",) if has_display else ("offscreen pictures", "H.264 video"))


def _tried(name: str, check: Callable[[], str]) -> Finding:
    try:
        return Finding(name, True, check())
    except UserError as error:
        return Finding(name, False, printable(error))
    except Exception as error:  # whatever is broken, the other checks go on
        reason = printable(error) or type(error).__name__
        return Finding(name, False, f"{reason}: install ashe-live again, or report this")


def _versions() -> str:
    if not (3, 11) <= sys.version_info[:2] <= (3, 14):
        raise UserError(f"Python {platform.python_version()} is not supported", "use Python 3.11 to 3.14")
    return f"ashe-live {__version__}, Python {platform.python_version()}, {platform.platform()}"


def _packages() -> str:
    found = []
    for package in PACKAGES:
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            raise UserError(f"{package} is not installed", f"{sys.executable} -m pip install {package}") from None
    return ", ".join(found)


def _files() -> str:
    try:
        for parts in (("shaders",), ("assets", "models"), ("assets", "clips", "table.mp4")):
            resource(*parts)
    except FileNotFoundError as error:
        raise UserError(str(error), "install ashe-live again") from None
    return str(resource("assets"))


def _display() -> str:
    from ashe_live.commands.viewing.setup import has_display

    if not has_display():
        raise UserError("there is none", "without it the demo writes a video; over ssh, try ssh -X")
    return "there is one"


def _window() -> str:
    from ashe_live.commands.viewing.setup import has_display

    if not has_display():
        raise UserError("it needs a display", "see the line above")
    return isolated_probe(window_probe)


def window_probe() -> str:
    """Opens a window for a moment. Raises UserError when that fails."""
    from ashe_live.viewer.windows.glfw_window import GlfwWindow

    with GlfwWindow("ashe-live doctor", (320, 240)) as window:
        return _described(window.context.info)


def offscreen_probe() -> str:
    """Draws without a window. Raises UserError when there is no OpenGL 3.3 for that."""
    from ashe_live.render.gl.offscreen import offscreen_context

    return _described(offscreen_context().info)


def _described(info: dict[str, str]) -> str:
    slow = " (no GPU is used: --quality fast helps)" if is_software(info) else ""
    return f"OpenGL {info['GL_VERSION']}, {info['GL_RENDERER']}{slow}"


def isolated_probe(probe: Callable[[], str]) -> str:
    """What a function of this module returns, called in a process of its own, which a broken driver may crash.

    Raises the UserError that the function raised, or one about the process's end.
    """
    remedy = "install or update the graphics driver (Debian, Ubuntu: apt-get install libgl1 libegl1 libgl1-mesa-dri)"
    try:
        return isolated_call(probe, (), "ashe-live doctor", Limits(niceness=0, silent=True), PROBE_S)
    except NoAnswerError as failure:
        raise UserError(f"trying OpenGL failed ({failure})", remedy) from None


def _video() -> str:
    import numpy as np

    from ashe_live.capture.clips.clip import ClipSource
    from ashe_live.capture.recording.recorder import Recorder

    with temporary_folder() as folder:
        path = folder / "doctor.mp4"
        with Recorder(path, (64, 48), 30.0) as recorder:
            for index in range(3):
                recorder.write(np.full((48, 64, 3), 80 * index, np.uint8), index / 30)
        with ClipSource(path) as clip:
            if clip.read() is None:
                raise UserError("what was recorded cannot be read", "pip install --force-reinstall av")
    return "recorded and read again"


def _cameras() -> str:
    from ashe_live.capture.cameras import connected

    devices = connected()
    if not devices:
        raise UserError("none is connected", "plug one in; on Linux, be in the group video; clips and photos need none")
    return ", ".join(f"{device.number}: {device.name}" for device in devices)


def _settings() -> str:
    parsed(["webcam"])
    path = settings_path()
    if path.parent == NOWHERE:
        return "none, as HOME or XDG_CONFIG_HOME names no folder (defaults hold)"
    return str(path) if os.path.lexists(path) else f"{path} (not there, defaults hold)"


CHECKS: dict[str, Callable[[], str]] = {
    "versions": _versions,
    "packages": _packages,
    "files": _files,
    "display": _display,
    "window": _window,
    "offscreen pictures": lambda: isolated_probe(offscreen_probe),
    "H.264 video": _video,
    "camera": _cameras,
    "settings": _settings,
}
