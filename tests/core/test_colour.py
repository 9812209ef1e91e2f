"""sRGB's curve: known values, inverse of each other, monotonic across the joint."""

import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE, linear_from_srgb, srgb_from_linear


def test_known_values() -> None:
    assert linear_from_srgb(1.0) == pytest.approx(1)
    assert linear_from_srgb(0.0) == 0
    # Mid grey 18 % is sRGB 118 of 255, by the standard's tables.
    assert round(float(srgb_from_linear(0.18)) * 255) == 118


def test_the_curves_are_inverse_and_rise() -> None:
    encoded = np.linspace(0, 1, 4097)
    np.testing.assert_allclose(srgb_from_linear(linear_from_srgb(encoded)), encoded, atol=1e-6)
    assert (np.diff(linear_from_srgb(encoded)) > 0).all()


def test_the_curves_meet_at_their_joint() -> None:
    for curve, joint in ((linear_from_srgb, 0.04045), (srgb_from_linear, 0.0031308)):
        assert curve(np.nextafter(joint, 1)) == pytest.approx(curve(joint), abs=1e-7)
    assert linear_from_srgb(0.04045) == pytest.approx(0.0031308, abs=1e-7)


def test_luminance_follows_from_the_primaries_and_the_white() -> None:
    """Their chromaticities x, y by Rec. 709; amounts of the primaries that make D65, of which Y is the luminance."""
    x, y = np.array([(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)]).T
    white = np.array([0.3127 / 0.3290, 1.0, (1 - 0.3127 - 0.3290) / 0.3290])
    np.testing.assert_allclose(np.linalg.solve([x / y, y / y, (1 - x - y) / y], white), REC709_LUMINANCE, atol=5e-5)


def test_the_table_holds_every_8_bit_value() -> None:
    assert LINEAR_FROM_SRGB_8BIT.shape == (256,)
    assert LINEAR_FROM_SRGB_8BIT[[0, 255]].tolist() == [0, 1]
