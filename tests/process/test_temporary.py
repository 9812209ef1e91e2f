"""Temporary folders: none is left, however what needs one ends."""

import signal
import sys
import tempfile
from pathlib import Path

import pytest

from ashe_live.errors import UserError
from ashe_live.process.temporary import temporary_folder

SIGNALS = [signal.SIGINT, signal.SIGTERM] + [signal.SIGHUP] * (sys.platform != "win32")


@pytest.fixture(autouse=True)
def parent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_it_is_there_meanwhile_and_gone_afterwards(parent: Path) -> None:
    with temporary_folder() as folder:
        assert list(parent.iterdir()) == [folder]
        (folder / "a").write_text("a")
    assert list(parent.iterdir()) == []


@pytest.mark.parametrize("number", SIGNALS)
def test_a_request_to_end_leaves_none(parent: Path, number: signal.Signals) -> None:
    # Should nothing handle the request, this test fails, and not all tests end.
    before = signal.signal(number, lambda *_: None)
    try:
        with pytest.raises((KeyboardInterrupt, SystemExit)), temporary_folder():
            signal.raise_signal(number)
    finally:
        signal.signal(number, before)
    assert list(parent.iterdir()) == []


def test_a_request_to_end_while_it_is_removed_waits_until_it_is(parent: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    remove = tempfile.TemporaryDirectory.cleanup

    def interrupted(folder: tempfile.TemporaryDirectory[str]) -> None:
        signal.raise_signal(signal.SIGTERM)
        remove(folder)

    monkeypatch.setattr(tempfile.TemporaryDirectory, "cleanup", interrupted)
    with pytest.raises(SystemExit), temporary_folder():
        pass
    assert list(parent.iterdir()) == []


def test_where_none_can_be_made_it_is_said_with_a_remedy(parent: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(tempfile, "_candidate_tempdir_list", lambda: [str(parent / "not there")])
    with pytest.raises(UserError, match="no temporary file can be written") as caught, temporary_folder():
        pass
    assert "TMPDIR" in caught.value.remedy
