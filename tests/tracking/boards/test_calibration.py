"""Calibration against cameras that are known: right to what it says, and refused where the views do not tell."""

import itertools
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera, read_camera_file
from ashe_live.core.transforms import project
from ashe_live.errors import UserError
from ashe_live.tracking.boards.calibration import MIN_VIEWS, calibrate
from ashe_live.tracking.boards.calibration_board import BoardView, CalibrationBoard
from tests.tracking.board_pictures import Lens, seen_from

BOARD = CalibrationBoard()
MIDDLE = np.array(BOARD.squares) / 2
POINTS = np.array([(x, y, 0.0) for y in range(1, BOARD.squares[1]) for x in range(1, BOARD.squares[0])])
SIZE = (640, 480)


def camera_of(focal_px: float, dist: tuple[float, ...] = (0.0,) * 5) -> Camera:
    K = np.array([(focal_px, 0, 331.0), (0, focal_px * 1.003, 229.0), (0, 0, 1)])
    return Camera(SIZE, K, np.array(dist), "file")


def poses(camera: Camera, count: int, tilt_deg: float = 35.0) -> list[Float]:
    """The board at half the picture's height, here and there, tilted by about `tilt_deg` to all sides."""
    random = np.random.default_rng(5)
    half_view = np.array(SIZE) / 2 / camera.K[0, 0]
    distance = BOARD.squares[1] * camera.K[0, 0] / (0.55 * SIZE[1])
    return [
        seen_from(
            distance * random.uniform(0.8, 1.2),
            tilt_deg * random.uniform(0.6, 1.2),
            360 * at / 7,
            MIDDLE,
            random.uniform(-0.55, 0.55, 2) * half_view,
            random.uniform(-20, 20),
        )
        for at in range(count)
    ]


def measured(camera: Camera, T_cam_board: Float, noise_px: float, seed: int) -> BoardView:
    """The corners that lie in the picture, as a detector with normal errors would find them."""
    corners = project(camera, T_cam_board, POINTS)
    inside = ((corners > 2) & (corners < np.array(SIZE) - 3)).all(axis=1)
    noise = np.random.default_rng(seed).normal(0, noise_px, corners.shape)
    return BoardView((corners + noise)[inside], POINTS[inside])


def views_of(camera: Camera, count: int = 16, tilt_deg: float = 35.0, noise_px: float = 0.1, seed: int = 0):
    return [
        measured(camera, pose, noise_px, 1000 * seed + at) for at, pose in enumerate(poses(camera, count, tilt_deg))
    ]


@pytest.mark.parametrize(
    ("focal_px", "dist"),
    [(600, (0.0,) * 5), (620, (-0.3, 0.1, 0.001, -0.001, 0.0)), (180, (-0.2, 0.03, 0.0, 0.0, 0.0))],
    ids=["straight", "barrel", "wide"],
)
def test_a_lens_is_measured_from_its_pictures(focal_px: float, dist: tuple[float, ...]) -> None:
    camera = camera_of(focal_px, dist)
    lens = Lens.of(camera)
    unit_px = 60
    sheet = BOARD.bitmap((BOARD.squares[0] * unit_px, BOARD.squares[1] * unit_px))
    sheet = cv2.copyMakeBorder(sheet, unit_px, unit_px, unit_px, unit_px, cv2.BORDER_CONSTANT, value=255)
    from_sheet = np.eye(4)
    from_sheet[:2, 3] = -1
    pictures = [lens.picture(sheet, pose @ from_sheet, unit_px, seed=at) for at, pose in enumerate(poses(camera, 16))]
    views = [view for view in map(BOARD.find, pictures) if view is not None]
    assert len(views) >= MIN_VIEWS
    found = calibrate(views, SIZE)
    assert found.rms_px < 0.25
    for at in (0, 1):
        assert found.camera.K[at, at] == pytest.approx(camera.K[at, at], rel=0.005)
        assert found.camera.K[at, 2] == pytest.approx(camera.K[at, 2], abs=max(1.0, 4 * found.sigma_c_px[at]))
    # What counts of distortion is where it puts things, not which coefficients say so.
    grid = np.array([(x, y, 1.0) for x in np.linspace(-0.8, 0.8, 9) for y in np.linspace(-0.8, 0.8, 9)])
    rays = grid * (*(np.array(SIZE) / 2 / focal_px), 1.0)
    apart = project(found.camera, np.eye(4), rays) - project(camera, np.eye(4), rays)
    assert np.linalg.norm(apart - apart.mean(axis=0), axis=1).max() < 1.5


def test_the_uncertainties_are_those_of_the_errors() -> None:
    camera = camera_of(600, (-0.1, 0.02, 0.0, 0.0, 0.0))
    in_sigmas = []
    for seed in range(6):
        found = calibrate(views_of(camera, seed=seed), SIZE)
        in_sigmas += list((found.camera.K[(0, 1), (0, 1)] - camera.K[(0, 1), (0, 1)]) / found.sigma_f_px)
        in_sigmas += list((found.camera.K[:2, 2] - camera.K[:2, 2]) / found.sigma_c_px)
    rms = float(np.sqrt(np.mean(np.square(in_sigmas))))
    assert 0.25 < rms < 1.3


def test_a_view_that_contradicts_the_others_is_left_out() -> None:
    camera = camera_of(600)
    views = views_of(camera)
    bent = views[3].points + np.column_stack([np.zeros((len(views[3].points), 2)), 0.15 * views[3].points[:, 0] ** 1.5])
    corners = project(camera, poses(camera, 16)[3], bent)
    views[3] = BoardView(corners, views[3].points)
    found = calibrate(views, SIZE)
    assert not found.used[3]
    assert found.used.sum() == len(views) - 1
    assert found.view_rms_px[3] > 3 * np.median(found.view_rms_px)
    assert found.camera.K[0, 0] == pytest.approx(600, rel=0.003)


def test_a_lens_without_distortion_gets_none() -> None:
    assert np.abs(calibrate(views_of(camera_of(600)), SIZE).camera.dist).max() < 0.01


@pytest.mark.parametrize("count", [0, 1, MIN_VIEWS - 1])
def test_too_few_views_are_refused(count: int) -> None:
    with pytest.raises(UserError, match="too few"):
        calibrate(views_of(camera_of(600), count), SIZE)


@pytest.mark.parametrize("focal_px", [100, 600, 3000])
def test_frontal_views_are_refused(focal_px: float) -> None:
    with pytest.raises(UserError, match=r"uncertain|do not determine"):
        calibrate(views_of(camera_of(focal_px), tilt_deg=2.0), SIZE)


def test_the_same_view_again_and_again_is_refused() -> None:
    camera = camera_of(600)
    pose = poses(camera, 1)[0]
    with pytest.raises(UserError, match=r"uncertain|do not determine"):
        calibrate([measured(camera, pose, 0.1, seed) for seed in range(MIN_VIEWS)], SIZE)


@pytest.mark.parametrize(("focal_px", "is_known"), [(100, True), (5000, True), (100_000, False)])
def test_extreme_focal_lengths_are_right_or_refused(focal_px: float, is_known: bool) -> None:
    """At 100,000 px a board half as high as the picture has no perspective left that could be measured."""
    views = views_of(camera_of(focal_px), count=24 if is_known else MIN_VIEWS)
    if not is_known:
        with pytest.raises(UserError, match=r"uncertain|do not determine"):
            calibrate(views, SIZE)
        return
    found = calibrate(views, SIZE)
    assert abs(found.camera.K[0, 0] - focal_px) < 4 * found.sigma_f_px[0]
    assert found.sigma_f_px[0] < 0.01 * focal_px


def test_corners_that_no_camera_can_see_are_refused() -> None:
    random = np.random.default_rng(1)
    views = [BoardView(random.uniform(0, 480, (len(POINTS), 2)), POINTS) for _ in range(MIN_VIEWS)]
    with pytest.raises(UserError):
        calibrate(views, SIZE)


def test_the_file_is_read_back_as_the_same_camera(tmp_path: Path) -> None:
    found = calibrate(views_of(camera_of(600, (-0.2, 0.05, 0.0, 0.0, 0.0))), SIZE)
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(found.to_json(), allow_nan=False))
    read = read_camera_file(path)
    assert read.size == SIZE
    np.testing.assert_array_equal(read.K, found.camera.K)
    np.testing.assert_array_equal(read.dist, found.camera.dist)
    content = json.loads(path.read_text())
    assert content["rms_px"] == found.rms_px
    assert all(value > 0 for value in itertools.chain(content["sigma"]["f_px"], content["sigma"]["c_px"]))
