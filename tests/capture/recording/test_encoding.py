"""Pictures of an even size, in the range of video."""

import numpy as np
import pytest
from av.video.frame import VideoFrame

from ashe_live.capture.recording.encoding import converted, even_size
from ashe_live.errors import UserError


@pytest.mark.parametrize(
    ("size", "even"), [((640, 480), (640, 480)), ((641, 479), (640, 478)), ((2, 2), (2, 2)), ((3, 3), (2, 2))]
)
def test_an_odd_last_column_or_row_is_left_out(size: tuple[int, int], even: tuple[int, int]) -> None:
    assert even_size(size) == even


@pytest.mark.parametrize("size", [(1, 480), (640, 1), (1, 1), (0, 0)])
def test_less_than_two_pixels_are_no_picture(size: tuple[int, int]) -> None:
    with pytest.raises(UserError, match=f"{size[0]}x{size[1]} cannot be recorded"):
        even_size(size)


@pytest.mark.parametrize(("level", "luma"), [(0, 16), (255, 235)])
def test_black_and_white_are_those_of_video(level: int, luma: int) -> None:
    """ITU-R BT.709, 3.4 and 3.5."""
    picture = VideoFrame.from_ndarray(np.full((16, 16, 3), level, np.uint8), "bgr24")
    planes = converted(picture, "yuv420p").to_ndarray()
    assert (planes[:16] == luma).all()
    assert (planes[16:] == 128).all()
