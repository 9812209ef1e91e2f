"""Which marker is followed next, and what is said of it."""

from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.models.catalogue import ChosenModel
from ashe_live.tracking.families.seen_instead import SeenInstead
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.followed_marker import FIELDS_OF_VIEW_DEG, FollowedMarker
from ashe_live.viewer.sources.marker_hunt import MarkerHunt
from ashe_live.viewer.table.shelf import Shelf

ZERO, THREE, SEVEN, TAG = "aruco:4x4_50:0", "aruco:4x4_50:3", "aruco:4x4_50:7", "apriltag:36h11:3"


class FakePipeline:
    """Of a source whose marker may be chosen, unless told otherwise."""

    is_photo = False

    def __init__(self, may_follow_others: bool = True, marker: str = ZERO) -> None:
        self.may_follow_others, self.marker = may_follow_others, marker
        self.followed: list[str] = []
        self.seen_by: list[float | None] = []

    def follow(self, spec: str) -> None:
        self.marker = spec
        self.followed.append(spec)

    def see_by(self, hfov_deg: float | None) -> None:
        self.seen_by.append(hfov_deg)


@pytest.fixture
def make(fakes, monkeypatch: pytest.MonkeyPatch):
    """A FollowedMarker and what it works with; `finds` are the markers that a search finds, at once."""

    def made(takes_any_marker: bool = True, others: tuple[ChosenModel, ...] = (), **how) -> SimpleNamespace:
        stage = SimpleNamespace(pipeline=FakePipeline(**how), renderer=fakes.Renderer(), announced=[], finds=(), asks=0)
        shelf = Shelf("tree", 0.08, others=["mug"]) if others else fakes.Shelf()
        stage.session = Session(shelf, fakes.Worker(), FirstEstimate(), others=others)

        def look(hunt: MarkerHunt, tracked: TrackedFrame | None, _now_s: float) -> bool:
            before = hunt.seen_instead.in_view
            hunt.seen_instead = SeenInstead(() if tracked is None or tracked.marker is not None else stage.finds)
            hunt._answer, hunt._is_asked = (stage.finds if hunt._is_asked else None), False
            return bool(hunt.seen_instead.in_view) and hunt.seen_instead.in_view != before

        monkeypatch.setattr(MarkerHunt, "look", look)
        stage.followed = FollowedMarker(
            stage.pipeline,
            stage.session,
            stage.renderer,
            lambda text, _at_s: stage.announced.append(text),
            takes_any_marker,
        )
        return stage

    return made


@pytest.mark.parametrize("takes_any_marker", [True, False])
def test_the_only_one_in_view_is_followed_where_nobody_named_any(make, fakes, takes_any_marker):
    stage = make(takes_any_marker)
    stage.finds = (ZERO, SEVEN)  # the one that is followed may be seen before it is tracked
    stage.session.take(fakes.tracked(0, has_marker=False), 0.0)
    stage.followed.look(0.0)
    assert stage.session.seen_instead.in_view == (ZERO, SEVEN)
    assert stage.pipeline.followed == ([SEVEN] if takes_any_marker else [])
    assert stage.session.arrangement.followed == stage.pipeline.marker
    assert len(stage.announced) == takes_any_marker
    if takes_any_marker:
        assert stage.announced == ["aruco:4x4_50:7 is followed now: --marker aruco:4x4_50:7 names it from the start"]
        assert stage.followed.flags([]) == [f"--marker={SEVEN}"]
    else:
        stage.followed.follow_other(0.1)
        assert stage.pipeline.followed == [SEVEN]


def test_of_several_none_is_followed_unasked(make, fakes):
    stage = make()
    stage.finds = (SEVEN, TAG)
    stage.session.take(fakes.tracked(0, has_marker=False), 0.0)
    stage.followed.look(0.0)
    assert stage.session.seen_instead.in_view == (SEVEN, TAG)
    assert stage.pipeline.followed == []


def test_one_on_which_a_model_of_its_own_stands_is_not_followed_unasked(make, fakes):
    stage = make(others=(ChosenModel("mug", SEVEN),))
    stage.session.take(fakes.tracked(0, has_marker=False), 0.0)
    for finds, followed in (((SEVEN,), []), ((SEVEN, TAG), [TAG])):
        stage.finds = finds
        stage.followed.look(0.0)
        assert stage.pipeline.followed == followed


def test_once_the_marker_was_seen_no_other_takes_its_place_unasked(make, fakes):
    stage = make()
    stage.finds = (SEVEN,)
    stage.session.take(fakes.tracked(0), 0.0)
    stage.followed.look(0.0)
    stage.session.take(fakes.tracked(1, has_marker=False), 0.1)
    stage.followed.look(0.1)
    assert stage.session.seen_instead.in_view == (SEVEN,)
    assert stage.pipeline.followed == []
    stage.followed.follow_other(0.2)
    assert stage.pipeline.followed == [SEVEN]
    assert len(stage.renderer.begun_after) == 1, "the ground over the last marker is not that around another"
    assert stage.session.tracked is None


def test_who_asks_again_and_again_goes_round_by_name(make, fakes):
    stage = make()
    stage.finds = (SEVEN, ZERO, THREE)
    for at in range(4):
        stage.session.take(fakes.tracked(at), at)
        stage.followed.follow_other(at)
        assert stage.session.notice.text == "looking for other markers"
        stage.followed.look(at)
    assert stage.pipeline.followed == [THREE, SEVEN, ZERO, THREE]


def test_who_asks_where_there_is_no_other_learns_that(make, fakes):
    stage = make()
    stage.finds = (ZERO,)
    stage.session.take(fakes.tracked(0), 0.0)
    stage.followed.follow_other(0.0)
    stage.followed.look(0.0)
    assert stage.session.notice.text == "no other marker is in view"
    assert stage.pipeline.followed == []


def test_the_demo_keeps_its_marker_and_its_camera(make, fakes):
    stage = make(may_follow_others=False)
    stage.finds = (SEVEN,)
    stage.session.take(fakes.tracked(0, has_marker=False), 0.0)
    stage.followed.look(0.0)
    stage.followed.follow_other(0.0)
    assert "there is no other to follow" in stage.session.notice.text
    stage.followed.next_field_of_view(0.1)
    assert "field of view" in stage.session.notice.text
    assert (stage.pipeline.followed, stage.pipeline.seen_by, stage.followed.flags(["--hfov=71"])) == (
        [],
        [],
        ["--hfov=71"],
    )


def test_fields_of_view_go_round_and_the_flags_say_the_present_one(make, fakes):
    stage = make()
    stage.followed.next_field_of_view(0.0)
    assert stage.pipeline.seen_by == [], "without a picture, its shape is not known"
    stage.session.take(fakes.tracked(0), 0.0)
    seen = []
    for _ in range(len(FIELDS_OF_VIEW_DEG) + 2):
        stage.followed.next_field_of_view(0.0)
        seen.append(stage.followed.flags([])[1:])
    assert stage.pipeline.seen_by == [*FIELDS_OF_VIEW_DEG, None, FIELDS_OF_VIEW_DEG[0]]
    assert seen == [*([f"--hfov={deg:g}"] for deg in FIELDS_OF_VIEW_DEG), [], ["--hfov=50"]]
    assert stage.announced[0] == "the field of view is taken for 50° now: --hfov 50 sets this from the start, G goes on"
    assert stage.announced[4] == "the field of view is as it was at the start"


@pytest.mark.parametrize("camera", ["--camera-file=camera.json", "--focal-px=700.0", "--hfov=71"])
def test_a_chosen_field_of_view_takes_the_place_of_the_camera_that_was_given(make, fakes, camera):
    """A command takes one of these flags."""
    stage = make()
    given = ["--no-filter", "--marker-size=0.15", camera]
    stage.session.take(fakes.tracked(0), 0.0)
    assert stage.followed.flags(given) == [*given, f"--marker={ZERO}"]
    stage.followed.next_field_of_view(0.0)
    assert stage.followed.flags(given) == [*given[:2], f"--marker={ZERO}", f"--hfov={FIELDS_OF_VIEW_DEG[0]:g}"]


def test_beside_a_paper_cube_that_is_followed_now_no_caster_is_named(make, fakes):
    """A command refuses both."""
    stage = make()
    given = ["--caster=box:0.06x0.04x0.12"]
    stage.session.take(fakes.tracked(0, has_marker=False), 0.0)
    assert stage.followed.flags(given) == [*given, f"--marker={ZERO}"]
    stage.finds = ("cube",)
    stage.followed.look(0.0)
    assert stage.followed.flags(given) == ["--marker=cube"]


def test_of_an_upright_picture_they_count_along_its_height(make):
    stage = make()
    upright = Frame(np.zeros((96, 54, 3), np.uint8), 0, 0.0)
    stage.session.take(TrackedFrame(upright, Camera.assumed((54, 96)), None), 0.0)
    stage.followed.next_field_of_view(0.0)
    high = np.tan(np.radians(FIELDS_OF_VIEW_DEG[0]) / 2)
    assert stage.pipeline.seen_by == [round(np.degrees(2 * np.arctan(high * 54 / 96)))]


def test_another_source_begins_without_the_choices_for_the_last(make, fakes):
    stage = make()
    stage.session.take(fakes.tracked(0, has_marker=False), 0.0)
    stage.finds = (SEVEN, TAG)
    stage.followed.look(0.0)
    stage.followed.next_field_of_view(0.0)
    later = FakePipeline(marker=THREE)
    stage.followed.begin_anew(later)
    assert stage.session.arrangement.followed == THREE
    assert stage.followed.flags([]) == [f"--marker={THREE}"]
    stage.followed.follow_other(1.0)
    assert later.followed == [], "what was in view of the last source is not in view of this one"
