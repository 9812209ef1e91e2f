"""Pictures written whole, under names that never overwrite."""

from pathlib import Path

import cv2
import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.snapshot import write_png
from ashe_live.errors import UserError


def test_png_holds_the_very_pixels(tmp_path: Path) -> None:
    image = np.random.default_rng(0).integers(0, 256, (30, 41, 3), np.uint8)
    write_png(tmp_path / "a.png", image)
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "a.png")), image)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize("name", ["A.PNG", "a"])
def test_a_name_is_that_of_a_png_in_capitals_and_without_an_ending(tmp_path: Path, name: str) -> None:
    assert write_png(tmp_path / name, np.zeros((4, 4, 3), np.uint8)) == tmp_path / name


def test_texts_are_read_as_they_were_written(tmp_path: Path) -> None:
    texts = {"ashe-live": '{"azimuth": "30°"}', "Title": "a table"}
    write_png(tmp_path / "a.png", np.zeros((4, 4, 3), np.uint8), texts=texts)
    with PIL.Image.open(tmp_path / "a.png") as picture:
        assert picture.text == texts


def test_existing_picture_is_replaced_only_on_request(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    black, white = np.zeros((4, 4, 3), np.uint8), np.full((4, 4, 3), 255, np.uint8)
    write_png(path, black)
    with pytest.raises(UserError, match="exists already"):
        write_png(path, white)
    assert cv2.imread(str(path)).max() == 0
    write_png(path, white, overwrite=True)
    assert cv2.imread(str(path)).min() == 255


@pytest.mark.parametrize("name", ["a.jpg", "a.JPEG", "a.webp"])
def test_a_name_of_another_format_is_refused(tmp_path, name):
    with pytest.raises(ValueError, match=r"name it \.png"):
        write_png(tmp_path / name, np.zeros((4, 4, 3), np.uint8))
    assert list(tmp_path.iterdir()) == []
