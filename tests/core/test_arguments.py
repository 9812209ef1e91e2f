"""Wrong use from Python is named in words that can be read."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ashe_live.core import arguments
from ashe_live.core.light import Illumination


@pytest.mark.parametrize(
    ("value", "kind", "said"),
    [
        (3, Illumination, "light must be an Illumination, and is an int"),
        ("3", Illumination, "light must be an Illumination, and is a str"),
        (np.float64(3), Path, "light must be a Path, and is a float64"),
    ],
)
def test_the_kinds_that_are_and_should_be_are_named(value, kind, said):
    with pytest.raises(TypeError) as caught:
        arguments.instance(value, kind, "light")
    assert str(caught.value) == said


PICTURE = np.zeros((4, 6, 3), np.uint8)


def test_what_is_right_is_returned() -> None:
    assert arguments.picture(PICTURE, "image") is PICTURE
    assert arguments.picture_size([np.int64(640), 480], "size") == (640, 480)  # type: ignore[arg-type]
    assert arguments.path("a.png", "file") == arguments.path(Path("a.png"), "file") == Path("a.png")
    assert arguments.one_of("fast", ("fast", "slow"), "quality") == "fast"


@pytest.mark.parametrize(
    ("call", "error"),
    [
        (lambda: arguments.picture(PICTURE.tolist(), "image"), TypeError),
        (lambda: arguments.picture(PICTURE[..., 0], "image"), ValueError),
        (lambda: arguments.picture(PICTURE[..., :2], "image"), ValueError),
        (lambda: arguments.picture(PICTURE.astype(float), "image"), ValueError),
        (lambda: arguments.picture(PICTURE[:0], "image"), ValueError),
        (lambda: arguments.picture_size(640, "image size"), TypeError),
        (lambda: arguments.picture_size((640, 480, 3), "image size"), TypeError),
        (lambda: arguments.picture_size((640, True), "image size"), TypeError),
        (lambda: arguments.picture_size((640.0, 480), "image size"), TypeError),
        (lambda: arguments.picture_size((640, 0), "image size"), ValueError),
        (lambda: arguments.path(b"image.png", "image file"), TypeError),
        (lambda: arguments.path("a\0b", "image file"), ValueError),
        (lambda: arguments.path(3, "image file"), TypeError),
        (lambda: arguments.one_of("quick", ("fast", "slow"), "image quality"), ValueError),
        (lambda: arguments.one_of(None, ("fast", "slow"), "image quality"), TypeError),
    ],
)
def test_what_is_wrong_is_of_another_kind_or_value_and_named(
    call: Callable[[], object], error: type[Exception]
) -> None:
    with pytest.raises(error, match="image"):
        call()
