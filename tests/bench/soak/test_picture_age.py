"""The age of a picture on the screen, by clocks that are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.bench.soak.offscreen_window import ShownPicture
from ashe_live.bench.soak.picture_age import PictureAges
from ashe_live.bench.soak.time_code import paint_number

TAKEN_S = {0: 10.0, 1: 10.1, 2: 10.2, 3: 10.3, 4: 10.4}
TRACKED_MS = 12.0


class Screen:
    """A camera, a window and a session in one: what is on the screen is the last picture that was put there."""

    def __init__(self) -> None:
        self.tracked: SimpleNamespace | None = SimpleNamespace(detect_ms=TRACKED_MS)
        self.ages = PictureAges(self, self, self)
        self._number: int | None = None

    def taken_s(self, number: int) -> float:
        return TAKEN_S[number]

    def read_bgr(self) -> np.ndarray:
        image = np.zeros((240, 320, 3), np.uint8)
        if self._number is not None:
            paint_number(image, self._number)
        return image

    def show(self, number: int | None, begun_s: float, drawn_ms: float = 20.0) -> None:
        self._number = number
        self.ages.add(ShownPicture(begun_s, begun_s + drawn_ms / 1e3, 0.0))


def test_a_picture_is_as_old_as_the_time_since_it_was_taken_and_bound_by_its_own_work_and_an_interval() -> None:
    """Begun 40, 50 and 45 ms after they were taken, a tenth of a second apart; each is drawn within 20 ms."""
    screen = Screen()
    for number, begun_s in enumerate((10.04, 10.15, 10.245)):
        screen.show(number, begun_s)
    found = screen.ages.to_json()
    # The first picture has no display interval before it, and no bound.
    assert (found["pictures"], found["unread"], found["backwards"]) == (2, 0, 0)
    assert found["age_ms"]["p50"] == pytest.approx((70 + 65) / 2)
    over_ms = [70 - TRACKED_MS - 20 - 110, 65 - TRACKED_MS - 20 - 95]
    assert found["over_bound_ms"]["p50"] == pytest.approx(np.mean(over_ms))
    assert found["longest_over_bound_ms"] == pytest.approx(max(over_ms))
    assert (found["within_bound_share"], found["within_hand_over_share"]) == (1, 1)


def test_what_is_older_than_its_work_and_an_interval_is_beyond_the_bound() -> None:
    screen = Screen()
    screen.show(None, 9.0)
    for number, late_ms in enumerate((8.0, 0.5, 5.5, 4.5, -0.5)):
        begun_s = TAKEN_S[number] + (TRACKED_MS + 16 + late_ms) / 1e3
        screen.show(None, begun_s - 0.016)  # the picture before it on a display of 60 Hz, which is not read
        screen.show(number, begun_s)
    found = screen.ages.to_json()
    assert (found["pictures"], found["unread"]) == (5, 5)
    assert found["longest_over_bound_ms"] == pytest.approx(8.0)
    assert found["over_bound_ms"]["p50"] == pytest.approx(4.5)
    assert found["within_bound_share"] == pytest.approx(1 / 5)
    # Python lets go of its lock within 5 ms.
    assert found["within_hand_over_share"] == pytest.approx(3 / 5)


def test_a_repeated_picture_counts_once_and_one_of_before_goes_backwards() -> None:
    screen = Screen()
    for number in (0, 1, 1, 1, 3, 2):
        screen.show(number, 11.0)
    found = screen.ages.to_json()
    assert (found["pictures"], found["backwards"]) == (3, 1)


def test_without_a_tracked_frame_there_is_no_age() -> None:
    screen = Screen()
    screen.tracked = None
    for number in (0, 1):
        screen.show(number, 11.0)
    found = screen.ages.to_json()
    assert found["pictures"] == 0
    for figure in ("age_ms", "over_bound_ms", "longest_over_bound_ms", "within_bound_share", "within_hand_over_share"):
        assert found[figure] is None
