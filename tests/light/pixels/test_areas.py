"""Areas of masks: what each operation keeps and leaves out, and that nothing is too small for it."""

from collections.abc import Callable

import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.pixels import areas

SHAPE = (60, 80)


def rectangle(rows: slice, columns: slice) -> Mask:
    mask = np.zeros(SHAPE, bool)
    mask[rows, columns] = True
    return mask


LARGE, SMALL, SPECK = (
    rectangle(slice(10, 40), slice(10, 40)),
    rectangle(slice(20, 30), slice(60, 70)),
    rectangle(slice(50, 51), slice(50, 51)),
)
STRIP = rectangle(slice(5, 7), slice(5, 75))


def test_specks_go_and_pinholes_close() -> None:
    spoilt = LARGE | SPECK
    spoilt[20, 20] = False
    for clean in (areas.cleaned, areas.majority):
        np.testing.assert_array_equal(clean(spoilt)[15:35, 15:35], True)
        assert not clean(spoilt)[45:].any()


def test_a_majority_leaves_thin_strips_and_an_opening_does_not() -> None:
    np.testing.assert_array_equal(areas.majority(STRIP)[:, 10:70], STRIP[:, 10:70])
    assert not areas.cleaned(STRIP).any()


def test_only_what_is_thick_enough_is_thick() -> None:
    np.testing.assert_array_equal(areas.thick(LARGE | SMALL | STRIP, 11), LARGE)
    np.testing.assert_array_equal(areas.thick(LARGE | SMALL | STRIP, 9), LARGE | SMALL)


def test_areas_come_largest_first_and_none_is_lost() -> None:
    whole = SPECK | SMALL | LARGE
    found = areas.areas_by_size(whole, 1)
    for area, expected in zip(found, (LARGE, SMALL, SPECK), strict=True):
        np.testing.assert_array_equal(area, expected)
    assert len(areas.areas_by_size(whole, 2)) == 2
    np.testing.assert_array_equal(areas.large_areas(whole, 100), LARGE | SMALL)
    np.testing.assert_array_equal(areas.large_areas(whole, 101), LARGE)


def test_overlapping_areas_are_kept_whole_and_all_of_them_if_none_is() -> None:
    half = rectangle(slice(10, 40), slice(20, 80)) & ~SMALL
    np.testing.assert_array_equal(areas.overlapping(LARGE | SMALL, half, 0.3), LARGE)
    np.testing.assert_array_equal(areas.overlapping(LARGE | SMALL, half, 0.9), LARGE | SMALL)
    np.testing.assert_array_equal(areas.overlapping(LARGE | SMALL, half & False, 0.0), LARGE | SMALL)


def test_holes_are_filled_and_bays_are_not() -> None:
    ring = LARGE & ~rectangle(slice(20, 30), slice(20, 30))
    np.testing.assert_array_equal(areas.filled(ring), LARGE)
    bay = LARGE & ~rectangle(slice(20, 30), slice(20, 80))
    np.testing.assert_array_equal(areas.filled(bay), bay)


def test_what_grows_shrinks_its_surroundings() -> None:
    mask = np.random.default_rng(1).random(SHAPE) < 0.3
    for by_px in (1, 2, 5):
        np.testing.assert_array_equal(areas.grown(mask, by_px), ~areas.shrunk(~mask, by_px))


def test_a_mean_nearby_is_of_the_masks_values_alone() -> None:
    values, mask = np.full((9, 12), 50, np.float32), np.zeros((9, 12), bool)
    values[4, 2:5], mask[4, 2:5] = (1, 2, 6), True
    mean = areas.mean_nearby(values, mask, 2)
    assert mean[4, 3] == mean[6, 4] == 3
    assert mean[2, 6] == 6
    assert mean[4, 7] == mean[0, 0] == 0


def test_distances_are_those_of_geometry() -> None:
    point = rectangle(slice(30, 31), slice(40, 41))
    rows, columns = np.indices(SHAPE)
    np.testing.assert_allclose(areas.distance_to(point), np.hypot(rows - 30, columns - 40), rtol=0.06)
    assert areas.distance_to(point & False).min() > max(SHAPE)


OPERATIONS: dict[str, Callable[[Mask], Mask]] = {
    "cleaned": areas.cleaned,
    "majority": lambda mask: areas.majority(mask, 5),
    "thick": lambda mask: areas.thick(mask, 5),
    "large_areas": lambda mask: areas.large_areas(mask, 3),
    "overlapping": lambda mask: areas.overlapping(mask, ~mask, 0.3),
    "grown": lambda mask: areas.grown(mask, 3),
    "shrunk": lambda mask: areas.shrunk(mask, 3),
    "filled": areas.filled,
}


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (30, 40)])
@pytest.mark.parametrize("operation", OPERATIONS.values(), ids=OPERATIONS)
def test_of_nothing_there_is_nothing_at_any_size(operation: Callable[[Mask], Mask], shape: tuple[int, int]) -> None:
    nothing = np.zeros(shape, bool)
    assert not operation(nothing).any()
    assert operation(~nothing).shape == shape
    assert areas.areas_by_size(nothing, 1) == []
    assert (areas.distance_to(~nothing) == 0).all()
