"""Full disks, few descriptors, little memory, homes that cannot be used: status 2, one line, what was recorded kept."""

import random
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fuzz.command_lines.case import HOME, WORK, Case, Planted
from tests.fuzz.command_lines.files import defect, picture_count
from tests.fuzz.command_lines.oracle import broken_promises
from tests.fuzz.command_lines.surroundings import ENOUGH_FOR_MESSAGES

FRAMES = 130  # two fragments of two seconds, and some more
RECORDING = Case(
    ("play", "clip.mp4", "--headless", "--loop", "--frames", str(FRAMES), "--quality", "fast",
     "--no-hide-marker", "--estimate-at", "999999", "--out", "walk.mp4", "--report", "walk.json"),
    (Planted(f"{WORK}/clip.mp4", "material", "clip.mp4"),),
    ("walk.mp4", "walk.json"),
)  # fmt: skip
FEW_FRAMES = 5
BRIEF = replace(
    RECORDING, arguments=tuple(str(FEW_FRAMES) if word == str(FRAMES) else word for word in RECORDING.arguments)
)
# In the middle: tests/e2e/test_ends.py.
MOMENTS = {"at opening": 0.0, "at closing": 1.0}


def broken_at(runner, case: Case, folder: Path | None = None) -> list[str]:
    """What went otherwise than promised when there was no room; the clip may be in another folder."""
    with runner.run(case) as outcome:
        broken = [str(each) for each in broken_promises(case, outcome)]
        status, said = outcome.ended[0].status, outcome.ended[0].err
        where = folder or outcome.sandbox.base / WORK
        clips = [path for path in where.glob("*.mp4") if path.name != "clip.mp4"]
        broken += [f"{path.name}: {why}" for path in clips if (why := defect(path)) is not None]
        counts = [picture_count(path) for path in clips if defect(path) is None]
        frames = FEW_FRAMES if str(FEW_FRAMES) in case.arguments else FRAMES
        if status == 2 and counts not in ([], [frames]) and b"saved" not in said:
            broken.append(f"{counts} pictures of {frames}, of which nothing is said: {said!r}")
        if status == 0 and counts != [frames]:
            broken.append(f"status 0 with {counts} pictures of {frames}")
        if status not in (0, 2):
            broken.append(f"status {status}: {said!r}")
        return broken


@pytest.fixture(scope="module")
def whole_bytes(runner) -> int:
    """Of the recording with enough room."""
    with runner.run(RECORDING) as outcome:
        assert [ended.status for ended in outcome.ended] == [0]
        return (outcome.sandbox.base / WORK / "walk.mp4").stat().st_size


@pytest.mark.parametrize("moment", MOMENTS)
def test_a_recording_that_may_grow_no_more_ends_in_one_line_and_is_kept(runner, whole_bytes, moment):
    limit = {"RLIMIT_FSIZE": max(ENOUGH_FOR_MESSAGES, int(MOMENTS[moment] * whole_bytes))}
    assert broken_at(runner, replace(RECORDING, limits=limit)) == []


@pytest.fixture
def small_disk(tmp_path) -> Iterator[object]:
    """Makes a disk of so many bytes; only a superuser may."""
    mounted: list[Path] = []

    def make(byte_count: int) -> Path:
        folder = tmp_path / f"disk-{len(mounted)}"
        folder.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", f"size={byte_count}", "tmpfs", str(folder)]
        if shutil.which("mount") is None or subprocess.run(command, capture_output=True).returncode:
            pytest.skip("nobody but a superuser may make a small disk")
        mounted.append(folder)
        return folder

    yield make
    for folder in mounted:
        subprocess.run(["umount", str(folder)], check=True)


def on(disk: Path) -> Case:
    arguments = tuple(f"{disk}/{word}" if word in ("walk.mp4", "walk.json") else word for word in RECORDING.arguments)
    return replace(RECORDING, arguments=arguments, outputs=())


def broken_on(runner, disk: Path, keeps: bool) -> list[str]:
    """The same on a disk that is full then; `keeps`: whether something had been recorded."""
    broken = broken_at(runner, on(disk), disk)
    left = sorted(path.name for path in disk.iterdir())
    hidden = [name for name in left if name.startswith(".") and defect(disk / name) is not None]
    clips = [name for name in left if name.endswith(".mp4")]
    if hidden:
        broken.append(f"left over: {hidden}")
    if keeps and not clips:
        broken.append("what was recorded is lost")
    return broken


# Where the last write that fails begins on a page of its own, none of it is written: it was lost as a whole.
@pytest.mark.parametrize("share", [0.0, 0.77, 0.88, 1.0, 1.87])
def test_a_recording_on_a_full_disk_ends_in_one_line_and_is_kept(runner, whole_bytes, small_disk, share):
    assert broken_on(runner, small_disk(_pages(share * whole_bytes)), share > 0.6) == []


@pytest.mark.parametrize("descriptors", [14, 20])
def test_with_few_descriptors_it_works_or_ends_in_one_line(runner, descriptors):
    case = replace(BRIEF, limits={"RLIMIT_NOFILE": descriptors}, start="script")
    assert broken_at(runner, case) == []


@pytest.mark.parametrize("megabytes", [250, 450])
def test_with_little_memory_it_works_or_ends_in_one_line(runner, megabytes):
    case = replace(BRIEF, limits={"RLIMIT_AS": megabytes << 20}, start="script")
    assert broken_at(runner, case) == []


@pytest.mark.parametrize("home", ["{base}/missing", "{base}/outside/thesis.txt", ""])
def test_without_a_home_it_works(runner, home):
    assert broken_at(runner, replace(BRIEF, environment={"HOME": home, "TMPDIR": home})) == []


@pytest.mark.parametrize("mode", [0o555, 0])
def test_with_a_home_that_cannot_be_used_it_works_or_ends_in_one_line(runner, mode):
    assert broken_at(runner, replace(BRIEF, modes={HOME: mode})) == []


def test_at_very_many_sizes_of_the_disk(runner, whole_bytes, small_disk, capsys, pytestconfig):
    count = pytestconfig.getoption("fuzz_disks", None)
    if count is None:
        pytest.skip("a long run: --fuzz-disks N --fuzz-seed N")
    chance = random.Random(pytestconfig.getoption("fuzz_seed"))
    broken = []
    for at in range(count):
        room = int(chance.uniform(0, 2.5) * whole_bytes)
        limited = replace(RECORDING, limits={"RLIMIT_FSIZE": max(ENOUGH_FOR_MESSAGES, room)})
        broken += [f"files of up to {room} bytes: {each}" for each in broken_at(runner, limited)]
        pages = _pages(room)
        broken += [
            f"disk of {pages} bytes: {each}" for each in broken_on(runner, small_disk(pages), room > 0.6 * whole_bytes)
        ]
        if (at + 1) % 10 == 0:
            with capsys.disabled():
                print(f"{at + 1} of {count} sizes, {len(broken)} broken promises", flush=True)
    assert not broken, "\n".join(broken)


def _pages(byte_count: float) -> int:
    """What a disk in memory can have: at least a page for its own folder and one more."""
    return max(2, round(byte_count / 4096)) * 4096
