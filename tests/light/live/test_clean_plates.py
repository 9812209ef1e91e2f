"""A person's picture of the empty table becomes a frame's clean plate, or it is said why not and what to do."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.live.clean_plates import over_empty_table, refuse_unused
from ashe_live.tracking.cube.faces import CORNERS
from tests.light.painted_scenes import BOX, paint
from tests.light.synthetic_masks import camera_towards


@pytest.fixture(scope="module")
def full() -> TrackedFrame:
    return paint(BOX, ground="bricks", seed=1).tracked


@pytest.fixture(scope="module")
def empty() -> TrackedFrame:
    return paint(ground="bricks", seed=2).tracked


def test_the_plate_shows_the_ground_and_all_else_stays(full, empty) -> None:
    over = over_empty_table(full, empty, "empty.png")
    assert over.frame is full.frame
    assert over.marker is full.marker
    # Seen by the same camera from the same place, it is that very picture.
    np.testing.assert_array_equal(over.clean_plate_bgr, empty.frame.image_bgr)


def test_what_cannot_be_a_plate_is_refused_by_its_name(full, empty) -> None:
    body = Proxy("box", np.column_stack([full.marker.side_m * CORNERS, np.zeros((8, 2))]))
    on_cube = replace(full, marker=replace(full.marker, body=body))
    far = paint(ground="striped", T_cam_marker=camera_towards((0.0, 0.0), 0.5, 80.0, 90.0)).tracked
    for tracked, plate, said in (
        (on_cube, empty, "the paper cube's light is found without an empty table"),
        (full, replace(empty, marker=None), "empty.png shows no marker"),
        (full, far, "empty.png shows another view"),
    ):
        with pytest.raises(UserError) as caught:
            over_empty_table(tracked, plate, "empty.png")
        assert caught.value.message == said
        assert caught.value.remedy


def test_it_is_refused_for_an_estimator_of_one_frame_alone() -> None:
    refuse_unused("proxy", "--empty")
    with pytest.raises(UserError, match="the estimator paper makes no use of --empty"):
        refuse_unused("paper", "--empty")
