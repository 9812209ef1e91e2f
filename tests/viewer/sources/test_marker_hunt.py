"""When other markers are looked for, and when what is found is news."""

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.families.seen_instead import ALL_BLACK, SeenInstead
from ashe_live.viewer.sources import marker_hunt
from ashe_live.viewer.sources.marker_hunt import EVERY_S, MarkerHunt
from tests.patience import await_that

SEVEN, FIVE = "aruco:4x4_50:7", "apriltag:36h11:5"


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[Future[SeenInstead]]:
    """The searches that were begun; the test ends them."""
    searches: list[Future[SeenInstead]] = []

    def begin(_name: str, _work: Callable[[], object], _failed: Callable[[str], UserError]) -> Future[SeenInstead]:
        searches.append(Future())
        return searches[-1]

    monkeypatch.setattr(marker_hunt, "in_background", begin)
    return searches


@pytest.fixture
def away(fakes):
    """A picture without the followed marker."""
    return fakes.tracked(0, has_marker=False)


@pytest.fixture
def there(fakes):
    """A picture with it."""
    return fakes.tracked(0)


def test_they_are_looked_for_one_search_at_a_time_and_once_in_a_while(begun, away):
    hunt = MarkerHunt()
    assert not hunt.look(None, 0.0)
    assert begun == []
    assert not hunt.look(away, 0.0)
    assert not hunt.look(away, 3 * EVERY_S)
    assert len(begun) == 1, "the first is not done yet"
    begun[0].set_result(SeenInstead((SEVEN,)))
    assert hunt.look(away, 3 * EVERY_S)
    assert not hunt.look(away, 3 * EVERY_S)
    begun[1].set_result(SeenInstead((SEVEN,)))
    hunt.look(away, 3.1 * EVERY_S)
    assert not hunt.look(away, 3.9 * EVERY_S)
    assert len(begun) == 2
    hunt.look(away, 4 * EVERY_S)
    assert len(begun) == 3


def test_what_is_seen_in_mirror_image_is_kept_until_the_marker_is_there(begun, away, there):
    hunt = MarkerHunt()
    hunt.look(away, 0.0)
    begun[0].set_result(SeenInstead(mirrored=(SEVEN,)))
    assert not hunt.look(away, 0.0), "there is none to follow"
    assert hunt.seen_instead == SeenInstead(mirrored=(SEVEN,))
    hunt.look(there, 0.1)
    assert hunt.seen_instead == SeenInstead()


def test_only_what_was_not_in_view_before_is_news(begun, away):
    hunt = MarkerHunt()
    told = []
    for at, found in enumerate([(SEVEN,), (SEVEN,), (SEVEN, FIVE), (), (FIVE,)]):
        hunt.look(away, at * EVERY_S)
        begun[-1].set_result(SeenInstead(found))
        told.append(hunt.look(away, at * EVERY_S))
        assert hunt.seen_instead.in_view == found
    assert told == [True, False, True, False, True]
    assert hunt.take_answer() is None, "nobody has asked"


def test_while_the_followed_marker_is_there_none_is_looked_for(begun, away, there):
    hunt = MarkerHunt()
    hunt.look(away, 0.0)
    begun[0].set_result(SeenInstead((SEVEN,)))
    hunt.look(away, 0.0)
    assert not hunt.look(there, EVERY_S)
    assert hunt.seen_instead.in_view == ()
    assert len(begun) == 1


def test_what_was_looked_for_before_the_marker_came_back_is_dropped(begun, away, there):
    hunt = MarkerHunt()
    hunt.look(away, 0.0)
    hunt.look(there, 0.1)
    begun[0].set_result(SeenInstead((SEVEN,)))
    assert not hunt.look(away, 0.2)
    assert hunt.seen_instead.in_view == ()
    hunt.look(away, EVERY_S)
    assert len(begun) == 2


def test_who_asks_is_answered_once_even_while_the_marker_is_there(begun, away, there):
    hunt = MarkerHunt()
    hunt.look(away, 0.0)
    hunt.ask()
    hunt.look(there, 0.1)
    assert len(begun) == 2, "anew, as what is looked at already may be older than the wish"
    begun[0].set_result(SeenInstead((FIVE,)))
    assert hunt.take_answer() is None
    begun[1].set_result(SeenInstead((SEVEN,)))
    assert not hunt.look(there, 0.2)
    assert hunt.seen_instead.in_view == ()
    assert hunt.take_answer() == (SEVEN,)
    assert hunt.take_answer() is None
    assert not hunt.look(there, 2 * EVERY_S)
    assert len(begun) == 2


def test_who_asks_while_it_is_away_learns_it_as_news_too(begun, away):
    hunt = MarkerHunt()
    hunt.ask()
    hunt.look(away, 0.0)
    begun[0].set_result(SeenInstead((SEVEN,)))
    assert hunt.look(away, 0.1)
    assert hunt.take_answer() == (SEVEN,) == hunt.seen_instead.in_view


def test_a_search_that_fails_has_found_nothing(begun, away):
    hunt = MarkerHunt()
    hunt.ask()
    hunt.look(away, 0.0)
    begun[0].set_exception(UserError("no memory", "close other programs"))
    assert not hunt.look(away, 0.1)
    assert hunt.take_answer() == ()


def paper(*specs: str, is_mirrored: bool = False) -> Image:
    """A sheet with prints side by side."""
    prints = [
        cv2.copyMakeBorder(parse_marker(spec).bitmap(120), *[40] * 4, cv2.BORDER_CONSTANT, value=230) for spec in specs
    ]
    sheet = np.hstack(prints)
    return cv2.cvtColor(np.ascontiguousarray(sheet[:, ::-1] if is_mirrored else sheet), cv2.COLOR_GRAY2BGR)


def test_what_a_picture_shows_is_found(away):
    hunt = MarkerHunt()
    plain, mirrored = paper(SEVEN), paper(FIVE, is_mirrored=True)
    for at, (image, instead) in enumerate(
        [
            (plain, SeenInstead((SEVEN,))),
            (mirrored, SeenInstead(mirrored=(FIVE,))),
            (np.hstack([mirrored, plain]), SeenInstead((SEVEN,))),
            (np.zeros_like(plain), SeenInstead(fault=ALL_BLACK)),
        ]
    ):
        tracked = replace(away, frame=Frame(image, at, 0.0), camera=Camera.from_hfov(image.shape[1::-1], 60))
        hunt.look(tracked, at * EVERY_S)
        await_that(lambda looking=hunt._looking: looking.done())
        assert hunt.look(tracked, at * EVERY_S) == bool(instead.in_view)
        assert hunt.seen_instead == instead
