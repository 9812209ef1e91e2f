"""A new file is there whole or not at all, and takes nothing away from what is there already."""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import pytest

from ashe_live.errors import UserError
from ashe_live.files import new_file
from ashe_live.files.new_file import NewFile, check_output, partial_path
from ashe_live.files.writing import (
    check_folder,
    check_outputs,
    make_folder,
    unused,
    unused_name,
    write_json,
    written_whole,
)
from tests.checkout import CHECKOUT
from tests.open_files import needs_list_of_open_files, open_within
from tests.windows_files import as_on_windows


@pytest.fixture(params=["unnamed", "named", "without hard links", "as on Windows"])
def a_system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Which can do more or less."""
    if request.param != "unnamed":
        monkeypatch.setattr(new_file, "UNNAMED", 0)
    if request.param == "as on Windows":
        as_on_windows(monkeypatch)
    if request.param == "without hard links":

        def refuse(*_: object, **__: object) -> None:
            raise PermissionError("no hard links here")

        monkeypatch.setattr(os, "link", refuse)


pytestmark = pytest.mark.usefixtures("a_system")


def write(path: Path, text: str, overwrite: bool = False, beside: bool = False) -> Path:
    with written_whole(path, overwrite, beside) as file:
        file.stream.write(text.encode())
    return file.path


def test_it_is_there_at_the_end_and_not_before(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    with written_whole(path) as file:
        file.stream.write(b"whole")
        assert not path.exists()
    assert path.read_bytes() == b"whole"
    assert list(tmp_path.iterdir()) == [path]
    umask = os.umask(0)
    os.umask(umask)
    assert path.stat().st_mode & 0o777 == 0o666 & ~umask


def test_an_error_within_leaves_nothing(tmp_path: Path) -> None:
    def fail() -> None:
        with written_whole(tmp_path / "a.txt") as file:
            file.stream.write(b"half")
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_nothing_and_is_said(tmp_path: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(UserError, match="File too large"):
            write(tmp_path / "a.txt", "x" * 2000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_is_replaced_only_when_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write(path, "first")
    with pytest.raises(UserError, match="exists already"):
        write(path, "second")
    assert path.read_text() == "first"
    assert write(path, "third", overwrite=True) == path
    assert path.read_text() == "third"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("beside", [False, True])
def test_what_appears_meanwhile_stays(tmp_path: Path, beside: bool) -> None:
    path = tmp_path / "a.txt"
    file = NewFile(path)
    file.stream.write(b"ours")
    path.write_text("theirs")
    if beside:
        assert file.publish(beside) == tmp_path / "a-2.txt"
        assert (tmp_path / "a-2.txt").read_text() == "ours"
    else:
        with pytest.raises(UserError, match="exists already"):
            file.publish()
    file.discard()
    assert path.read_text() == "theirs"
    assert len(list(tmp_path.iterdir())) == 1 + beside


@pytest.mark.skipif(not new_file.NUMBERED_FILES.is_dir(), reason="the system does not tell where an open file is")
@pytest.mark.parametrize("is_recoverable", [False, True])
def test_a_folder_that_is_renamed_takes_the_file_along(tmp_path: Path, is_recoverable: bool) -> None:
    before, after = tmp_path / "before", tmp_path / "after"
    before.mkdir()
    file, dropped = (NewFile(before / "a.txt", is_recoverable=is_recoverable) for _ in range(2))
    file.stream.write(b"whole")
    before.rename(after)
    assert file.publish() == after / "a.txt"
    dropped.discard()
    assert (after / "a.txt").read_bytes() == b"whole"
    assert list(tmp_path.rglob("*")) == [after, after / "a.txt"]
    after.rename(before)
    file.discard()
    assert (before / "a.txt").read_bytes() == b"whole"


@pytest.mark.skipif(not new_file.NUMBERED_FILES.is_dir(), reason="the system does not tell where an open file is")
def test_a_hidden_file_stays_in_its_folder_though_there_is_another_of_that_name(tmp_path: Path) -> None:
    before, after = tmp_path / "before", tmp_path / "after"
    before.mkdir()
    with NewFile(before / "a.txt", is_recoverable=True) as file:
        before.rename(after)
        before.mkdir()
        assert file.publish() == after / "a.txt"
    assert list(before.iterdir()) == []


def test_a_file_system_without_locks_is_no_obstacle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError("no locks here")

    if new_file.fcntl is None:
        monkeypatch.setattr(sys.modules["msvcrt"], "locking", refuse)
    else:
        monkeypatch.setattr(new_file.fcntl, "flock", refuse)
    assert write(tmp_path / "a.txt", "whole").read_text() == "whole"


def test_what_is_worth_keeping_is_put_beside_what_has_appeared_or_it_is_said_that_it_has_gone(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    file, gone = (NewFile(folder / "a.txt", is_recoverable=True) for _ in range(2))
    file.path.write_text("theirs")
    assert file.publish_or_keep() == folder / "a-2.txt"
    shutil.rmtree(folder)
    with pytest.raises(OSError, match="No such file"):
        gone.publish_or_keep()
    gone.discard()


def test_in_a_folder_that_was_write_protected_meanwhile_a_hidden_file_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept, other = (NewFile(tmp_path / "a.txt", is_recoverable=True) for _ in range(2))
    kept.stream.write(b"worth keeping")

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError("write-protected")

    monkeypatch.setattr(os, "link", refuse)
    monkeypatch.setattr(Path, "replace", refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    path = kept.publish_or_keep()
    kept.discard()
    other.discard()  # cannot be removed, which ends nothing
    monkeypatch.undo()
    assert path.read_bytes() == b"worth keeping"
    assert path.name.startswith(".a.")


def test_a_name_that_was_only_reserved_is_free_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As where the disk goes while the file is given its name."""
    monkeypatch.setattr(new_file, "UNNAMED", 0)

    def refuse(*_: object, **__: object) -> None:
        raise OSError("gone")

    monkeypatch.setattr(os, "link", refuse)
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(UserError, match="gone"):
        write(tmp_path / "a.txt", "whole")
    assert list(tmp_path.iterdir()) == []


def test_an_unnamed_file_that_cannot_be_given_a_name_is_said_and_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where /proc is that of another system, or is forbidden."""

    def refuse(*_: object, **__: object) -> None:
        raise OSError("no link to it")

    monkeypatch.setattr(os, "link", refuse)
    monkeypatch.setattr(new_file, "UNNAMED", getattr(os, "O_TMPFILE", 0))
    if not new_file.UNNAMED or new_file.fcntl is None:
        pytest.skip("files cannot be without a name on this system")
    with pytest.raises(UserError, match="cannot write"):
        write(tmp_path / "a.txt", "whole")
    assert list(tmp_path.iterdir()) == []


@needs_list_of_open_files
def test_neither_writing_a_file_nor_looking_whether_it_can_be_leaves_anything_open(tmp_path: Path) -> None:
    with NewFile(tmp_path / "a.txt"):
        assert open_within(tmp_path)
    check_output(tmp_path / "a.txt", overwrite=False)
    assert open_within(tmp_path) == []
    assert list(tmp_path.iterdir()) == []
    for overwrite in (False, True):
        write(tmp_path / "a.txt", "whole", overwrite)
    assert open_within(tmp_path) == []


def test_where_there_are_hard_links_no_name_is_reserved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    """An empty file would stay if the program were killed between that and the next step."""
    if request.node.callspec.params["a_system"] == "without hard links":
        pytest.skip("there are none")
    monkeypatch.setattr(NewFile, "_moved_onto_reservation", lambda *_: pytest.fail("reserved"))
    assert write(tmp_path / "a.txt", "whole").read_text() == "whole"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_what_appears_before_a_result_is_written_stays_too(tmp_path: Path) -> None:
    """As where two programs save a picture in the same second, or a long run's report."""
    path = tmp_path / "a.txt"
    path.write_text("theirs")
    (tmp_path / "a-2.txt").write_text("theirs as well")
    assert write(path, "ours", beside=True) == tmp_path / "a-3.txt"
    assert write(path, "over it", overwrite=True, beside=True) == path
    path.unlink()
    path.symlink_to("a-2.txt")
    assert write(path, "not through it", overwrite=True, beside=True) == tmp_path / "a-4.txt"
    texts = {each.name: each.read_text() for each in tmp_path.iterdir()}
    assert texts == {
        "a.txt": "theirs as well", "a-2.txt": "theirs as well", "a-3.txt": "ours", "a-4.txt": "not through it"
    }  # fmt: skip


@pytest.mark.parametrize("overwrite", [False, True])
@pytest.mark.parametrize("target", ["thesis.txt", "gone"])
def test_links_are_neither_followed_nor_replaced(tmp_path: Path, target: str, overwrite: bool) -> None:
    (tmp_path / "thesis.txt").write_text("precious")
    link = tmp_path / "a.txt"
    link.symlink_to(target)
    with pytest.raises(UserError, match="is a link"):
        write(link, "ours", overwrite)
    assert link.readlink() == Path(target)
    assert (tmp_path / "thesis.txt").read_text() == "precious"
    assert not (tmp_path / "gone").exists()


def test_devices_pipes_and_folders_are_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    for path, said in (
        (tmp_path / "pipe", "is a device or a pipe and not a file"),
        (tmp_path / "folder", "is a folder"),
        (Path("/dev/null"), "is a device or a pipe and not a file"),
    ):
        with pytest.raises(UserError, match=said):
            check_output(path, overwrite=True)
    assert (tmp_path / "pipe").is_fifo()


@pytest.mark.parametrize("name", ["missing/a.txt", "a" * 300, "a\0b", "file/a.txt"])
def test_places_where_nothing_can_be_written_are_said_before(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(UserError):
        check_output(tmp_path / name, overwrite=False)
    with pytest.raises(UserError):
        write(tmp_path / name, "whole", beside=True)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_folder_is_checked_without_being_made(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "results"
    check_folder(folder, ("a.json",))
    assert not folder.parent.exists()
    (tmp_path / "file").write_text("mine")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for wrong in ("file", "file/within", "link"):
        with pytest.raises(UserError, match="is a file, not a folder"):
            check_folder(tmp_path / wrong)
    for wrong in ("n" * 300, "nul\0"):
        with pytest.raises(UserError, match=re.escape(f"cannot write {tmp_path / wrong} (")):
            check_folder(tmp_path / wrong)
    with pytest.raises(UserError, match="exists already"):
        check_folder(tmp_path, ("file",))


@pytest.mark.parametrize("right", [os.W_OK, os.X_OK])
def test_a_folder_in_which_nothing_may_be_made_is_said_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, right: int
) -> None:
    """Root may do everything, so the system's answer is put in its place: without one of the two rights it is no."""
    asked: list[Path] = []
    monkeypatch.setattr(os, "access", lambda path, mode: asked.append(path) or not mode & right)
    with pytest.raises(UserError, match=re.escape(f"cannot write {tmp_path / 'new' / 'results'} (Permission denied)")):
        check_folder(tmp_path / "new" / "results")
    assert asked == [tmp_path]


def test_a_folder_that_must_not_be_written_to_is_said_before() -> None:
    """Linux lets nobody, not even root, create a file here."""
    if not Path("/proc").is_dir():
        pytest.skip("no /proc on this system")
    for refused in (lambda path: check_output(path, overwrite=False), NewFile):
        with pytest.raises(UserError, match=r"cannot write /proc/a\.txt \("):
            refused(Path("/proc/a.txt"))


@pytest.mark.parametrize("stem", ["ä" * 125, "a" * 250, "x"])
def test_hidden_names_are_names_and_not_to_be_foreseen(tmp_path: Path, stem: str) -> None:
    path = tmp_path / f"{stem}.mp4"
    first, second = partial_path(path), partial_path(path)
    assert first != second
    assert first.name.startswith(".")
    assert len(os.fsencode(first.name)) <= 255
    assert write(path, "whole").read_text() == "whole"


def test_outputs_are_not_also_inputs_or_each_other(tmp_path: Path) -> None:
    clip, report = tmp_path / "clip.mp4", tmp_path / "report.json"
    clip.write_text("precious")
    (tmp_path / "link").symlink_to(tmp_path)
    check_outputs([report, None], [clip, None], overwrite=True)
    for output in (clip, tmp_path / "link" / "clip.mp4"):
        with pytest.raises(UserError, match="is also read"):
            check_outputs([output], [clip], overwrite=True)
    with pytest.raises(UserError, match="named twice"):
        check_outputs([report, tmp_path / "." / "report.json"], [clip], overwrite=True)
    (tmp_path / "older.json").write_text("mine")
    check_outputs([tmp_path / "older.json"], [clip], overwrite=True)
    for wrong in (tmp_path / "older.json", tmp_path / "missing" / "report.json"):
        with pytest.raises(UserError):
            check_outputs([wrong], [clip], overwrite=False)


def test_an_output_is_not_an_input_by_another_name(tmp_path: Path) -> None:
    clip, report = tmp_path / "clip.mp4", tmp_path / "report.json"
    clip.write_text("precious")
    try:
        report.hardlink_to(clip)
    except PermissionError:
        pytest.skip("no hard links here")
    with pytest.raises(UserError, match="is also read"):
        check_outputs([report], [clip], overwrite=True)


def test_json_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    with pytest.raises(ValueError, match="JSON"):
        write_json(path, {"a": float("nan")})
    assert list(tmp_path.iterdir()) == []
    assert write_json(path, {"a": "ä"}) == path
    assert json.loads(path.read_bytes()) == {"a": "ä"}
    assert path.read_text().endswith("}\n")
    with pytest.raises(UserError, match="exists already"):
        write_json(path, {"a": 2})
    assert write_json(path, {"a": 2}, beside=True) == tmp_path / "a-2.json"
    assert write_json(path, {"a": 3}, overwrite=True) == path
    assert json.loads(path.read_bytes()) == {"a": 3}


def test_names_are_numbered_from_the_second_on(tmp_path: Path) -> None:
    at = datetime(2026, 11, 21, 14, 3, 12)
    names = []
    for _ in range(3):
        path = unused_name(tmp_path, "mug", ".png", at)
        names.append(path.name)
        path.symlink_to("nowhere")  # a link that leads nowhere takes the name as well
    assert names == ["mug-20261121-140312.png", "mug-20261121-140312-2.png", "mug-20261121-140312-3.png"]


def test_a_folder_is_made_with_its_parents_or_it_is_said_why_not(tmp_path: Path) -> None:
    for _ in range(2):
        make_folder(tmp_path / "new" / "results")
    assert (tmp_path / "new" / "results").is_dir()
    (tmp_path / "file").write_text("mine")
    for wrong, said in (
        ("file", "{} is a file, not a folder"),
        *((wrong, "cannot write {} (") for wrong in ("file/within", "n" * 300, "nul\0")),
    ):
        with pytest.raises(UserError, match=re.escape(said.format(tmp_path / wrong))):
            make_folder(tmp_path / wrong)


@pytest.mark.parametrize("stem", ["x" * 300, "ä" * 200])
def test_a_name_made_of_a_long_one_is_a_name(tmp_path: Path, stem: str) -> None:
    path = unused_name(tmp_path, stem, ".png", datetime(2026, 11, 22))
    assert write(path, "whole") == path


WRITE_UNTIL_KILLED = """
import sys
from datetime import datetime
from pathlib import Path
from ashe_live.files.new_file import NewFile
file = NewFile(Path(sys.argv[1]))
file.stream.write(b"half")
file.stream.flush()
print("writing", flush=True)
sys.stdin.read()
"""


def test_a_killed_program_leaves_nothing(tmp_path: Path) -> None:
    if not new_file.UNNAMED:
        pytest.skip("files cannot be without a name on this system")
    with subprocess.Popen(
        [sys.executable, "-c", WRITE_UNTIL_KILLED, str(tmp_path / "a.json")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=CHECKOUT,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"writing\n"
        process.kill()
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_the_system_refuses_is_refused_in_writing_and_not_in_looking_for_it(tmp_path: Path) -> None:
    """As of a recording whose name is as long as one may be, with a longer suffix."""
    longer = tmp_path / ("x" * 251 + ".json")
    assert unused(longer) == longer
    with pytest.raises(UserError, match="cannot write"):
        write_json(unused(longer), {})
