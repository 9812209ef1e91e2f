import numpy as np
import pytest

from ashe_live.core.square import PlaneMarker, along_sides, mean_side_px, side_lengths_px, square_corners


def test_corners_are_in_the_order_of_the_print_and_a_side_apart() -> None:
    corners = square_corners(0.06)
    # Top-left, top-right, bottom-right, bottom-left as printed: y is up.
    np.testing.assert_array_equal(np.sign(corners), [(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
    np.testing.assert_allclose(side_lengths_px(corners[:, :2]), 0.06)


def test_a_marker_beside_it_is_turned_counter_clockwise_and_then_shifted() -> None:
    beside = PlaneMarker("aruco:4x4_50:1", np.array([0.3, 0.1]), np.pi / 2, 0.06)
    points = np.array([(0.0, 0.0, 0.0), (0.02, 0.0, 0.01), (0.0, 0.02, 0.0)])
    np.testing.assert_allclose(beside.on_plane(points), [(0.3, 0.1, 0), (0.3, 0.12, 0.01), (0.28, 0.1, 0)])


def test_a_marker_beside_it_has_a_size_and_a_place() -> None:
    with pytest.raises(ValueError, match="side_m"):
        PlaneMarker("aruco:4x4_50:1", np.zeros(2), 0.0, 0.0)
    with pytest.raises(ValueError, match="centre_m"):
        PlaneMarker("aruco:4x4_50:1", np.zeros(3), 0.0, 0.06)


def test_sides_are_counted_from_the_first_corner() -> None:
    corners = np.array([(0.0, 0.0), (3.0, 4.0), (3.0, 6.0), (0.0, 6.0)])
    np.testing.assert_allclose(side_lengths_px(corners), (5, 2, 3, 6))
    assert mean_side_px(corners) == pytest.approx(4)


@pytest.mark.parametrize("order", [1, -1])  # clockwise, counter-clockwise
def test_normals_of_sides_point_out_of_the_polygon_whichever_way_it_is_walked(order: int) -> None:
    corners = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 2.0)])[::order]
    points, outwards = along_sides(corners, np.array([0.5]))
    middles = {(2.0, 0.0): (0, -1), (4.0, 1.0): (1, 0), (2.0, 1.0): (-(5**-0.5), 2 * 5**-0.5)}
    assert {tuple(point) for point in points[:, 0]} == set(middles)
    for point, normal in zip(points[:, 0], outwards, strict=True):
        np.testing.assert_allclose(normal, middles[tuple(point)], atol=1e-12)
