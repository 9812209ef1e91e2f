"""Regular files can be opened, by whatever name; nothing else is, and nothing is waited for."""

import errno
import io
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from ashe_live.errors import UserError
from ashe_live.files import reading
from ashe_live.files.reading import opened, read_bytes, read_json, read_text
from tests.open_files import needs_list_of_open_files, open_within
from tests.patience import PATIENCE_S


def test_a_file_can_be_read_through_a_link(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(b"text")
    (tmp_path / "link").symlink_to("a.txt")
    for name in ("a.txt", "link"):
        with opened(tmp_path / name) as stream:
            assert stream.read() == b"text"


def make_nothing(_: Path) -> None:
    pass


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (make_nothing, "there is no file"),
        (lambda path: path.symlink_to("gone"), "there is no file"),
        (lambda path: path.symlink_to(path), "cannot read"),
        (lambda path: path.mkdir(), "is a folder"),
        (lambda path: os.mkfifo(path), "is a device or a pipe"),
        (lambda path: path.symlink_to("/dev/zero"), "is a device or a pipe"),
        (lambda path: path.write_bytes(b""), "is empty"),
    ],
    ids=["missing", "dangling", "loop", "folder", "pipe", "device", "empty"],
)
def test_what_is_no_file_with_something_in_it_is_said(tmp_path: Path, make, said: str) -> None:
    make(tmp_path / "a")
    with pytest.raises(UserError, match=said) as caught:
        opened(tmp_path / "a")
    assert said in caught.value.message


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="only Linux has it")
def test_what_the_system_makes_up_as_it_is_read_is_empty() -> None:
    """It counts as a regular file; of /proc/kmsg, one that root may read, nothing comes that has a length."""
    path = Path("/proc/self/environ")
    assert path.read_bytes()
    with pytest.raises(UserError, match="is empty"):
        opened(path)
    assert read_bytes(path) == b""


def test_of_an_empty_file_it_is_said_that_it_is_empty_and_not_what_its_kind_should_hold(tmp_path: Path) -> None:
    for content in (b"", b"\n"):
        (tmp_path / "camera.json").write_bytes(content)
        with pytest.raises(UserError, match=r"camera\.json is empty"):
            read_json(tmp_path / "camera.json")


@pytest.mark.parametrize(
    ("name", "said"), [("a\0b", "is no file's name"), ("a" * 300, "cannot read"), ("a/b", "there is no file")]
)
def test_a_name_that_no_file_has_is_said(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "a").write_bytes(b"x")
    with pytest.raises(UserError, match=said):
        opened(tmp_path / name)


def test_a_pipe_that_takes_the_place_of_a_file_is_neither_waited_for_nor_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between the first look at it and its opening."""
    (tmp_path / "file").write_bytes(b"x")
    looked_at = (tmp_path / "file").stat()
    os.mkfifo(tmp_path / "a")
    monkeypatch.setattr(Path, "stat", lambda _path: looked_at)
    with ThreadPoolExecutor(1) as other:
        opening = other.submit(opened, tmp_path / "a")
        try:
            with pytest.raises(UserError, match="is a device or a pipe"):
                opening.result(PATIENCE_S)
        finally:
            os.close(os.open(tmp_path / "a", os.O_RDWR | os.O_NONBLOCK))  # lets go of one that waits for a writer


@needs_list_of_open_files
def test_what_is_refused_is_closed_at_once(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"some")
    with opened(tmp_path / "a"):
        assert open_within(tmp_path) == [str(tmp_path / "a")]
    (tmp_path / "a").write_bytes(b"")
    with pytest.raises(UserError, match="is empty") as caught:
        opened(tmp_path / "a")
    assert open_within(tmp_path) == [], f"with {caught.value} at hand"


def test_a_disk_that_fails_meanwhile_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Failing(io.FileIO):
        def read(self, _most: int = -1) -> bytes:
            raise OSError(errno.EIO, os.strerror(errno.EIO))

    (tmp_path / "a").write_bytes(b"x")
    monkeypatch.setattr(reading, "opened", lambda path, _may_be_empty: Failing(path))
    with pytest.raises(UserError, match=r"cannot read .*a \(Input/output error\): copy it again"):
        read_bytes(tmp_path / "a")


def test_no_more_is_read_than_was_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "sparse"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(UserError, match="too large"):
        read_bytes(path, 1000)


def test_as_much_as_is_allowed_is_read_and_not_a_byte_more(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(1000 * b"x")
    assert read_bytes(path, 1000) == 1000 * b"x"
    with pytest.raises(UserError, match="give a file of 999 bytes or fewer"):
        read_bytes(path, 999)


def test_text_is_utf8_with_or_without_a_mark(tmp_path: Path) -> None:
    path = tmp_path / "a"
    for content in (b"\xc3\xa4", b"\xef\xbb\xbf\xc3\xa4"):
        path.write_bytes(content)
        assert read_text(path) == "ä"
    path.write_bytes(b"\xe4")
    with pytest.raises(UserError, match="not UTF-8"):
        read_text(path)


@pytest.mark.parametrize(
    "content", ["{", "NaN", "[Infinity]", '{"a": 1e400}', "-1e999", "1" + 400 * "0", "[" * 100_000]
)
def test_only_json_of_finite_numbers_is_read(tmp_path: Path, content: str) -> None:
    path = tmp_path / "a.json"
    path.write_text(content)
    with pytest.raises(UserError, match="is not JSON"):
        read_json(path)


def test_what_is_wrong_with_json_is_said_in_words_about_the_text(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    for content, said in (("[" * 100_000, "nested too deeply"), ('{"a" 1}', "line 1 column 6"), ("[NaN]", "NaN is no")):
        path.write_text(content)
        with pytest.raises(UserError, match=said):
            read_json(path)
    path.write_text('{"a": [1, 2.5, "ä", null]}')
    assert read_json(path) == {"a": [1, 2.5, "ä", None]}


@pytest.mark.parametrize("address", ["https://example.com/a.mp4", "RTSP://10.0.0.1/live", "https:/example.com/a.mp4"])
def test_an_address_is_named_as_one_with_both_slashes(address: str) -> None:
    with pytest.raises(UserError, match="is an address") as caught:
        opened(Path(address))
    assert caught.value.message.startswith(address if "//" in address else address.replace(":/", "://"))


@pytest.mark.parametrize(
    ("address", "path"),
    [
        ("file:///a/b%20c.mp4", "/a/b c.mp4"),
        ("FILE://localhost/a/b.mp4", "/a/b.mp4"),
        ("file:/a/ä.mp4", "/a/ä.mp4"),
        ("file:///C:/a/b.mp4", "C:/a/b.mp4"),
    ],
)
def test_of_the_address_of_a_file_the_path_is_told_that_it_stands_for(address: str, path: str) -> None:
    """As file managers and browsers copy it."""
    with pytest.raises(UserError, match="is the address of a file") as caught:
        opened(Path(address))
    assert caught.value.remedy == f"give its path, {path}"


def test_standard_input_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match="nothing is read from standard input"):
        opened(Path("-"))
    Path("-").write_bytes(b"x")
    with opened(Path("-")) as stream:
        assert stream.read() == b"x"


def test_a_file_may_be_called_as_an_address_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "https:").mkdir()
    (tmp_path / "https:" / "a.mp4").write_bytes(b"x")
    with opened(Path("https://a.mp4")) as stream:
        assert stream.read() == b"x"
