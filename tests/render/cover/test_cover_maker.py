"""When another cover is made after an attempt that failed."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.render.cover import cover_maker
from ashe_live.render.cover.cover_maker import RETRIED_S, CoverMaker


def frame_at(time_s: float) -> Any:
    return SimpleNamespace(frame=SimpleNamespace(time_s=time_s), T_room_marker=None)


@pytest.fixture
def attempts(monkeypatch: pytest.MonkeyPatch) -> list[Illumination]:
    """Those at a cover, all of which fail."""
    attempts: list[Illumination] = []
    monkeypatch.setattr(cover_maker, "ground_cover", lambda _tracked, lit, _is_draft=False: attempts.append(lit))
    return attempts


def test_in_one_light_another_attempt_follows_after_a_while(attempts: list[Illumination]) -> None:
    maker, lit = CoverMaker(), Illumination()
    for time_s in (0.0, 0.1, 0.9 * RETRIED_S):
        maker.make(frame_at(time_s), lit, waits=True, is_touched=False)
    assert len(attempts) == 1
    maker.make(frame_at(RETRIED_S), lit, waits=True, is_touched=False)
    assert len(attempts) == 2


def test_in_another_light_it_follows_at_once_as_the_time_of_a_photo_stands_still(attempts: list[Illumination]) -> None:
    """The shadow that hid too much ground may be another one now."""
    maker, photo = CoverMaker(), frame_at(0.0)
    other = Illumination((Light(np.array([0.0, 0.6, 0.8])),))
    for lit in (Illumination(), other):
        for _ in range(3):
            maker.make(photo, lit, waits=True, is_touched=False)
    assert [len(lit.lights) for lit in attempts] == [0, 1]


def test_while_a_light_eases_to_another_no_attempt_follows_each_frame(attempts: list[Illumination]) -> None:
    maker = CoverMaker()
    for i in range(5):
        lit = Illumination((Light(np.array([0.0, 0.6, 0.8])),))  # each frame has one of its own
        maker.make(frame_at(0.03 * i), lit, waits=False, is_touched=False)
        while not maker.is_settled:
            maker.take(frame_at(0.03 * i), lit, waits=True)
    assert len(attempts) == 1
    maker.release()
