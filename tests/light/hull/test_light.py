"""The light of a hull, and the support functions that it rests on."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float, unit_circle
from ashe_live.core.transforms import angle_between
from ashe_live.light.hull.carved import Box, carved
from ashe_live.light.hull.light import light_of_hull
from ashe_live.light.hull.supports import Planes, ShadowLines, SupportFunction
from tests.light.hull.labelled_views import ODD, TO_LIGHT_DEG, headings, views_of
from tests.light.synthetic_masks import Parts, ball, direction

TO_LIGHT = direction(*TO_LIGHT_DEG)


@pytest.mark.parametrize("start_deg", [(210, 45), (195, 32)])
def test_the_shadow_of_an_odd_shape_gives_its_light_back(start_deg: tuple[float, float]) -> None:
    hull = carved(views_of(ODD, TO_LIGHT, headings(60, 4)), Box.around(np.concatenate(ODD), 0.35))
    found = light_of_hull(hull, direction(*start_deg))
    assert found is not None
    off = angle_between(found.to_light_marker, TO_LIGHT)
    assert off < math.radians(2.0)
    assert off < 3 * math.sqrt(np.linalg.eigvalsh(found.covariance_rad2)[-1])


@pytest.mark.parametrize("start_deg", [(220, 45), (190, 28)])
def test_a_family_whose_light_is_elsewhere_is_contradicted(start_deg: tuple[float, float]) -> None:
    hull = carved(views_of(ODD, TO_LIGHT, headings(60, 4)), Box.around(np.concatenate(ODD), 0.35))
    assert angle_between(direction(*start_deg), TO_LIGHT) > math.radians(12)
    assert light_of_hull(hull, direction(*start_deg)) is None


def test_a_wider_span_is_surer() -> None:
    def variance(span_deg: float) -> float:
        hull = carved(views_of(ODD, TO_LIGHT, headings(span_deg, 4)), Box.around(np.concatenate(ODD), 0.35))
        found = light_of_hull(hull, TO_LIGHT)
        return math.inf if found is None else float(np.linalg.det(found.covariance_rad2))

    assert variance(80) < variance(16)


def test_without_a_shadow_there_is_no_light() -> None:
    hull = carved(views_of(ODD, direction(200, 89.9), headings(60, 4)), Box.around(np.concatenate(ODD), 0.35))
    assert light_of_hull(hull, TO_LIGHT) is None


def supports(points: Float, normals: Float) -> Float:
    return np.asarray((points @ normals.T).max(axis=0))


def planes_around(points: Float, eye: Float) -> Planes:
    """Some that touch the points' hull and pass, nearly, through an eye far away."""
    towards = eye / np.linalg.norm(eye)
    aside = np.cross(towards, [0.0, 0.0, 1.0])
    aside /= np.linalg.norm(aside)
    normals = unit_circle(24) @ [aside, np.cross(towards, aside)]
    return Planes(normals, supports(points, normals), np.full(24, 1e-4))


def seen_from(points: Float, *headings_deg: float) -> SupportFunction:
    eyes = [direction(heading, 45.0) for heading in headings_deg]
    return SupportFunction([planes_around(points, eye) for eye in eyes], 0.04)


def shadow_of(points: Float, sigma_m: float) -> ShadowLines:
    normals, cast = unit_circle(32), points[:, :2] - points[:, 2:] * TO_LIGHT[:2] / TO_LIGHT[2]
    return ShadowLines(normals, supports(cast, normals), np.full(32, sigma_m))


@pytest.mark.parametrize("parts", [ODD, ball(0.02, -0.01, 0.04)], ids=["odd", "ball"])
def test_support_functions_are_likeliest_in_the_true_light(parts: Parts) -> None:
    points = np.concatenate(parts)
    body, shadow = seen_from(points, 240, 255, 270, 285, 300), shadow_of(points, 1e-4)
    truth = body.log_likelihood(shadow, TO_LIGHT)
    for azimuth, elevation in ((190, 40), (210, 40), (200, 32), (200, 50)):
        assert truth > body.log_likelihood(shadow, direction(azimuth, elevation)) + 2


def test_a_wrong_tangent_counts_less() -> None:
    points = np.concatenate(ODD)
    shadow = shadow_of(points, 1e-3)
    shadow.reach_m[5] += 0.05
    found = seen_from(points, 240, 270, 300).without_outliers(shadow, TO_LIGHT)
    assert found.sigma_m[5] == found.sigma_m.max() > 3e-3
    assert np.median(found.sigma_m) == 1e-3
