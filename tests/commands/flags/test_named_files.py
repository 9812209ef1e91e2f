"""Files, folders and patterns, as a shell would take them."""

from pathlib import Path

import pytest

from ashe_live.commands.flags.named_files import named_files


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """With photos, a clip, what is neither, what is hidden, and a link back to itself."""
    for name in ("b.jpg", "a.jpg", "c.mp4", "notes.txt", ".hidden.jpg", "sub/d.jpg", ".git/e.jpg", "[1].jpg", "1.jpg"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"x")
    (tmp_path / "empty").mkdir()
    (tmp_path / "sub" / "round").symlink_to(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(*given: str) -> list[str]:
    return [path.as_posix() for path in named_files(map(Path, given))]


@pytest.mark.usefixtures("folder")
def test_files_stay_in_their_order_also_those_that_are_not_there() -> None:
    assert names("b.jpg", "missing.jpg", "a.jpg", "x" * 300) == ["b.jpg", "missing.jpg", "a.jpg", "x" * 300]


def test_a_folder_stands_for_its_photos_and_clips_in_order_and_says_what_is_passed_over(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = names(str(folder))
    assert [Path(name).name for name in found] == ["1.jpg", "[1].jpg", "a.jpg", "b.jpg", "c.mp4"]
    said = capsys.readouterr().err
    assert "passed over" in said
    assert "notes.txt" in said
    assert ".hidden" not in said
    assert names("sub") == ["sub/d.jpg"]
    assert capsys.readouterr().err == ""


@pytest.mark.usefixtures("folder")
def test_a_folder_without_any_is_kept_so_that_opening_it_says_what_is_wrong() -> None:
    assert names("empty", "a.jpg") == ["empty", "a.jpg"]


def test_a_pattern_stands_for_the_files_that_it_matches(folder: Path) -> None:
    assert names("*.jpg") == ["1.jpg", "[1].jpg", "a.jpg", "b.jpg"]
    assert names("?.jpg") == ["1.jpg", "a.jpg", "b.jpg"]
    assert names("[ab].*") == ["a.jpg", "b.jpg"]
    assert names(f"{folder}/a*") == [f"{folder}/a.jpg"]
    assert names("s*/*.jpg") == ["sub/d.jpg"]
    assert names("*") == ["1.jpg", "[1].jpg", "a.jpg", "b.jpg", "c.mp4", "notes.txt"], "no folders"
    assert names("*.png") == ["*.png"], "kept, so that opening it says that there is none"


@pytest.mark.usefixtures("folder")
def test_nothing_hidden_is_matched_unless_it_is_asked_for_and_no_link_is_gone_round() -> None:
    assert names("**/*.jpg") == ["1.jpg", "[1].jpg", "a.jpg", "b.jpg", "sub/d.jpg"]
    assert names("**") == ["1.jpg", "[1].jpg", "a.jpg", "b.jpg", "c.mp4", "notes.txt", "sub/d.jpg"]
    assert names(".*.jpg") == [".hidden.jpg"]
    assert names(".git/*") == [".git/e.jpg"]


def test_a_file_may_have_a_patterns_characters_in_its_name(folder: Path) -> None:
    """Of that name, and not the one that the pattern would match."""
    assert names("[1].jpg") == ["[1].jpg"]
    (folder / "[1].jpg").unlink()
    assert names("[1].jpg") == ["1.jpg"]
