"""All cells read together: what single cells no longer tell, and what must not be believed."""

import cv2
import numpy as np
import pytest

from ashe_live.bench.track.frames import Flaws, PrintedMarker
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.tracking.families.markers import Marker, parse_marker
from tests.tracking.conftest import SIDE_M, pose

CAMERA = Camera.from_focal((320, 240), 700)
PLACE = pose(0.8, 25, 30)


def shot(marker: Marker, flaws: Flaws, cells: int) -> Image:
    image = PrintedMarker(marker.bitmap(cells), SIDE_M, CAMERA, flaws).painted([PLACE], np.random.default_rng(3))
    return np.ascontiguousarray(image[:, :, 0])


@pytest.mark.parametrize("flaws", [Flaws(blur_px=4.0), Flaws(shadow_ratio=0.3, noise=4.0), Flaws(gain=0.06)])
def test_blur_shadow_and_darkness_hide_cells_but_not_the_marker(flaws: Flaws) -> None:
    marker = parse_marker("aruco:4x4_50:3")
    (found,) = marker.find(shot(marker, flaws, 6))
    truth = project(CAMERA, PLACE, square_corners(SIDE_M))
    assert np.abs(found - truth).max() < 4


@pytest.mark.parametrize("blur_px", [0.7, 3.0])
def test_a_neighbour_in_the_dictionary_is_not_taken_for_it(blur_px: float) -> None:
    """Every other marker of the dictionary, as that is what lies on the table beside it."""
    wanted = parse_marker("aruco:4x4_50:3")
    taken = [
        number
        for number in range(0, 50, 5)
        if wanted.find(shot(parse_marker(f"aruco:4x4_50:{number}"), Flaws(blur_px=blur_px), 6))
    ]
    assert not taken


def test_several_equal_markers_are_all_found() -> None:
    marker = parse_marker("aruco:4x4_50:3")
    sheet = cv2.copyMakeBorder(marker.bitmap(60), 30, 30, 30, 30, cv2.BORDER_CONSTANT, value=255)
    assert len(marker.find(np.hstack([sheet, np.rot90(sheet), sheet]))) == 3
