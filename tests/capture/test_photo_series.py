"""The photos of a folder as one source, as a calibration reads them."""

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.photo_series import PhotoSeries
from ashe_live.errors import UserError


def photo(path: Path, grey: int, size: tuple[int, int] = (60, 40)) -> None:
    PIL.Image.fromarray(np.full((size[1], size[0], 3), grey, np.uint8)).save(path)


def greys(series: PhotoSeries) -> list[tuple[int, int, float]]:
    return [(int(frame.image_bgr[0, 0, 0]), frame.index, frame.time_s) for frame in series]


def test_photos_come_by_their_names_and_again_after_a_rewind(tmp_path: Path) -> None:
    for name, grey in (("b.png", 20), ("a.png", 10), ("c.png", 30)):
        photo(tmp_path / name, grey)
    with PhotoSeries(tmp_path) as series:
        assert (series.name, series.size, series.note) == (tmp_path.name, (60, 40), None)
        assert not series.is_live
        assert greys(series) == [(10, 0, 0.0), (20, 1, 1.0), (30, 2, 2.0)]
        assert series.read() is None
        series.rewind()
        assert len(greys(series)) == 3
        series.rewind()
    assert series.read() is None, "it is closed"


def test_one_of_another_size_is_named_and_passed_by_nobody(tmp_path: Path) -> None:
    photo(tmp_path / "a.png", 10)
    photo(tmp_path / "b.png", 20, (40, 60))
    series = PhotoSeries(tmp_path)
    assert series.read() is not None
    for _ in range(2):
        with pytest.raises(UserError, match=r"b\.png has 40x60 pixels, and the first photo 60x40"):
            series.read()


def test_a_folder_without_a_photo_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("f/8")
    with pytest.raises(UserError, match="there is no photo in the folder"):
        PhotoSeries(tmp_path)
