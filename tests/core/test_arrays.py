"""Arrays that are frozen, and computations on arrays that many parts need."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import (
    cached_by_array,
    cross_2d,
    cross_3d,
    directions_on_spiral,
    distinct,
    fixed_point,
    frozen_floats,
    frozen_view,
    lowest_on_parabola,
    median,
    once_for_each,
    same_objects,
    upper_median,
    upper_quantile,
    without,
)

HEIGHTS = np.array([0.003, 0.004, 0.005])


def test_what_is_frozen_is_a_copy_and_then_itself() -> None:
    given = np.arange(6.0).reshape(2, 3)
    frozen = frozen_floats(given, (-1, 3), "points")
    given[:] = 9
    assert frozen.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert not frozen.flags.writeable
    assert frozen_floats(frozen, (2, 3), "points") is frozen
    # A view may still change with the array that it is of.
    view = given[:1]
    view.flags.writeable = False
    frozen = frozen_floats(view, (1, 3), "points")
    given[:] = 0
    assert frozen.tolist() == [[9, 9, 9]]


@pytest.mark.parametrize(
    "values", [np.zeros(3), np.zeros((3, 2)), np.zeros((1, 3, 1)), [(0, 0, np.nan)], [(0, 0, np.inf)]]
)
def test_another_shape_and_what_is_not_finite_are_refused(values: object) -> None:
    with pytest.raises(ValueError, match="points"):
        frozen_floats(values, (-1, 3), "points")


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ({}, TypeError),
        ("abc", TypeError),
        ([("1", "2", "3")], TypeError),
        (np.ones((1, 3), complex), TypeError),
        (np.zeros((1, 3), "datetime64[s]"), TypeError),
        ([(1, 2), (3,)], ValueError),
    ],
)
def test_what_is_no_number_is_named(values: object, error: type[Exception]) -> None:
    with pytest.raises(error, match=r"points must be numbers of the shape \(n, 3\)"):
        frozen_floats(values, (-1, 3), "points")


def test_a_frozen_view_shares_its_pixels_and_is_then_itself() -> None:
    image = np.zeros((2, 2, 3), np.uint8)
    view = frozen_view(image)
    assert np.shares_memory(view, image)
    assert not view.flags.writeable
    assert image.flags.writeable
    assert frozen_view(view) is view
    assert not frozen_view(image[:1]).flags.writeable
    assert image[:1].flags.writeable


def test_equal_objects_are_not_the_same() -> None:
    one, other = [1], [1]
    assert same_objects([one, other], [one, other])
    assert not same_objects([one, other], [other, one])
    assert not same_objects([one], [one, other])
    assert without([one, other, one], [one])[0] is other
    assert without([one], [[1]]) == [[1]]


def test_a_cross_product_in_the_plane_is_the_area_between_both_and_turns_with_them() -> None:
    x, y = np.array([(2.0, 0.0), (1.0, 1.0)]), np.array([(0.0, 3.0), (1.0, -1.0)])
    assert cross_2d(x, y).tolist() == [6, -2]
    assert cross_2d(y, x).tolist() == [-6, 2]


def test_a_cross_product_in_space_is_numpys() -> None:
    a, b = np.array([0.3, -2.0, 1.5]), np.array([4.0, 0.7, -0.2])
    assert cross_3d(a, b).tolist() == np.cross(a, b).tolist()


@pytest.mark.parametrize("bits", [4, 6])
def test_opencv_draws_fixed_point_where_the_corners_are(bits: int) -> None:
    mask = np.zeros((20, 20), np.uint8)
    corners = np.array([(4.5, 5.0), (10.0 + 2 / 3, 5.0), (10.0 + 2 / 3, 9.0), (4.5, 9.0)])
    cv2.polylines(mask, [fixed_point(corners, bits)], True, 255, 1, cv2.LINE_AA, bits)
    column = mask[7].astype(float)
    assert (column[9:13] @ np.arange(9, 13)) / column[9:13].sum() == pytest.approx(10 + 2 / 3, abs=0.1)


@pytest.mark.parametrize("count", [1, 2, 3, 10, 11])
def test_an_upper_quantile_is_the_least_value_with_so_many_below(count: int) -> None:
    values = np.random.default_rng(0).permutation(count).astype(float)
    for share in (0.0, 0.3, 0.5, 0.99):
        assert upper_quantile(values, share) == np.floor(share * count)
    assert upper_median(values) == np.floor(count / 2)


@pytest.mark.parametrize(("first_z", "last_z"), [(1.0, -1.0), (1.0, 0.0), (-0.9, 0.3)])
def test_directions_on_a_spiral_are_spread_evenly_over_their_zone(first_z: float, last_z: float) -> None:
    """By Archimedes a zone's area goes with its height; and no side of it has more of them than another."""
    directions = directions_on_spiral(4000, first_z, last_z)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
    lower, upper = sorted((first_z, last_z))
    counts, _ = np.histogram(directions[:, 2], bins=8, range=(lower, upper))
    assert counts.tolist() == [500] * 8
    sides, _ = np.histogram(np.arctan2(directions[:, 1], directions[:, 0]), bins=8, range=(-np.pi, np.pi))
    np.testing.assert_allclose(sides, 500, atol=5)
    # Neighbours are apart: with half of the mean distance on a square grid between them.
    cosines = np.sort(directions[:500] @ directions.T, axis=1)[:, -2]
    spacing = np.sqrt(2 * np.pi * (upper - lower) / len(directions))
    assert np.arccos(cosines).min() > 0.5 * spacing


def test_the_spiral_covers_the_whole_sphere_unless_told() -> None:
    np.testing.assert_allclose(directions_on_spiral(1000).mean(axis=0), 0, atol=2e-3)
    assert np.abs(directions_on_spiral(1000)[[0, -1], 2]).min() > 0.998


@pytest.mark.parametrize("lowest", [0.0031, 0.004, 0.0048])
def test_a_parabola_is_lowest_at_its_bottom(lowest: float) -> None:
    assert lowest_on_parabola(HEIGHTS, 2.0 + 1e6 * (HEIGHTS - lowest) ** 2) == pytest.approx(lowest)


@pytest.mark.parametrize(("bottom", "nearest"), [(-0.4, 0.003), (0.5, 0.005)])
def test_a_bottom_beyond_the_points_is_not_believed(bottom: float, nearest: float) -> None:
    assert lowest_on_parabola(HEIGHTS, (HEIGHTS - bottom) ** 2) == nearest


def test_without_a_bottom_it_is_the_middle_one() -> None:
    assert lowest_on_parabola(HEIGHTS, -((HEIGHTS - 0.0042) ** 2)) == 0.004


def test_a_method_computes_once_for_equal_arrays_and_once_for_each_object():
    class Doubling:
        def __init__(self):
            self.asked = []

        @cached_by_array
        def doubled(self, values):
            self.asked.append(values.tolist())
            return 2 * values

    one, other = Doubling(), Doubling()
    first = one.doubled(np.arange(3.0))
    assert one.doubled(np.arange(6.0)[:3]) is first
    assert one.doubled(np.arange(6.0)[::2]).tolist() == [0, 4, 8]
    assert other.doubled(np.arange(3.0)).tolist() == first.tolist()
    assert (len(one.asked), len(other.asked)) == (2, 1)


def test_a_function_computes_once_for_each_object_beside_the_same_others():
    class Number:
        def __init__(self, value):
            self.value = value

    asked = []

    @once_for_each
    def added(one, other):
        asked.append((one, other))
        return Number(one.value + other.value)

    one, other, third = Number(1), Number(2), Number(2)
    first = added(one, other)
    assert added(one, other) is first
    assert added(other, one) is not first
    # An equal one is another.
    assert added(one, third) is not first
    assert asked == [(one, other), (other, one), (one, third)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_the_median_is_that_of_numpy_to_the_bit(count: int, dtype: type[np.floating]) -> None:
    values = np.random.default_rng(count).normal(size=count).astype(dtype)
    assert median(values) == float(np.median(values))


def test_of_what_is_alike_the_first_one_is_kept() -> None:
    def same_ten(one: int, other: int) -> bool:
        return one // 10 == other // 10

    assert distinct([31, 12, 35, 18, 54], same_ten) == [31, 12, 54]
    assert distinct(iter([31, 12, 35, 18, 54]), same_ten, 2) == [31, 12]
    assert distinct([31, 12], same_ten, 0) == []
    assert distinct([], same_ten) == []
