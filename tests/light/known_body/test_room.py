"""How far the bare table reaches around a place in the picture: against the masks of what covers it."""

import cv2
import numpy as np

from ashe_live.light.known_body.outline.room import BESIDE_PX, Room
from tests.light.known_body.test_shadow_edges import BODY, view


def test_room_is_the_distance_from_what_is_no_table() -> None:
    seen = view()
    room = Room.of(seen, BODY)
    rng = np.random.default_rng(0)
    points = rng.uniform((0, 0), (639, 479), (400, 2)).round()
    columns, rows = points.astype(int).T
    is_table = np.pad(seen.is_ground, 1)  # beyond the picture there is none
    by_mask = cv2.distanceTransform(is_table.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    found, expected = room.around(points), by_mask[rows, columns]
    on_table = expected > BESIDE_PX + 3
    assert on_table.sum() > 200
    assert (np.abs(found - expected)[on_table] <= BESIDE_PX + 1.5).all()
    assert (found[expected == 0] <= 0).all()


def test_without_an_outline_there_is_less_room() -> None:
    room = Room.of(view(), BODY)
    square = np.array([(10.0, 10.0), (60.0, 10.0), (60.0, 60.0), (10.0, 60.0)])
    points = np.array([(35.0, 35.0), (35.0, 12.0), (35.0, 90.0)])
    assert np.allclose(room.beside_shadow(square, 3.0, 0.5).around(points), [22.0, -1.0, 27.0])
    assert np.allclose(room.outside(square).around(points), [-25 - BESIDE_PX, -2 - BESIDE_PX, 30 - BESIDE_PX])


def test_in_a_shadow_that_is_known_less_light_is_left() -> None:
    square = np.array([(10.0, 10.0), (60.0, 10.0), (60.0, 60.0), (10.0, 60.0)])
    points = np.array([(35.0, 35.0), (35.0, 12.0), (35.0, 90.0)])
    room = Room.of(view(), BODY)
    assert np.allclose(room.around_and_left(points)[1], 1.0)
    assert np.allclose(room.beside_shadow(square, 3.0, 0.6).around_and_left(points)[1], [0.4, 0.4, 1.0])
