"""What is kept between runs: it is read back, and nothing that is wrong with its file stops the program."""

from pathlib import Path

import pytest

from ashe_live.files.kept import KeptObject, configuration_file


def test_what_was_written_is_read_back_and_replaced(tmp_path: Path) -> None:
    kept = KeptObject(tmp_path / "new" / "folder" / "a.json")
    assert kept.read() == {}
    for content in ({"focal_px": 615.5}, {"focal_px": 700.0}):
        kept.write(content)
        assert kept.read() == content
    assert [path.name for path in (tmp_path / "new" / "folder").iterdir()] == ["a.json"]


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
