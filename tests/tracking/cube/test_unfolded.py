"""The cube's sheet before it is folded is no cube, and whoever shows it to the camera is told so."""

import cv2
import numpy as np
import PIL.Image
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame
from ashe_live.tracking.cube.faces import FACES, TAG_SHARE
from ashe_live.tracking.cube.sheet import write_cube_sheet
from ashe_live.tracking.cube.unfolded import UNFOLDED, lies_unfolded
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from tests.conftest import pose_of
from tests.painted_cubes import CAMERA as CAMERA_OF_CUBES
from tests.painted_cubes import CubeScene, frame_of, looking, sun

SIZE = 640, 480
CAMERA = Camera.from_hfov(SIZE, 60)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Image:
    path = tmp_path_factory.mktemp("cube") / "sheet.png"
    write_cube_sheet(path, cube_layout(), 0.06)
    with PIL.Image.open(path) as opened:
        return np.asarray(opened.convert("RGB").resize((840, 1188)))


def on_a_table(page: Image, corners_px: Float) -> Image:
    """(480, 640, 3): the page with its corners there, on a grey table."""
    height, width = page.shape[:2]
    page_px = np.array([(0, 0), (width, 0), (width, height), (0, height)], np.float32)
    homography = cv2.getPerspectiveTransform(page_px, corners_px.astype(np.float32))
    table = np.full((SIZE[1], SIZE[0], 3), 120, np.uint8)
    return np.asarray(
        cv2.warpPerspective(page, homography, SIZE, dst=table, flags=cv2.INTER_AREA, borderMode=cv2.BORDER_TRANSPARENT)
    )


@pytest.mark.parametrize(
    "corners_px",
    [
        [(150, 10), (480, 10), (480, 470), (150, 470)],
        [(210, 60), (450, 70), (560, 460), (90, 450)],
        [(620, 120), (600, 400), (60, 470), (90, 40)],
    ],
    ids=["from above", "obliquely", "on its side"],
)
def test_the_sheet_in_view_is_no_cube(page: Image, corners_px: list[tuple[int, int]]) -> None:
    image = on_a_table(page, np.array(corners_px))
    tracked = MarkerTracker(cube_layout(), CAMERA, 0.06, BALANCED).track(Frame(image, 0, 0.0))
    assert tracked.marker is None
    assert tracked.note == UNFOLDED


@pytest.mark.parametrize("eye", [(0.3, -0.25, 0.3), (-0.3, 0.2, 0.15), (0.05, -0.4, 0.35)])
def test_a_folded_cube_is_not_taken_for_a_sheet(eye: tuple[float, float, float]) -> None:
    """Not even if all five squares were seen through it."""
    T_cam_cube = pose_of(eye)
    squares = {number: project(CAMERA, T_cam_cube, 0.06 * face.corners(TAG_SHARE)) for number, face in enumerate(FACES)}
    assert not lies_unfolded(squares)
    assert not lies_unfolded({number: squares[number] for number in (0, 1, 2, 4)})
    # Fewer say nothing, as the corners of any one of them lie on a plane.
    for numbers in ((0,), (1,), (0, 1), (0, 1, 2)):
        assert not lies_unfolded({number: squares[number] for number in numbers})


@pytest.mark.parametrize(("off", "is_flat"), [(0.05, True), (0.15, False)])
def test_a_sheet_may_be_a_little_wavy(off: float, is_flat: bool) -> None:
    """`off`: RMS distance of the corners from a flat sheet's, over a square's side."""
    side_px, rng = 60.0, np.random.default_rng(3)
    edge_px = side_px / TAG_SHARE
    squares = {}
    for number, face in enumerate(FACES):
        middle = 100 + edge_px * np.array((face.column, face.row))
        upright = side_px / 2 * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
        # Turned counter-clockwise, a print begins at another corner of the same square.
        turned = np.roll(upright, face.turns, axis=0)
        squares[number] = middle + turned + rng.normal(0, off * side_px / 2**0.5, (4, 2))
    assert lies_unfolded(squares) is is_flat


def test_what_has_no_extent_is_no_sheet() -> None:
    assert not lies_unfolded({number: np.full((4, 2), 100.0) for number in range(len(FACES))})


def test_once_it_is_folded_nothing_more_is_said(page: Image) -> None:
    sheet = on_a_table(page, np.array([(150, 10), (480, 10), (480, 470), (150, 470)]))
    cube = frame_of(CubeScene(CAMERA_OF_CUBES, looking(0.35, 50, 40), [sun(200, 40)])).image_bgr
    tracker = MarkerTracker(cube_layout(), CAMERA_OF_CUBES, 0.06, BALANCED)
    notes = [tracker.track(Frame(image, k, 0.03 * k)).note for k, image in enumerate((sheet, sheet, cube, cube))]
    assert notes == [UNFOLDED, UNFOLDED, None, None]
