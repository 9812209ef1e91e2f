"""The printed sheet is found as wide as it was cut, on each side, whatever lies around it."""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project
from ashe_live.light.pixels.sheet import ADDED, USUAL, USUAL_SHEET, MarkerPicture, Sheet, measured_sheet
from ashe_live.light.pixels.shown_as_ground import outline_of
from tests.light.synthetic_masks import camera_towards

CAMERA = Camera.from_hfov((640, 480), 55.0)
SIDE_M = 0.08
T_CAM_MARKER = camera_towards((0.02, 0.01), 0.5, 50.0)
PX_PER_SIDE = 120
HALF = 3 * PX_PER_SIDE  # of the painted ground
PAPER, INK = 220, 30


def painted(extents: Sequence[float], ground: int, shadow_from: float | None = None) -> Image:
    """A picture of a sheet that reaches right, above, left and below so many sides on a grey ground.

    shadow_from: sides right of the centre beyond which all is in shadow.
    """
    plane = np.full((2 * HALF, 2 * HALF), ground, np.uint8)
    right, above, left, below = (round(each * PX_PER_SIDE) for each in extents)
    plane[HALF - above : HALF + below, HALF - left : HALF + right] = PAPER
    square = PX_PER_SIDE // 2
    plane[HALF - square : HALF + square, HALF - square : HALF + square] = INK
    if shadow_from is not None:
        plane[:, HALF + round(shadow_from * PX_PER_SIDE) :] //= 2
    scale = PX_PER_SIDE / SIDE_M
    plane_from_marker = np.array([(scale, 0, HALF - 0.5), (0, -scale, HALF - 0.5), (0, 0, 1)])
    image_from_marker = CAMERA.K @ T_CAM_MARKER[:3, [0, 1, 3]]
    image_from_plane = image_from_marker @ np.linalg.inv(plane_from_marker)
    picture = cv2.warpPerspective(plane, image_from_plane, CAMERA.size, flags=cv2.INTER_AREA, borderValue=ground)
    noise = np.random.default_rng(0).normal(0, 2.0, picture.shape)
    return np.repeat((picture + noise).clip(0, 255).astype(np.uint8)[..., None], 3, axis=2)


def measured(picture: Image) -> Sheet:
    return measured_sheet(MarkerPicture(picture, CAMERA, T_CAM_MARKER, SIDE_M))


@pytest.mark.parametrize("ground", [20, 90, 170])
@pytest.mark.parametrize("extents", [(0.64, 0.64, 0.64, 0.64), (0.85, 0.85, 0.85, 0.85), (0.65, 0.7, 0.9, 1.0)])
def test_each_side_ends_where_the_paper_does(extents: Sequence[float], ground: int) -> None:
    found = measured(painted(extents, ground))
    ends = np.array([found.right, found.above, found.left, found.below]) - ADDED
    np.testing.assert_allclose(ends, extents, atol=0.03)


def test_a_shadow_on_the_sheet_is_not_its_end() -> None:
    found = measured(painted((0.8, 0.8, 0.8, 0.8), 90, shadow_from=0.2))
    ends = np.array([found.right, found.above, found.left, found.below]) - ADDED
    np.testing.assert_allclose(ends, 0.8, atol=0.03)


def test_on_a_table_as_white_as_the_paper_the_sheet_is_a_usual_one() -> None:
    assert measured(painted((0.8, 0.8, 0.8, 0.8), PAPER)) == USUAL_SHEET


def test_a_side_out_of_the_picture_is_like_the_others() -> None:
    picture = painted((0.8, 0.8, 0.8, 0.8), 90)
    right = int(project(CAMERA, T_CAM_MARKER, np.array([(0.7 * SIDE_M, 0.0, 0.0)]))[0, 0])
    cut = picture[:, :right]
    camera = Camera((cut.shape[1], 480), CAMERA.K, CAMERA.dist, "file")
    found = measured_sheet(MarkerPicture(np.ascontiguousarray(cut), camera, T_CAM_MARKER, SIDE_M))
    assert found.right == pytest.approx(0.8 + ADDED, abs=0.03)


def test_a_marker_behind_the_camera_has_a_usual_sheet() -> None:
    behind = T_CAM_MARKER.copy()
    behind[2, 3] *= -1
    found = measured_sheet(MarkerPicture(painted((0.8, 0.8, 0.8, 0.8), 90), CAMERA, behind, SIDE_M))
    assert found == USUAL_SHEET
    assert found.corners(SIDE_M).max() == pytest.approx(USUAL * SIDE_M)


def test_a_sheet_that_is_nowhere_before_the_camera_has_an_empty_outline() -> None:
    seen = MarkerPicture(np.zeros((480, 640, 3), np.uint8), CAMERA, T_CAM_MARKER, SIDE_M)
    aside = np.array(T_CAM_MARKER)
    aside[:3, 3] = (1.0, 0.0, 0.02)  # 89 degrees off the lens's axis, as a wrong camera file may have it
    assert outline_of(USUAL_SHEET, replace(seen, T_cam_marker=aside)).shape == (0, 2)
    assert len(outline_of(USUAL_SHEET, seen)) == 4
