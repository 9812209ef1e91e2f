"""The marker on a screen."""

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.windows.marker_window import on_white, room_beside


@pytest.mark.parametrize("size", [(720, 720), (1920, 1080), (300, 500)])
def test_the_tracker_finds_it_in_a_window_of_any_shape(size):
    marker = parse_marker("aruco:4x4_50:3")
    picture = on_white(marker.bitmap(960), size)
    tracker = MarkerTracker(marker, Camera.from_hfov(size, 60), 0.08, BALANCED.tracking)
    tracked = tracker.track(Frame(picture, 0, 0.0))
    assert picture.shape == (size[1], size[0], 3)
    assert tracked.marker is not None
    assert tracked.marker.corners_px.mean(axis=0) == pytest.approx(((size[0] - 1) / 2, (size[1] - 1) / 2), abs=1)


@pytest.mark.parametrize(("size", "has_room"), [((1200, 300), True), ((1920, 600), True), ((720, 720), False)])
def test_text_beside_it_leaves_its_margin_white(size, has_room):
    room = room_beside(size)
    assert (room is not None) is has_room
    inked = np.flatnonzero((on_white(np.zeros((100, 100), np.uint8), size) < 255).any(axis=(0, 2)))
    assert room is None or room < inked[0] - 0.1 * (inked[-1] - inked[0])
