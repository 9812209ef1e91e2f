"""Lamps and suns told apart, as the bench counts it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ashe_live.bench.cases import Case
from ashe_live.bench.light.lamps import LampFigures, lamp_figures, summarise_lamps
from ashe_live.core.camera import Camera
from ashe_live.core.light import Light
from ashe_live.core.transforms import rigid
from ashe_live.core.types import MarkerPose

POSE = MarkerPose(rigid(np.diag((1.0, -1.0, -1.0)), (0, 0, 1)), np.zeros((4, 2)), 0.1, 0.0, None)
CAMERA = Camera.from_hfov((64, 48), 60)
LAMP_M = np.array([0.0, 0.0, 0.5])
NEAR = Case(
    "a",
    "set",
    "near",
    "box",
    Path("a.png"),
    CAMERA,
    POSE,
    np.array([[0, 0, 1.0]]),
    {},
    {},
    None,
    LAMP_M,
    0.02,
    np.zeros(2),
)
SUN = replace(NEAR, lamp_m=None)


def lamp(inverse_distance: float, sigma: float = 0.2) -> Light:
    covariance = np.diag([1e-3, 1e-3, sigma**2])
    return Light(np.array([0, 0, 1.0]), inverse_distance=inverse_distance, lamp_covariance=covariance)


def test_a_true_lamp_has_no_error_anywhere() -> None:
    figures = lamp_figures(lamp(2.0), NEAR)
    assert figures is not None
    assert figures.is_stated
    assert figures.true_distance_m == pytest.approx(0.5)
    assert (figures.beside_deg, figures.distance_error, figures.sigmas) == pytest.approx((0, 0, 0))


def test_a_direction_is_wrong_beside_a_lamps_object() -> None:
    """On average over 20 cm to each side of it, where it is right at the marker."""
    foot_m, lamp_m = np.array([0.1, 0.0]), np.array([0.3, 0.0, 0.4])
    towards = lamp_m / np.linalg.norm(lamp_m)
    figures = lamp_figures(Light(towards), replace(NEAR, to_lights_marker=towards[None], lamp_m=lamp_m, foot_m=foot_m))
    assert figures is not None
    assert not figures.is_stated
    places = [(0.3, 0.0, 0.0), (-0.1, 0.0, 0.0), (0.1, 0.2, 0.0), (0.1, -0.2, 0.0)]
    cosines = [(lamp_m - place) @ towards / np.linalg.norm(lamp_m - place) for place in places]
    assert figures.beside_deg == pytest.approx(np.degrees(np.arccos(cosines)).mean())
    assert figures.distance_error is None


def test_an_error_of_the_distance_is_relative_and_counted_in_sigmas_of_its_inverse() -> None:
    figures = lamp_figures(lamp(2.5), NEAR)
    assert figures is not None
    assert figures.distance_error == pytest.approx(0.2)
    assert figures.sigmas == pytest.approx(2.5)


def test_the_ellipsoid_takes_in_direction_and_distance_together() -> None:
    """An error of two sigmas in all three is outside of it, of one is not."""
    covariance = np.diag([1e-3**2, 1e-3**2, 0.01**2])
    found = []
    for sigmas in (1.0, 2.0):
        away = np.array([-sigmas * 1e-3, sigmas * 1e-3, 1.0])
        off = Light(away, inverse_distance=2.0 + 0.01 * sigmas, lamp_covariance=covariance)
        figures = lamp_figures(off, NEAR)
        assert figures is not None
        assert figures.squared_sigmas == pytest.approx(3 * sigmas**2, rel=1e-4)
        found.append(figures)
    assert summarise_lamps(found, [True, True]).within_ellipsoid_95 == pytest.approx(0.5)


def test_an_error_of_the_radius_is_relative_where_it_is_stated() -> None:
    told, untold = (lamp_figures(light, NEAR) for light in (replace(lamp(2.0), radius_m=0.025), lamp(2.0)))
    assert told is not None
    assert untold is not None
    assert told.radius_error == pytest.approx(0.25)
    assert untold.radius_error is None
    summary = summarise_lamps([told, untold], [True, True])
    assert (summary.radius_told, summary.radius_error) == pytest.approx((0.5, 0.25))


def test_several_lights_and_unknown_ones_are_not_counted() -> None:
    for lights in (np.eye(3)[:2], None):
        assert lamp_figures(lamp(2.0), replace(NEAR, to_lights_marker=lights)) is None


def test_no_answer_states_no_lamp_and_has_no_error() -> None:
    assert lamp_figures(None, NEAR) == LampFigures(pytest.approx(0.5), is_stated=False)
    assert lamp_figures(None, SUN) == LampFigures(None, is_stated=False)


def test_summaries_are_medians_and_shares_of_those_within_a_sigma_and_95_percent() -> None:
    """In three dimensions 95 % lie within the square root of 7.815 standard deviations."""
    figures = (
        (1.0, -0.9, 7.7, 0.1),
        (2.0, 1.1, 7.7, 0.2),
        (9.0, -1.1, 7.9, 0.9),
        (2.5, 0.1, 7.7, 0.3),
        (8.0, 2.1, 7.9, None),
    )
    found = [LampFigures(0.5, True, beside, beside / 10, *others) for beside, *others in figures]
    found.append(LampFigures(0.5, False, 2.5))
    summary = summarise_lamps(found, [True] * 6)
    assert (summary.beside_deg, summary.distance_error) == (2.5, 0.25)
    assert (summary.within_1_sigma, summary.within_ellipsoid_95) == (0.4, 0.6)
    assert (summary.radius_told, summary.radius_error) == (0.8, pytest.approx(0.25))


def test_summaries_count_answers_and_lamps_among_them() -> None:
    found = [lamp_figures(light, SUN) for light in (lamp(2.0), Light(np.array([0, 0, 1.0])), None)]
    summary = summarise_lamps([each for each in found if each is not None], [True, True, False])
    assert (summary.attempted, summary.stated) == (3, 0.5)
    assert summary.answered == pytest.approx(2 / 3)
    assert summary.within_1_sigma is None
