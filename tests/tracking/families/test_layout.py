"""A grid of markers: printed as it is tracked, and surer together than each alone."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.errors import UserError
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import Layout, parse_target
from ashe_live.tracking.families.printing import write_marker_sheet
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import frame, photographed, pose

CAMERA = Camera.from_focal((640, 480), 700)
SIDE_M = 0.04


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> tuple[Image, float]:
    """The printed page (h, w) and its metres a pixel."""
    path = tmp_path_factory.mktemp("sheet") / "grid.png"
    write_marker_sheet(path, parse_target("grid:4x4_50:3x2"), SIDE_M)
    page = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    assert page is not None
    small = cv2.resize(page, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8), 0.0254 / 600 * 4


def picture(sheet: tuple[Image, float], T_cam_grid: np.ndarray) -> Image:
    """(h, w, 3): the page as the camera sees it, the grid's middle at the pose's origin."""
    page, metres_per_px = sheet
    # The middle of the part above the foot of 45 mm.
    middle_px = (page.shape[1] - 1) / 2, (page.shape[0] - 0.045 / metres_per_px - 1) / 2
    return photographed(page, metres_per_px, middle_px, CAMERA, T_cam_grid)


def grid_tracker() -> MarkerTracker:
    return MarkerTracker(parse_target("grid:4x4_50:3x2"), CAMERA, SIDE_M, BALANCED.tracking)


def test_the_printed_grid_is_tracked_as_one_pose(sheet: tuple[Image, float]) -> None:
    truth, tracker = pose(0.45, 35, 10), grid_tracker()
    for index in range(3):
        found = tracker.track(frame(picture(sheet, truth), index)).marker
    assert found is not None
    assert np.abs(found.T_cam_marker[:3, :3] - truth[:3, :3]).max() < 0.002
    assert found.T_cam_marker[:3, 3] == pytest.approx(truth[:3, 3], abs=5e-4)


def test_the_whole_grid_is_surer_than_one_of_its_markers(sheet: tuple[Image, float]) -> None:
    tracker, image = grid_tracker(), picture(sheet, pose(0.45, 35, 10))
    alone = MarkerTracker(parse_target("aruco:4x4_50:0"), CAMERA, SIDE_M, BALANCED.tracking)
    whole, single = (each.track(frame(image)).marker for each in (tracker, alone))
    assert whole is not None
    assert single is not None
    assert np.trace(whole.covariance[:3, :3]) < 0.25 * np.trace(single.covariance[:3, :3])


def test_it_is_followed_while_a_hand_covers_most_of_it(sheet: tuple[Image, float]) -> None:
    truth, tracker = pose(0.45, 35, 10), grid_tracker()
    image = picture(sheet, truth)
    tracker.track(frame(image, 0))
    covered = image.copy()
    covered[:, :360] = 90
    for index in range(1, 4):
        found = tracker.track(frame(covered, index)).marker
        assert found is not None
        assert not found.bridged
        assert found.T_cam_marker[:3, 3] == pytest.approx(truth[:3, 3], abs=2e-3)


def test_a_grid_is_numbered_row_by_row_from_its_first() -> None:
    grid = parse_target("grid:5x5_100:3x2:7")
    assert isinstance(grid, Layout)
    assert [member.marker.spec for member in grid.members] == [f"aruco:5x5_100:{n}" for n in range(7, 13)]
    centres = np.array([member.corners.mean(axis=0) for member in grid.members])
    assert centres[0, 0] < centres[1, 0] < centres[2, 0]
    assert centres[0, 1] > centres[3, 1]
    assert centres.mean(axis=0) == pytest.approx((0, 0, 0), abs=1e-12)


@pytest.mark.parametrize(("size", "count"), [("1x2", 2), ("2x1", 2), ("4x6", 24), ("24x1", 24)])
def test_a_grid_has_from_two_markers_to_as_many_as_can_be_followed(size: str, count: int) -> None:
    grid = parse_target(f"grid:4x4_50:{size}")
    assert isinstance(grid, Layout)
    assert len(grid.members) == count
    assert grid.extent == pytest.approx([1.25 * int(side) - 0.25 for side in size.split("x")])


def test_who_names_no_marker_hears_of_all_that_there_are_and_beside_a_cube_of_flat_ones() -> None:
    with pytest.raises(UserError) as caught:
        parse_target("cubes")
    assert all(kind in caught.value.remedy for kind in ("aruco:", "apriltag:", "pattern:", "image:", "grid:", "cube"))
    with pytest.raises(UserError) as caught:
        parse_target("cube+nonsense")
    assert "aruco:" in caught.value.remedy
    assert "grid:" not in caught.value.remedy


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("grid:", "COLSxROWS"),
        ("grid:4x4_50", "COLSxROWS"),
        ("grid:4x4_50:3", "COLSxROWS"),
        ("grid:4x4_50:3xa", "COLSxROWS"),
        ("grid:4x4_50:3x2:a", "COLSxROWS"),
        ("grid::3x2", "COLSxROWS"),
        ("grid:4x4_50:1x1", "from 2 to 24"),
        ("grid:4x4_50:5x5", "from 2 to 24"),
        ("grid:4x4_50:999x999", "from 2 to 24"),
        ("grid:9x9_50:2x2", "4x4_50"),
        ("grid:4x4_50:3x2:48", "from 0 to 49"),
    ],
)
def test_a_wrong_grid_is_one_line_with_its_remedy(spec: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_target(spec)
    assert words in caught.value.remedy
