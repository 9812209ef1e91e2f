"""A screen of our own (Xvfb), a hand on its keyboard (xdotool), and the viewer running on it."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import ImageGrab

from tests.checkout import CHECKOUT
from tests.e2e.signals import ignore_none
from tests.patience import PATIENCE_S, await_that

QUICK_VIEWER = Path(__file__).with_name("quick_viewer.py")
SCREEN = "1280x960x24"


class Screen:
    """An X display: what is seen on it, and keys pressed on it."""

    def __init__(self, display: str) -> None:
        self.display = display
        self.environment = {**os.environ, "DISPLAY": display}
        self.environment.pop("WAYLAND_DISPLAY", None)

    def xdotool(self, *arguments: str) -> str:
        return subprocess.run(
            ["xdotool", *arguments], env=self.environment, capture_output=True, text=True, timeout=PATIENCE_S
        ).stdout

    def picture(self) -> np.ndarray:
        """(h, w, 3) uint8 RGB of the whole screen."""
        return np.asarray(ImageGrab.grab(xdisplay=self.display).convert("RGB"))


class Running:
    """A viewer's process in a folder of its own, with its window on the screen."""

    def __init__(self, screen: Screen, folder: Path, arguments: tuple[str, ...], program: tuple[str, ...]) -> None:
        self.screen, self.folder = screen, folder
        self.window = ""  # its number, once it is there
        self._out = (folder / ".out").open("w+")
        self.process = subprocess.Popen(
            [sys.executable, *program, *arguments],
            cwd=folder,
            # What is remembered belongs to the folder, as no other test's viewer should stand a model there.
            env={**screen.environment, "PYTHONPATH": str(CHECKOUT), "XDG_CONFIG_HOME": str(folder / ".config")},
            stdout=self._out,
            stderr=subprocess.STDOUT,
            preexec_fn=ignore_none,
        )

    @property
    def output(self) -> str:
        return (self.folder / ".out").read_text()

    def await_window(self) -> None:
        """Until the window shows something, and has the keyboard."""

        def window() -> str:
            assert self.process.poll() is None, self.output
            return self.screen.xdotool("search", "--name", "^ashe-live")

        await_that(window, "a window")
        self.window = window().split()[0]
        await_that(lambda: self.picture()[::8, ::8].std() > 5, "a picture")  # a few of the pixels tell
        self.screen.xdotool("windowfocus", "--sync", self.window)

    def press(self, *keys: str) -> None:
        self.screen.xdotool("key", *keys)

    def click_at(self, x: float, y: float) -> None:
        """In parts of the window's size. The pointer goes out of the way then."""
        left, top, width, height = self.geometry
        self.screen.xdotool("mousemove", str(left + round(x * width)), str(top + round(y * height)), "click", "1")
        self.screen.xdotool("mousemove", str(left + width // 2), str(top + height // 3))

    def drag(self, begin: tuple[float, float], end: tuple[float, float], held: str | None = None) -> None:
        """With the left button, between places in parts of the window's size."""
        height, width = self.part(0, 0, 1, 1).shape[:2]
        (x0, y0), (x1, y1) = ((round(x * width), round(y * height)) for x, y in (begin, end))
        steps = [(round(x0 + (x1 - x0) * at / 5), round(y0 + (y1 - y0) * at / 5)) for at in range(1, 6)]
        moves = [word for x, y in steps for word in ("mousemove", "--window", self.window, str(x), str(y))]
        hold, let_go = (["keydown", held], ["keyup", held]) if held else ([], [])
        to_begin = ["mousemove", "--window", self.window, str(x0), str(y0)]
        self.screen.xdotool(*hold, *to_begin, "mousedown", "1", *moves, "mouseup", "1", *let_go)

    def scroll(self, notches: int, held: str | None = None) -> None:
        hold, let_go = (["keydown", held], ["keyup", held]) if held else ([], [])
        wheel = ["click", "--repeat", str(abs(notches)), "--delay", "20", "4" if notches > 0 else "5"]
        self.screen.xdotool(*hold, *wheel, *let_go)

    def picture(self) -> np.ndarray:
        """(h, w, 3) uint8 RGB of the whole screen, which no other window is on."""
        return self.screen.picture()

    def part(self, left: float, top: float, right: float, bottom: float) -> np.ndarray:
        """(h, w, 3) int16 RGB: a part of the window's picture, in parts of its size."""
        x, y, width, height = self.geometry
        whole = self.picture()[y : y + height, x : x + width]
        part = whole[round(top * height) : round(bottom * height), round(left * width) : round(right * width)]
        return part.astype(np.int16)

    @property
    def geometry(self) -> tuple[int, int, int, int]:
        """Left, top, width and height on the screen."""
        geometry = self.screen.xdotool("getwindowgeometry", "--shell", self.window)
        at = {name: int(value) for name, value in (line.split("=") for line in geometry.split())}
        return at["X"], at["Y"], at["WIDTH"], at["HEIGHT"]

    def files(self, pattern: str) -> list[Path]:
        return sorted(path for path in self.folder.glob(pattern) if not path.name.startswith("."))

    def light_workers(self) -> list[int]:
        """Process numbers of the living ones."""
        command = ["ps", "-ww", "-o", "pid=,stat=,args=", "--ppid", str(self.process.pid)]
        listed = subprocess.run(command, capture_output=True, text=True).stdout.splitlines()
        rows = [line.split(maxsplit=2) for line in listed]
        return [int(pid) for pid, state, arguments in rows if "spawn_main" in arguments and not state.startswith("Z")]

    def end(self) -> int:
        """Esc, and the exit status."""
        self.press("Escape")
        return self.wait()

    def wait(self) -> int:
        return self.process.wait(PATIENCE_S)

    def stop(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._out.close()


@contextmanager
def virtual_screen() -> Iterator[tuple[Screen, subprocess.Popen[bytes]]]:
    """An Xvfb of its own, and its process."""
    for program in ("Xvfb", "xdotool"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed (apt-get install xvfb xdotool)")
    read_end, write_end = os.pipe()
    command = ["Xvfb", "-displayfd", str(write_end), "-screen", "0", SCREEN, "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[write_end], stderr=subprocess.DEVNULL)
    os.close(write_end)
    with os.fdopen(read_end) as numbers:
        number = numbers.readline().strip()  # written once the server listens; empty when it could not start
    if not number:
        pytest.skip("Xvfb does not start here")
    yield Screen(f":{number}"), server
    server.terminate()
    server.wait()


@pytest.fixture(scope="session")
def screen() -> Iterator[Screen]:
    with virtual_screen() as (screen, _):
        yield screen


@pytest.fixture(scope="module")
def launch(screen: Screen, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Running]]:
    """Starts the viewer, its estimator not made to wait, or as shipped; one at a time: the keyboard is its own."""
    running: list[Running] = []

    def launch(*arguments: object, quick: bool = True, folder: Path | None = None) -> Running:
        for each in running:
            each.stop()
        program = (str(QUICK_VIEWER),) if quick else ("-m", "ashe_live")
        folder = folder or tmp_path_factory.mktemp("viewer")
        running.append(Running(screen, folder, tuple(map(str, arguments)), program))
        running[-1].await_window()
        return running[-1]

    yield launch
    for each in running:
        each.stop()


@pytest.fixture(scope="module")
def play(
    launch: Callable[..., Running],
    shoot_film: Callable[..., Any],
    tmp_path_factory: pytest.TempPathFactory,
) -> Callable[..., Running]:
    """Plays a film of two seconds in a window."""
    return player(launch, shoot_film(tmp_path_factory.mktemp("pan"), (640, 480), 60))


def player(launch: Callable[..., Running], film: Any) -> Callable[..., Running]:
    """Plays a film: fast, and without ground over the marker, which another thread may bring at any moment."""
    fixed = (film.path, "--camera-file", film.camera_file, "--estimator", "paper", "--quality", "fast")
    return lambda *arguments, **how: launch("play", *fixed, "--no-hide-marker", *arguments, **how)
