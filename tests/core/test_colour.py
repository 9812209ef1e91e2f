"""sRGB's curve: known values, inverse of each other, monotonic across the joint."""

import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, linear_from_srgb, srgb_from_linear


def test_known_values() -> None:
    assert linear_from_srgb(1.0) == pytest.approx(1)
    assert linear_from_srgb(0.0) == 0
    # Mid grey 18 % is sRGB 118 of 255, by the standard's tables.
    assert round(float(srgb_from_linear(0.18)) * 255) == 118


def test_the_curves_are_inverse_and_rise() -> None:
    encoded = np.linspace(0, 1, 4097)
    np.testing.assert_allclose(srgb_from_linear(linear_from_srgb(encoded)), encoded, atol=1e-6)
    assert (np.diff(linear_from_srgb(encoded)) > 0).all()


def test_the_table_holds_every_8_bit_value() -> None:
    assert LINEAR_FROM_SRGB_8BIT.shape == (256,)
    assert LINEAR_FROM_SRGB_8BIT[[0, 255]].tolist() == [0, 1]
