from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame

SIZE = (96, 64)


def frames_of(path: Path) -> list[Frame]:
    with ClipSource(path) as source:
        return list(source)


@pytest.fixture
def picture() -> Callable[[int], Image]:
    """Frame number `i` of a test clip: its number can be read from where the white bar stands."""

    def draw(i: int) -> Image:
        image = np.full((SIZE[1], SIZE[0], 3), (60, 90, 140), np.uint8)
        image[:, i % 24 * 4 : i % 24 * 4 + 4] = 255
        return image

    return draw


@pytest.fixture
def clip(tmp_path: Path, picture: Callable[[int], Image]) -> Path:
    """60 frames at 25 a second."""
    path = tmp_path / "clip.mp4"
    with Recorder(path, SIZE, 25) as recorder:
        for i in range(60):
            recorder.write(picture(i), i / 25)
    return path


@pytest.fixture
def damaged_clip(clip: Path, tmp_path: Path) -> Path:
    """The same with zeros in its middle."""
    content = bytearray(clip.read_bytes())
    pictures = content.index(b"mdat")
    middle = pictures + (len(content) - pictures) * 3 // 5
    content[middle : middle + 200] = bytes(200)
    damaged = tmp_path / "damaged.mp4"
    damaged.write_bytes(content)
    return damaged
