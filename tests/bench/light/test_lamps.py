"""Lamps and suns told apart, as the bench counts it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from ashe_live.bench.cases import Case
from ashe_live.bench.light.lamps import BESIDE_M, lamp_figures, summarise_lamps
from ashe_live.bench.light.results import case_result
from ashe_live.bench.light.set_tables import print_places
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
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
    figures = lamp_figures(Light(np.array([0, 0, 1.0])), NEAR)
    assert figures is not None
    assert not figures.is_stated
    assert figures.beside_deg == pytest.approx(np.degrees(np.arctan2(BESIDE_M, 0.5)))
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
    told, untold = (lamp_figures(light, NEAR) for light in (replace(lamp(2.0), radius_m=0.03), lamp(2.0)))
    assert told is not None
    assert untold is not None
    assert told.radius_error == pytest.approx(0.5)
    assert untold.radius_error is None
    summary = summarise_lamps([told, untold], [True, True])
    assert (summary.radius_told, summary.radius_error) == pytest.approx((0.5, 0.5))


def test_several_lights_are_not_counted() -> None:
    assert lamp_figures(lamp(2.0), replace(NEAR, to_lights_marker=np.eye(3)[:2])) is None


def test_summaries_count_answers_and_lamps_among_them() -> None:
    found = [lamp_figures(light, SUN) for light in (lamp(2.0), Light(np.array([0, 0, 1.0])), None)]
    summary = summarise_lamps([each for each in found if each is not None], [True, True, False])
    assert (summary.attempted, summary.stated) == (3, 0.5)
    assert summary.answered == pytest.approx(2 / 3)
    assert summary.within_1_sigma is None


def test_each_category_has_a_row_where_there_are_lamps() -> None:
    far = replace(NEAR, category="far", lamp_m=2 * LAMP_M)
    answer = LightEstimate("e", 0, Illumination((lamp(2.0),)), None, timing_ms={"total": 1.0})
    console = Console(width=200, record=True)
    print_places(console, [case_result("balanced", each, answer, 1.0) for each in (NEAR, far)])
    near_row, far_row = (line.split() for line in console.export_text().splitlines() if "balanced" in line)
    assert {"near", "2.00", "0%"} <= set(near_row)
    assert {"far", "1.00", "100%"} <= set(far_row)
    print_places(console, [case_result("balanced", SUN, answer, 1.0)])
    assert console.export_text() == ""
