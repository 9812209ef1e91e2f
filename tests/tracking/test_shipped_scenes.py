"""The marker of the repository's own scenes, whose pose is known exactly."""

import math

import numpy as np
import pytest

from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from tests.shipped_scenes import CASES

MARKER, OTHER = "aruco:4x4_50:7", "aruco:4x4_50:8"


@pytest.mark.parametrize("name", CASES)
def test_the_pose_is_found_and_no_other_marker(name: str) -> None:
    case = CASES[name]
    found, other = (
        MarkerTracker(parse_marker(spec), case.camera, case.marker.side_m, BALANCED).track(case.tracked().frame).marker
        for spec in (MARKER, OTHER)
    )
    assert found is not None
    assert other is None
    turn = found.T_cam_marker[:3, :3] - case.marker.T_cam_marker[:3, :3]
    assert math.degrees(2 * math.asin(np.linalg.norm(turn) / math.sqrt(8))) < 1
    assert np.linalg.norm(found.corners_px - case.marker.corners_px, axis=1).max() < 0.6
