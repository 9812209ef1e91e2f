"""A light in words says no more than is known."""

import dataclasses
import math

import numpy as np
import pytest

from ashe_live.core.light import Light
from ashe_live.core.transforms import direction_from_angles
from ashe_live.drawing.light_text import light_text


def test_no_light_is_said_to_be_certain() -> None:
    for confidence in (0.996, 1.0):
        assert light_text(Light((0.0, 0.0, 1.0), confidence=confidence)).endswith(", 99 % sure")


def test_a_lamp_is_said_with_its_distance() -> None:
    """Its error to first order: a relative error of the inverse distance is one of the distance."""
    lamp = Light((0.0, 1.0, 1.0), inverse_distance=1 / 0.62, sigma_rad=math.radians(4.0), confidence=0.9)
    assert light_text(lamp) == "lamp, 62 cm, azimuth 90°, elevation 45° ± 4.0°, 90 % sure"
    covariance = np.diag([0.01, 0.01, (0.05 / 0.62**2) ** 2])
    assert light_text(dataclasses.replace(lamp, lamp_covariance=covariance)).startswith("lamp, 62 ± 5 cm, ")
    assert light_text(Light((0.0, 1.0, 1.0))).startswith("azimuth")


@pytest.mark.parametrize(("azimuth_deg", "decimals", "said"), [(359.7, 0, "0"), (359.4, 0, "359"), (359.97, 1, "0.0")])
def test_an_azimuth_is_less_than_a_whole_turn(azimuth_deg: float, decimals: int, said: str) -> None:
    light = Light(direction_from_angles(math.radians(azimuth_deg), math.radians(30)))
    assert light_text(light, decimals).startswith(f"azimuth {said}°, ")
