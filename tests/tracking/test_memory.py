"""What the tracker remembers of a frame."""

import numpy as np

from ashe_live.core.types import MarkerPose
from ashe_live.tracking.memory import Memory

SQUARE = np.array([(0, 0), (100, 0), (100, 100), (0, 100)], dtype=np.float64)


def test_a_member_that_is_forgotten_is_not_expected_and_the_memory_of_before_keeps_it() -> None:
    pose = MarkerPose(np.eye(4), SQUARE, 1.0, 0.0, None)
    corners = {0: SQUARE, 6: SQUARE + 200}
    before = Memory(0.0, np.zeros((4, 4, 3), np.uint8), pose, corners, {}, {}, 0, False)
    assert before.of_members(range(6)).expected_px(0.1).keys() == {0}
    assert before.expected_px(0.1).keys() == {0, 6}
    assert before.of_members(range(7)) is before
