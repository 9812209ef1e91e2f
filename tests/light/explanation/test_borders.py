"""The borders that a picture shows across outlines."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ashe_live.core.arrays import Float, Float32, Mask, unit_circle
from ashe_live.light.edges.outline_points import evenly_spaced
from ashe_live.light.explanation.borders import CLEAR, LEAST_VARIANCE, STEPS, Borders, borders_at
from ashe_live.light.labels.costs import Side

SHAPE = (96, 128)
ALL = np.ones(SHAPE, bool)
CENTRE = np.array([64.0, 48.0])
RADIUS, REACH_PX = 24.0, 8.0
SQUARE = CENTRE + RADIUS * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])


def disc(sides: int = 64) -> Float:
    return np.asarray(CENTRE + RADIUS * unit_circle(sides))


def gain_within(radius: float, clarity: float = 8.0, blur_px: float = 0.5) -> Float32:
    """(h, w) of a disc that costs less inside of a radius by `clarity`, more outside, and changes over a blur."""
    y, x = np.indices(SHAPE)
    inside = radius - np.hypot(x - CENTRE[0], y - CENTRE[1])
    return np.asarray(clarity * np.clip(inside / blur_px, -1, 1), np.float32)


def borders_of(hull: Float, side: Side, reach_px: float = REACH_PX) -> Borders:
    """(n,) of one outline."""
    borders = borders_at(evenly_spaced([hull]), [side], np.array([reach_px]))
    return Borders(*(getattr(borders, field.name)[0] for field in dataclasses.fields(borders)))


def found(gain: Float32, trusted: Mask = ALL, visible: Mask = ALL, reach_px: float = REACH_PX) -> Borders:
    return borders_of(disc(), Side(gain, trusted, visible), reach_px)


@pytest.mark.parametrize("offset_px", [-5.0, -3.0, -1.0, -0.4, 0.0, 0.25, 0.5, 2.0, 3.5, 5.0])
def test_a_border_is_found_where_it_is(offset_px: float) -> None:
    borders = found(gain_within(RADIUS + offset_px))
    np.testing.assert_allclose(borders.offset_px, offset_px, atol=0.3)
    np.testing.assert_allclose(borders.clarity, 1)


def test_the_sharper_a_border_the_more_is_known() -> None:
    """The slower the costs change, and the less they do, the less is known; nothing is known better than a pixel."""
    information = [found(gain_within(RADIUS + 1, *how)).information for how in ((8, 0.5), (8, 4), (8, 12), (1, 12))]
    assert (np.diff(information, axis=0) < 0).all()
    assert information[0].max() <= 1 / LEAST_VARIANCE
    assert found(gain_within(RADIUS, 40.0)).information.min() > 0.5 / LEAST_VARIANCE


def test_a_flat_picture_has_no_border() -> None:
    flat = found(np.zeros(SHAPE, np.float32))
    np.testing.assert_allclose(flat.offset_px, 0, atol=1e-6)
    np.testing.assert_array_equal(flat.clarity, 0)
    assert flat.information.max() < 0.05 * found(gain_within(RADIUS)).information.min()


@pytest.mark.parametrize("gain", [-10.0, 10.0])
def test_the_same_material_on_both_sides_is_no_clear_border(gain: float) -> None:
    borders = found(np.full(SHAPE, gain, np.float32))
    np.testing.assert_array_equal(borders.clarity, 0)
    np.testing.assert_allclose(np.sign(borders.offset_px), np.sign(gain))
    assert borders.information.max() < 0.5 * found(gain_within(RADIUS, 40.0)).information.min()


def test_clarity_grows_with_the_difference_of_both_sides_up_to_one() -> None:
    clarity = [found(gain_within(RADIUS, difference)).clarity.mean() for difference in (0.1, 0.5, 1, CLEAR)]
    assert (np.diff(clarity) > 0).all()
    assert clarity[-1] == 1


def test_nothing_is_known_where_the_picture_is_not_trusted_or_shows_no_border() -> None:
    left = np.indices(SHAPE)[1] < CENTRE[0]
    at_left = evenly_spaced([disc()]).points[0, :, 0] < CENTRE[0]
    sure = np.abs(evenly_spaced([disc()]).points[0, :, 0] - CENTRE[0]) > 2
    for trusted, visible in ((~left, ALL), (ALL, ~left)):
        borders = found(gain_within(RADIUS), trusted, visible)
        assert (borders.information[at_left & sure] == 0).all()
        assert np.isnan(borders.clarity[at_left & sure]).all()
        assert (borders.information[~at_left & sure] > 0).all()
        assert np.isfinite(borders.clarity[~at_left & sure]).all()


def test_what_is_not_trusted_does_not_matter() -> None:
    clear = gain_within(RADIUS + 1)
    trusted = np.indices(SHAPE)[1] > CENTRE[0]
    spoilt = np.where(trusted, clear, np.float32(np.nan))
    np.testing.assert_array_equal(found(spoilt, trusted).offset_px, found(clear, trusted).offset_px)


def test_a_border_at_the_end_of_the_reach_counts_little() -> None:
    near, far = (found(gain_within(RADIUS + offset_px, 40.0)) for offset_px in (2.0, REACH_PX + 3))
    assert far.information.max() < 0.5 * near.information.min()
    assert (far.offset_px > REACH_PX / 2).all()


@pytest.mark.parametrize("by", [(-500.0, 0.0), (0.0, 500.0), (1e5, 1e5)])
def test_out_of_the_picture_nothing_is_known(by: tuple[float, float]) -> None:
    borders = borders_of(disc() + by, Side(gain_within(RADIUS), ALL, ALL))
    np.testing.assert_array_equal(borders.information, 0)
    assert np.isfinite(borders.offset_px).all()
    assert np.isnan(borders.clarity).all()


def test_a_mirrored_picture_has_mirrored_borders() -> None:
    rng = np.random.default_rng(0)
    gain = gain_within(RADIUS + 1) + rng.normal(0, 1, SHAPE).astype(np.float32)
    hull = disc()
    mirrored = (SHAPE[1] - 1 - hull[:, 0], hull[:, 1])
    there = borders_of(np.column_stack(mirrored), Side(np.ascontiguousarray(gain[:, ::-1]), ALL, ALL))
    here = borders_of(hull, Side(gain, ALL, ALL))
    # cv2.remap knows places to 1/32 of a pixel.
    np.testing.assert_allclose(there.offset_px, here.offset_px, atol=0.1)


def test_several_outlines_are_worked_on_as_each_is_alone() -> None:
    """Of different numbers of corners, in different pictures, looked for at different distances."""
    hulls, reaches = [disc(), SQUARE, disc(17)[::-1]], [REACH_PX, 5.0, 3.0]
    left = np.indices(SHAPE)[1] < CENTRE[0]
    sides = [
        Side(gain_within(RADIUS + 1), ALL, ALL),
        Side(gain_within(RADIUS, 3.0), left, ALL),
        Side(gain_within(RADIUS - 1), ALL, left),
    ]
    together = borders_at(evenly_spaced(hulls), sides, np.array(reaches))
    for i, alone in enumerate(map(borders_of, hulls, sides, reaches)):
        np.testing.assert_array_equal(together.offset_px[i], alone.offset_px)
        np.testing.assert_array_equal(together.information[i], alone.information)
        np.testing.assert_array_equal(together.clarity[i], alone.clarity)


@settings(max_examples=30)
@given(st.floats(0.5, 60), st.floats(0, 1e6), st.integers(0, 1000))
def test_no_picture_makes_numbers_that_are_none(reach_px: float, cost: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    gain = (cost * rng.normal(0, 1, SHAPE)).astype(np.float32)
    borders = found(gain, rng.random(SHAPE) < 0.9, rng.random(SHAPE) < 0.9, reach_px)
    assert np.isfinite(borders.offset_px).all()
    assert (np.abs(borders.offset_px) <= reach_px * (1 + 1 / (STEPS - 1)) + 1e-6).all()
    assert np.isfinite(borders.information).all()
    assert (borders.information >= 0).all()
    known = borders.clarity[borders.information > 0]
    assert ((known >= 0) & (known <= 1)).all()
