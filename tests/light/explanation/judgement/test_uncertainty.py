"""How uncertain a direction is: the radius that holds the truth."""

import math

import numpy as np
import pytest

from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.core.types import TrackedFrame
from ashe_live.light.explanation.judgement.uncertainty import Calibration, overdispersed
from ashe_live.light.shape.directions import HEMISPHERE_RAD, FittedLight
from tests.light.painted_scenes import BOX, paint
from tests.light.synthetic_masks import direction

TO_LIGHT = direction(200.0, 40.0)


@pytest.fixture(scope="module")
def tracked() -> TrackedFrame:
    return paint(BOX).tracked


def held_by(radius: float, deviations: tuple[float, float]) -> float:
    """The probability that a normal sample lies within `radius`: over the angle, the radial part is exponential."""
    angles = np.linspace(0, np.pi, 20_001)[:-1] + 1e-5
    along = (deviations[0] * np.cos(angles)) ** 2 + (deviations[1] * np.sin(angles)) ** 2
    return float(1 - np.exp(-0.5 * radius**2 / along).mean())


@pytest.mark.parametrize("turn_rad", [0.0, 1.1])
@pytest.mark.parametrize("share", [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0])
def test_the_radius_holds_the_truth_with_probability_68_percent(share: float, turn_rad: float) -> None:
    axes = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    deviations = 0.03, 0.03 * share
    radius = radius_of_68_percent(axes @ np.diag(np.square(deviations)) @ axes.T)
    # Without any spread across, the angle's integrand is 0 almost everywhere.
    deviations = 0.03, max(0.03 * share, 1e-7)
    assert held_by(radius / 1.01, deviations) < 0.68 < held_by(radius * 1.01, deviations)


def test_no_spread_has_no_radius() -> None:
    assert radius_of_68_percent(np.zeros((2, 2))) == 0
    assert radius_of_68_percent(np.diag([-1e-18, 0.0])) == 0


def test_the_less_confident_an_answer_is_the_wider_it_is(tracked: TrackedFrame) -> None:
    calibration = Calibration(1.0, 0.5, 2.0)
    fitted = FittedLight(np.append(TO_LIGHT, 0.0), np.diag([1e-4, 4e-4]))
    spreads = [calibration.covariance(fitted, confidence, tracked) for confidence in np.linspace(0, 1, 11)]
    assert np.all(np.diff([radius_of_68_percent(each) for each in spreads]) < 0)
    doubt = spreads[3] - spreads[-1]
    np.testing.assert_allclose(doubt, (0.5 * 0.7**2) ** 2 * np.eye(2), atol=1e-12)


@pytest.mark.parametrize("overdispersion", [0.5, 1.0, 3.0])
def test_overdispersion_widens_what_the_outlines_state_and_nothing_else(
    overdispersion: float, tracked: TrackedFrame
) -> None:
    stated = np.array([[1e-6, 1e-6], [1e-6, 4e-6]])  # far narrower than the hemisphere
    fitted = FittedLight(np.append(TO_LIGHT, 0.0), stated)
    none, some = (Calibration(factor, 0.5, 2.0).covariance(fitted, 1.0, tracked) for factor in (0.0, overdispersion))
    np.testing.assert_allclose(some - none, overdispersion * stated, rtol=1e-4)


@pytest.mark.parametrize("by_outlines", [1e-9, 0.1, 1.0, 100.0])  # information, 1/rad^2
def test_what_is_known_before_any_outline_is_not_widened(by_outlines: float) -> None:
    prior, turned = np.eye(2) / HEMISPHERE_RAD**2, np.array([[0.8, -0.6], [0.6, 0.8]])
    outlines = turned @ np.diag([by_outlines, 5 * by_outlines]) @ turned.T
    wider = overdispersed(np.linalg.inv(outlines + prior), 0.0, 7.0)
    np.testing.assert_allclose(wider, np.linalg.inv(outlines / 7.0 + prior), rtol=1e-9)
    assert radius_of_68_percent(wider) < math.radians(61)  # that of the prior


@pytest.mark.parametrize("unseen_end", [0.0, 0.4, 1.0])
def test_what_an_end_out_of_view_leaves_open_is_no_error_of_outlines(unseen_end: float) -> None:
    stated = np.array([[1e-4, 1e-4], [1e-4, 4e-4]])
    wider = overdispersed(stated, unseen_end, 9.0)
    assert wider[0, 0] == pytest.approx(9e-4, rel=0.01)  # which is far narrower than the hemisphere
    assert wider[1, 1] == pytest.approx(4e-4 * (9 * (1 - unseen_end) + unseen_end), rel=0.01)
    assert np.linalg.det(wider) > 0
    assert overdispersed(stated, unseen_end, 1.0)[1, 1] == pytest.approx(4e-4)
