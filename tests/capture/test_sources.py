"""How large a picture may be, and which files can be opened."""

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.opening import openable
from ashe_live.capture.sources import MAX_PIXELS, refuse_too_large
from ashe_live.core.ranges import SIDE
from ashe_live.errors import UserError


def test_a_picture_has_as_many_pixels_as_are_allowed_and_not_one_row_more() -> None:
    path, side = Path("a.png"), 10_000
    rows = MAX_PIXELS // side
    for size in ((side, rows), (rows, side), (int(SIDE.high), 1), (1, int(SIDE.high))):
        refuse_too_large(path, size)
    for size in ((side, rows + 1), (rows + 1, side)):
        with pytest.raises(UserError, match=r"a\.png has more than 110 million pixels"):
            refuse_too_large(path, size)
    for size in ((int(SIDE.high) + 1, 1), (1, int(SIDE.high) + 1)):
        with pytest.raises(UserError, match=rf"a\.png is longer than {SIDE.high} pixels"):
            refuse_too_large(path, size)


def test_what_cannot_be_opened_is_passed_over(tmp_path: Path) -> None:
    names = ["a.png", "broken.png", "b.png", "missing.png"]
    for name in ("a.png", "b.png"):
        PIL.Image.fromarray(np.zeros((40, 60, 3), np.uint8)).save(tmp_path / name)
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nand no more")
    assert [source.name for source in openable([tmp_path / name for name in names])] == ["a.png", "b.png"]
