"""Every way in which a run that records can end: the clip can be played, and one line says what happened."""

import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from ashe_live.capture.clips.clip import ClipSource
from tests.checkout import CHECKOUT
from tests.e2e.signals import ignore_none
from tests.patience import PATIENCE_S, await_that

# Enough for two fragments of two seconds: they are written as soon as they are whole.
BYTES_OF_FRAGMENTS = 40_000


class Endless:
    """`ashe-live play --loop` without a window, recording into a folder of its own."""

    def __init__(
        self, film, folder: Path, *before: str, file_size_limit: int | None = None, frames: int = 10**6
    ) -> None:
        self.folder = folder
        self.err = folder / ".err"

        def prepare() -> None:
            ignore_none()
            if file_size_limit is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (file_size_limit, file_size_limit))

        command = (*before, sys.executable, "-m", "ashe_live", "play", film.path, "--camera-file", film.camera_file,
                   "--headless", "--loop", "--frames", frames, "--quality", "fast", "--estimate-at", "999999",
                   "--no-hide-marker", "--out", "walk.mp4")  # fmt: skip
        environment = {**os.environ, "PYTHONPATH": str(CHECKOUT)}
        with self.err.open("w") as err:
            self.process = subprocess.Popen(
                list(map(str, command)), cwd=folder, env=environment, stderr=err, preexec_fn=prepare
            )

    def await_fragments(self) -> None:
        def are_there() -> bool:
            assert self.process.poll() is None, self.err.read_text()
            return sum(path.stat().st_size for path in self.partials) >= BYTES_OF_FRAGMENTS

        await_that(are_there, "a recording")

    def wait(self) -> int:
        return self.process.wait(PATIENCE_S)

    @property
    def partials(self) -> list[Path]:
        return list(self.folder.glob(".walk.*.partial.mp4"))

    @property
    def lines(self) -> list[str]:
        return self.err.read_text().splitlines()

    @property
    def recordings(self) -> list[str]:
        return sorted(path.name for path in self.folder.iterdir() if path != self.err)


def frame_count(clip: Path) -> int:
    with ClipSource(clip) as source:
        count = len(list(source))
        assert source.note is None or "truncated" in source.note
    return count


@pytest.fixture
def endless(film, tmp_path) -> Iterator[Callable[..., Endless]]:
    with ExitStack() as stack:

        def start(*before: str, **how: int) -> Endless:
            run = Endless(film, tmp_path, *before, **how)
            stack.callback(run.process.wait)
            stack.callback(run.process.kill)
            return run

        yield start


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_it_in_order_also_when_it_comes_twice(endless, number):
    run = endless()
    run.await_fragments()
    run.process.send_signal(number)
    run.process.send_signal(number)
    assert run.wait() == 128 + number
    assert run.recordings == ["walk.mp4"]
    count = frame_count(run.folder / "walk.mp4")
    assert count > 40
    assert run.lines[-1] == f"ashe-live: saved walk.mp4 ({count} frames)"
    assert not any("Traceback" in line for line in run.lines)


def test_a_signal_that_was_to_be_ignored_is_ignored(endless):
    if shutil.which("nohup") is None:
        pytest.skip("there is no nohup here")
    run = endless("nohup")
    run.await_fragments()
    run.process.send_signal(signal.SIGHUP)
    run.process.send_signal(signal.SIGTERM)
    assert run.wait() == 128 + signal.SIGTERM, "and not of SIGHUP"
    assert run.lines[-1] == f"ashe-live: saved walk.mp4 ({frame_count(run.folder / 'walk.mp4')} frames)"


def test_after_kill_9_the_next_start_gives_the_recording_a_name_that_can_be_seen(endless, film, tmp_path):
    run = endless()
    run.await_fragments()
    run.process.kill()
    run.wait()
    assert run.recordings == [path.name for path in run.partials]
    again = Endless(film, tmp_path, frames=3)
    assert again.wait() == 0
    assert again.recordings == ["walk-cut-short.mp4", "walk.mp4"]
    assert frame_count(tmp_path / "walk-cut-short.mp4") > 40
    assert [line for line in again.lines if str(tmp_path / "walk-cut-short.mp4") in line]


def test_a_full_disk_ends_it_in_one_line_and_what_came_before_can_be_played(endless):
    run = endless(file_size_limit=2 * BYTES_OF_FRAGMENTS)
    assert run.wait() == 2
    (line,) = run.lines
    assert line.startswith("ashe-live: cannot write walk.mp4 (File too large); the first part")
    assert run.recordings == ["walk.mp4"]
    assert frame_count(run.folder / "walk.mp4") > 40
