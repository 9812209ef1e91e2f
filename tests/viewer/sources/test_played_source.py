"""How frames and failures of the source that is shown reach the session."""

from types import SimpleNamespace

import pytest

from ashe_live.errors import UserError
from ashe_live.process.mailbox import LatestMailbox
from ashe_live.viewer.sources.played_source import PlayedSource

GONE = UserError("the camera came back with another size", "start again")


@pytest.fixture
def stage(make, fakes):
    """A session, a pipeline into which the test puts frames, and what is played of it."""

    def stage(**known):
        session = make()
        pipeline = SimpleNamespace(
            frames=LatestMailbox(), key_views=fakes.KeyViews(), is_camera=False, is_photo=False, has_ended=False,
            stall=None, status=None,
        )  # fmt: skip
        pipeline.__dict__.update(known)
        return session, pipeline, PlayedSource(pipeline, session, loop=False)

    return stage


@pytest.mark.parametrize("kind", ["is_camera", "is_photo", "has_ended"])
def test_the_light_is_watched_by_what_the_source_is(stage, fakes, kind) -> None:
    session, pipeline, played = stage(**{kind: True})
    assert session.watch.key_views is pipeline.key_views
    assert session.watch.camera_may_move is (kind == "is_camera")
    assert session.watch.is_photo is (kind == "is_photo")
    assert not played.is_at_last_frame, "none is shown yet"
    pipeline.frames.put(fakes.tracked(3))
    assert played.take_frame(0.0)
    assert played.is_at_last_frame is (kind != "is_camera")


def test_frames_reach_the_session_until_there_are_no_more(stage, fakes) -> None:
    session, pipeline, played = stage()
    assert not played.take_frame(0.0)
    pipeline.frames.put(fakes.tracked(3))
    assert played.take_frame(0.1)
    assert session.tracked.frame.index == 3
    pipeline.frames.close()
    assert not played.take_frame(0.2)
    assert played.status is None


def test_a_source_that_fails_says_so_once_and_for_good(stage, fakes, capfd) -> None:
    session, pipeline, played = stage()
    pipeline.status, pipeline.stall = "the end", "no picture for 3 s"
    assert played.status == pipeline.stall
    pipeline.stall = None
    assert played.status == "the end"
    pipeline.frames.put(fakes.tracked(3))
    pipeline.frames.close(GONE)
    assert played.take_frame(0.0)
    pipeline.stall = "no picture for 3 s"
    for _ in range(3):
        assert not played.take_frame(0.1)
        assert played.status == str(GONE)
    assert session.tracked.frame.index == 3
    assert capfd.readouterr().err.count(GONE.message) == 1


@pytest.mark.parametrize("error", [GONE, ZeroDivisionError("a bug")])
def test_one_that_never_showed_anything_and_a_bug_end_the_viewer(stage, error) -> None:
    _, pipeline, played = stage()
    pipeline.frames.close(error)
    with pytest.raises(type(error)):
        played.take_frame(0.0)
