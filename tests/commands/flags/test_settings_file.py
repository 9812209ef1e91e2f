"""The settings file: what is in it is checked, and said in one line; what is not there is no setting."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.commands.flags.settings_file import SETTINGS, flags_of, read_settings
from ashe_live.errors import UserError


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("settings") / "settings.toml"


def test_without_a_file_nothing_is_set(tmp_path):
    assert read_settings(tmp_path / "none" / "settings.toml") == {}


def test_each_command_gets_the_flags_that_it_has(path):
    path.write_text('camera = 2\nquality = "fast"\nhfov = 70.5\nmodel = "mug"\n')
    read = read_settings(path)
    assert flags_of(read, "webcam") == ["--camera=2", "--quality=fast", "--hfov=70.5", "--model=mug"]
    assert flags_of(read, "demo") == ["--quality=fast", "--model=mug"]
    assert flags_of(read, "bench") == []


def test_a_camera_file_is_beside_the_settings_unless_its_path_is_full(path):
    for written, meant in (("cam.json", path.parent / "cam.json"), ("/cams/a.json", Path("/cams/a.json"))):
        path.write_text(f'camera-file = "{written}"\n')
        assert read_settings(path)["camera-file"] == str(meant)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("qualty = 1", "did you mean quality?"),
        ("marker_size = 0.1", "did you mean marker-size?"),
        ("wings = 2", "the settings are camera, marker"),
        ("quality = 3", "quality is not text in quotes"),
        ('hfov = "wide"', "hfov is not a number"),
        ("hfov = true", "hfov is not a number"),
        ("camera = 1.5", "camera is not a number, or text"),
        ("[marker]\nsize = 1", "marker is not text"),
        ('hfov = 60\ncamera-file = "a.json"', "keep one of them"),
        ("quality = fast", "is not TOML"),
        (f"quality = {'[' * 9999}", "nested too deeply"),
        (f"light{'.a' * 3000} = 1", "light is not text"),
        (f"focal-px = 0x{'f' * 5000}", "focal-px is too large a number"),
        ('light = "a\\u0000b"', "has a NUL in it"),
        ("\udcff", "is not UTF-8"),
        ('camera-file = "~nobody-of-that-name/a.json"', "nobody's folder"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(path, content, said):
    path.write_bytes(content.encode("utf-8", "surrogateescape"))
    with pytest.raises(UserError) as caught:
        read_settings(path)
    assert said in str(caught.value)
    assert str(path) in caught.value.message


def test_a_folder_in_its_place_cannot_be_read(tmp_path):
    with pytest.raises(UserError, match="is a folder"):
        read_settings(tmp_path)


values = st.one_of(st.text(max_size=8), st.integers(), st.floats(), st.booleans(), st.just([1]))
lines = st.one_of(
    st.binary(max_size=40),
    st.builds(
        lambda key, value: f"{key} = {value!r}".encode(errors="replace"), st.sampled_from(list(SETTINGS)), values
    ),
)


@given(st.lists(lines, max_size=3).map(b"\n".join))
def test_whatever_is_in_the_file_it_gives_settings_or_a_user_error(path, content):
    path.write_bytes(content)
    try:
        read = read_settings(path)
    except UserError:
        return
    assert set(read) <= set(SETTINGS)
