"""Of what was to be recorded, the last picture: as a PNG, once the whole is done."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.capture.recording.last_picture import LastPicture
from ashe_live.errors import UserError

FIRST, LAST = (np.full((4, 6, 3), level, np.uint8) for level in (50, 200))


def test_the_last_one_is_written_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    with LastPicture(path) as recorder:
        for time_s, picture in enumerate((FIRST, LAST)):
            recorder.write(picture, float(time_s))
            assert not path.exists()
    np.testing.assert_array_equal(cv2.imread(str(path)), LAST)
    assert [each.name for each in tmp_path.iterdir()] == ["a.png"]


def test_without_a_picture_or_after_an_error_there_is_none(tmp_path: Path) -> None:
    with LastPicture(tmp_path / "a.png"):
        pass

    def fail() -> None:
        with LastPicture(tmp_path / "a.png") as recorder:
            recorder.write(FIRST, 0.0)
            raise UserError("the source has failed", "start again")

    with pytest.raises(UserError, match="the source has failed"):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_is_replaced_only_when_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    for overwrite, name in ((False, "a.png"), (False, "a-2.png"), (True, "a.png")):
        with LastPicture(path, overwrite) as recorder:
            recorder.write(LAST if overwrite else FIRST, 0.0)
        assert recorder.path == tmp_path / name
    np.testing.assert_array_equal(cv2.imread(str(path)), LAST)
