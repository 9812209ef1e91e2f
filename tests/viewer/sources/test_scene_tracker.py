"""What is kept of a scene while its source goes on, jumps, begins again, is lost, or another marker is followed."""

from collections.abc import Callable

import pytest

from ashe_live.light.live.key_views import KeyViews
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.viewer.sources import scene_tracker
from ashe_live.viewer.sources.scene_tracker import SceneTracker


@pytest.fixture
def views(monkeypatch) -> list[object]:
    """The frames that are kept as views."""
    kept: list[object] = []
    monkeypatch.setattr(KeyViews, "add", lambda _self, tracked: kept.append(tracked))
    monkeypatch.setattr(KeyViews, "drop", lambda _self, _views=None: kept.clear())
    return kept


class Place:
    """Where the marker lies; `forgotten` counts what it was told."""

    def __init__(self) -> None:
        self.forgotten, self.rewound = 0, 0

    def add(self, tracked: object) -> object:
        return tracked

    def forget(self) -> None:
        self.forgotten += 1

    def rewind(self) -> None:
        self.rewound += 1


@pytest.fixture
def place(monkeypatch) -> Place:
    one = Place()
    monkeypatch.setattr(scene_tracker, "MarkerPlace", lambda: one)
    return one


@pytest.fixture
def tracker(fakes):
    return fakes.Tracker()


@pytest.fixture
def scene(tracker, place, views, fakes) -> SceneTracker:  # noqa: ARG001
    """Which has kept a view."""
    scene = SceneTracker(tracker, KeyViews())
    seen = scene.track(fakes.tracked(0).frame)
    assert views == [], "apart from tracking, which is waited for"
    scene.keep_view(seen)
    assert views == [seen]
    return scene


def jump(scene: SceneTracker) -> None:
    scene.jump()


def lose(scene: SceneTracker) -> None:
    scene.lose()


@pytest.mark.parametrize(("happens", "resets", "jumps"), [(jump, 0, 1), (lose, 1, 0)])
def test_what_was_seen_before_a_cut_is_not_compared_with_what_comes_next(
    scene, tracker, place, views, happens: Callable[[SceneTracker], None], resets: int, jumps: int
) -> None:
    """After a jump the marker is looked for near by first; of a source that was lost nothing is known any more."""
    happens(scene)
    assert views == []
    assert (tracker.resets, tracker.jumps) == (resets, jumps)
    assert (place.forgotten, place.rewound) == (1, 0), "a step back leads to frames where it lay elsewhere"


def test_from_the_start_nothing_is_known_but_views_of_the_very_same_frames(scene, tracker, place, views) -> None:
    scene.rewind(keeps_views=True)
    assert len(views) == 1
    scene.rewind()
    assert views == []
    assert (tracker.resets, place.rewound) == (2, 2)


@pytest.mark.parametrize("spec", ["aruco:4x4_50:0", "aruco:4x4_50:7"])
def test_another_camera_s_views_are_others_and_another_marker_lay_elsewhere_before(
    scene, tracker, place, views, fakes, spec: str
) -> None:
    other = fakes.Tracker()
    other.marker = parse_marker(spec)
    scene.follow(other)
    assert views == []
    assert (place.forgotten, place.rewound) == (1, int(spec != tracker.marker.spec))
    scene.jump()
    assert (tracker.jumps, other.jumps) == (0, 1)
