"""What flags say of the table and of what is shown holds from the first picture on."""

from collections.abc import Callable

import pytest

from ashe_live.commands.flags.options import parsed
from ashe_live.commands.flags.setup import make_tracker
from ashe_live.commands.viewing.setup import ViewerSetup, opened_session
from ashe_live.core.caster import Caster
from ashe_live.quality import BALANCED, FAST
from ashe_live.viewer.session import Session
from tests.viewer.conftest import FakeSource

pytestmark = pytest.mark.usefixtures("instant")


def session_of(*flags: str, shows_light: bool = False, **kind: bool) -> Session:
    """The session of a clip, or of a source of another kind, that is played with these flags."""
    options = parsed(["play", "clip.mp4", *flags])
    setup = ViewerSetup(FakeSource(**kind), make_tracker(options), options, shows_light=shows_light)
    with opened_session(setup) as session:
        return session


@pytest.mark.parametrize(
    ("flag", "is_so"),
    [
        ("--mirror", lambda session: session.view.is_mirrored),
        ("--auto", lambda session: session.automatic),
        ("--hide-marker", lambda session: session.view.wants_cover is True),
        ("--no-hide-marker", lambda session: session.view.wants_cover is False),
    ],
)
def test_a_switch_is_on_where_it_was_given_alone(flag: str, is_so: Callable[[Session], bool]) -> None:
    assert is_so(session_of(flag))
    assert not is_so(session_of())


def test_the_light_is_estimated_as_the_flags_say() -> None:
    given = session_of("--light", "sun", "--caster", "sphere:0.02", "--quality", "fast")
    assert given.watch.preset == FAST.light.assuming("sun", Caster.sphere(0.02))
    assert session_of().watch.preset == BALANCED.light


def test_a_camera_is_waited_for_a_key_and_a_clip_and_a_photo_are_not() -> None:
    assert session_of().first.awaits_steady
    assert session_of(is_photo=True).first.awaits_steady
    assert not session_of(is_live=True).first.awaits_steady
    assert not session_of("--estimate-at", "7").first.awaits_steady


def test_the_marker_and_what_is_shown_are_those_of_the_setup() -> None:
    for shows_light in (False, True):
        session = session_of("--marker", "aruco:4x4_50:7", shows_light=shows_light)
        assert session.view.shows_light is shows_light
        assert session.arrangement.followed == "aruco:4x4_50:7"
