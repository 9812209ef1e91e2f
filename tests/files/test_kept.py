"""What is kept between runs: it is read back, and nothing that is wrong with its file stops the program."""

import errno
import threading
from pathlib import Path

import pytest

from ashe_live import cli
from ashe_live.commands import doctor
from ashe_live.files import kept as kept_module
from ashe_live.files.kept import KeptObject, configuration_file
from ashe_live.files.new_file import lock_number
from tests.patience import PATIENCE_S


def test_what_was_written_is_read_back_and_replaced(tmp_path: Path) -> None:
    kept = KeptObject(tmp_path / "new" / "folder" / "a.json")
    assert kept.read() == {}
    for content in ({"focal_px": 615.5}, {"focal_px": 700.0}):
        kept.write(content)
        assert kept.read() == content
    assert [path.name for path in (tmp_path / "new" / "folder").iterdir()] == ["a.json"]


def test_of_two_windows_that_change_it_at_once_both_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """When both are closed by one signal, for example."""
    pytest.importorskip("fcntl", reason="folders are not locked here")
    goes_on = threading.Event()  # the other waits, or has not waited and is done
    look = kept_module._wait
    monkeypatch.setattr(kept_module, "_wait", lambda: (goes_on.set(), look()))

    def change(name: str) -> None:
        kept = KeptObject(tmp_path / "a.json")
        with kept.alone():
            kept.write({**kept.read(), name: 1})
        goes_on.set()

    kept, other = KeptObject(tmp_path / "a.json"), threading.Thread(target=change, args=("other",))
    with kept.alone():
        content = kept.read()
        other.start()
        assert goes_on.wait(PATIENCE_S)
        kept.write({**content, "own": 1})
    other.join()
    assert kept.read() == {"own": 1, "other": 1}
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_who_keeps_the_lock_too_long_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_module, "LONGEST_WAIT_S", 0.0)
    one, other = KeptObject(tmp_path / "a.json"), KeptObject(tmp_path / "a.json")
    with one.alone(), other.alone():
        other.write({"a": 1})
    assert one.read() == {"a": 1}


def test_who_is_done_lets_the_next_one_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In one program as well: a lock that is never let go would cost everyone after it two seconds."""
    monkeypatch.setattr(kept_module, "_wait", lambda: pytest.fail("waited"))
    for _ in range(3):
        with KeptObject(tmp_path / "a.json").alone():
            pass


def test_nobody_waits_where_the_file_system_has_no_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOLCK, "no locks available")

    monkeypatch.setattr(pytest.importorskip("fcntl"), "flock", refuse)
    monkeypatch.setattr(kept_module, "_wait", lambda: pytest.fail("waited"))
    kept = KeptObject(tmp_path / "a.json")
    with kept.alone():
        kept.write({"a": 1})
    assert kept.read() == {"a": 1}


def test_what_is_no_folder_is_neither_opened_nor_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pipe there would be waited for, and so would whoever has locked a file."""
    monkeypatch.setattr(kept_module, "_wait", lambda: pytest.fail("waited"))
    with (tmp_path / "ashe-live").open("wb") as taken:
        lock_number(taken.fileno())
        with KeptObject(tmp_path / "ashe-live" / "models.json").alone():
            pass


def test_without_its_folder_yet_it_is_written_too(tmp_path: Path) -> None:
    kept = KeptObject(tmp_path / "new" / "a.json")
    with kept.alone():
        kept.write({"a": 1})
    assert kept.read() == {"a": 1}


@pytest.mark.parametrize("content", ["", "[1, 2]", "{", "null", '{"a": NaN}', "\xff"])
def test_a_file_that_holds_no_object_counts_as_missing(tmp_path: Path, content: str) -> None:
    (tmp_path / "a.json").write_text(content, encoding="latin-1")
    assert KeptObject(tmp_path / "a.json").read() == {}


def test_where_nothing_can_be_written_nothing_is_kept(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    for path in (tmp_path / "file" / "a.json", tmp_path / "folder"):
        KeptObject(path).write({"a": 1})
        assert KeptObject(path).read() == {}
    assert (tmp_path / "file").read_text() == "mine"


def test_it_is_kept_in_the_users_own_folder_for_this_program() -> None:
    path = configuration_file("settings.toml")
    assert path.is_absolute()
    assert path.name == "settings.toml"
    assert "ashe-live" in path.parts


@pytest.fixture
def without_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """As for a user whom the system does not know, without HOME: in containers, and as services."""
    pwd = pytest.importorskip("pwd")
    for name in ("HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)

    def unknown(_uid: int) -> None:
        raise KeyError("getpwuid(): uid not found: 12345")

    monkeypatch.setattr(pwd, "getpwuid", unknown)


@pytest.mark.usefixtures("without_home")
def test_without_a_home_nothing_is_kept_and_nothing_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also not in a folder called "~", which may lie beside a clip."""
    hostile = tmp_path / "~" / ".config" / "ashe-live"
    hostile.mkdir(parents=True)
    (hostile / "a.json").write_text('{"a": 1}')
    monkeypatch.chdir(tmp_path)
    kept = KeptObject(configuration_file("a.json"))
    assert kept.read() == {}
    kept.write({"a": 2})
    assert kept.read() == {}
    assert (hostile / "a.json").read_text() == '{"a": 1}'


@pytest.mark.parametrize("folder", [Path("~/.config/ashe-live"), Path("relative")])
def test_no_folder_of_the_current_one_is_the_users_own(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    monkeypatch.setattr("platformdirs.user_config_path", lambda *_args, **_named: folder)
    assert configuration_file("a.json").is_absolute()
    assert not KeptObject(configuration_file("a.json")).read()


def test_where_the_folder_for_settings_is_said_to_be_no_folder_home_is_not_blamed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As who wants nothing kept sets it."""
    monkeypatch.setattr("platformdirs.user_config_path", lambda *_args, **_named: Path("/dev/null/ashe-live"))
    assert cli.run(["settings"]) == 0
    assert "HOME or XDG_CONFIG_HOME names no folder" in capsys.readouterr().out


@pytest.mark.usefixtures("without_home")
def test_without_a_home_the_program_runs_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["settings"]) == 0
    assert "HOME or XDG_CONFIG_HOME names no folder: set it" in capsys.readouterr().out
    assert "HOME or XDG_CONFIG_HOME names no folder" in doctor.CHECKS["settings"]()
