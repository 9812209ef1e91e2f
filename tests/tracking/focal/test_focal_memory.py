"""The focal lengths that are kept: recalled for the same camera and size, and never in anyone's way."""

from pathlib import Path

import pytest

from ashe_live.tracking.focal.focal import FocalEstimate
from ashe_live.tracking.focal.focal_memory import FocalMemory

SIZE = (640, 480)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "new" / "focal_lengths.json"


def test_it_is_recalled_for_the_same_camera_and_size_only(path: Path) -> None:
    estimate = FocalEstimate(SIZE, 610.5, 12.25, 40)
    FocalMemory("Webcam C1 (046D:082D)", path).keep(estimate)
    FocalMemory("Another", path).keep(FocalEstimate(SIZE, 800.0, 20.0, 30))
    assert FocalMemory("Webcam C1 (046D:082D)", path).recall(SIZE) == estimate
    assert FocalMemory("Webcam C1 (046D:082D)", path).recall((1280, 720)) is None
    assert FocalMemory("A third", path).recall(SIZE) is None


def test_what_is_surer_stays(path: Path) -> None:
    memory = FocalMemory("camera", path)
    for sigma, kept in ((20.0, 20.0), (30.0, 20.0), (10.0, 10.0)):
        memory.keep(FocalEstimate(SIZE, 600.0, sigma, 30))
        recalled = memory.recall(SIZE)
        assert recalled is not None
        assert recalled.sigma_px == kept


def test_what_is_wrong_is_forgotten_for_that_size_alone(path: Path) -> None:
    memory, other = FocalMemory("camera", path), FocalEstimate((1280, 720), 1200.0, 20.0, 30)
    for estimate in (FocalEstimate(SIZE, 600.0, 2.0, 30), other):
        memory.keep(estimate)
    memory.forget(SIZE)
    assert memory.recall(SIZE) is None
    assert memory.recall((1280, 720)) == other


@pytest.mark.parametrize("entry", ["5", '{"focal_px": -1, "sigma_px": 1, "views": 9}', '{"focal_px": 600}'])
def test_an_entry_that_is_damaged_is_as_if_it_were_not_there(path: Path, entry: str) -> None:
    path.parent.mkdir()
    path.write_text(f'{{"camera, 640x480": {entry}}}')
    memory = FocalMemory("camera", path)
    assert memory.recall(SIZE) is None
    memory.keep(FocalEstimate(SIZE, 600.0, 10.0, 30))
    assert memory.recall(SIZE) is not None


def test_it_lies_in_the_user_s_configuration_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    FocalMemory("camera").keep(FocalEstimate(SIZE, 600.0, 10.0, 30))
    assert (tmp_path / "ashe-live" / "focal_lengths.json").is_file()
