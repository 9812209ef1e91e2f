"""The estimator with a caster of known shape and size, on painted photos with a known light."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.caster import Caster
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.errors import UserError
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.estimators.preset import ACCURATE, BALANCED, FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.no_answer import DOES_NOT_FIT, OTHER_SIZE
from ashe_live.light.lamps.kinds import SUN
from tests.light.painted_scenes import BOX, CYLINDER, Painted, paint
from tests.shipped_scenes import CASES

KNOWN = {
    "box": Caster.box(BOX.width_m, BOX.width_m, BOX.height_m),
    "cylinder": Caster.cylinder(CYLINDER.width_m / 2, CYLINDER.height_m),
}
PAINTED = {"box": BOX, "cylinder": CYLINDER}
# Azimuth and elevation in degrees of lights whose shadow is seen.
LIGHTS = [(200.0, 40.0), (290.0, 25.0), (330.0, 65.0)]


def estimated(scene: Painted, caster: Caster | None, preset=BALANCED) -> LightEstimate:
    return ProxyEstimator(preset.assuming(caster=caster)).estimate(scene.tracked)


def error_deg(estimate: LightEstimate, scene: Painted) -> float:
    assert estimate.light is not None, estimate.reason
    return math.degrees(angle_between(estimate.light.to_light_marker, scene.to_light))


@pytest.mark.parametrize(
    ("name", "light"), [("box", LIGHTS[0]), ("cylinder", LIGHTS[1]), ("box", LIGHTS[2]), ("cylinder", LIGHTS[2])]
)
def test_the_known_body_is_the_real_object_and_gives_the_light(name: str, light: tuple[float, float]) -> None:
    scene = paint(PAINTED[name], ground="checkered", azimuth_deg=light[0], elevation_deg=light[1])
    estimate = estimated(scene, KNOWN[name], replace(BALANCED, light=SUN))  # a lamp that is not ruled out has a say
    assert error_deg(estimate, scene) < 0.6
    assert estimate.light.covariance_rad2 is not None
    body = estimate.illumination.real_object
    assert body.family == KNOWN[name].kind
    points = body.points_marker(60)
    np.testing.assert_allclose(points[:, 2].max(), PAINTED[name].height_m)
    np.testing.assert_allclose(points[:, :2].mean(axis=0), PAINTED[name].at, atol=0.001)


def test_knowing_the_body_is_no_worse_than_not_knowing_it() -> None:
    scenes = [paint(BOX, ground="bricks", azimuth_deg=a, elevation_deg=e, seed=3) for a, e in LIGHTS[:2]]
    known, free = ([error_deg(estimated(scene, c), scene) for scene in scenes] for c in (KNOWN["box"], None))
    assert np.mean(known) <= np.mean(free)


@pytest.mark.parametrize(("height_m", "light"), [(0.04, LIGHTS[0]), (0.12, LIGHTS[1]), (0.16, LIGHTS[1])])
def test_a_height_that_is_half_wrong_is_said_and_not_believed(height_m: float, light: tuple[float, float]) -> None:
    scene = paint(BOX, azimuth_deg=light[0], elevation_deg=light[1])
    estimate = estimated(scene, Caster.box(BOX.width_m, BOX.width_m, height_m))
    assert estimate.light is None
    assert estimate.reason in (OTHER_SIZE, DOES_NOT_FIT)


@pytest.mark.parametrize(
    ("name", "caster"),
    [
        ("clean_cylinder", Caster.cylinder(0.03, 0.045)),
        ("clean_cylinder", Caster.cylinder(0.03, 0.0603)),
        ("clean_box", Caster.box(0.06, 0.04, 0.04)),
        ("clean_box", Caster.box(0.09, 0.06, 0.12)),
    ],
)
def test_a_part_of_the_object_is_not_taken_for_all_of_it(name: str, caster: Caster) -> None:
    """Labels may be chosen that leave out what is above a caster that is too low, and the light is then far too low."""
    estimate = ProxyEstimator(BALANCED.assuming(caster=caster)).estimate(CASES[name].tracked())
    assert estimate.light is None
    assert estimate.reason == OTHER_SIZE


@pytest.mark.parametrize("caster", [Caster.sphere(0.09), Caster.box(0.2, 0.02, 0.01), Caster.cylinder(0.02, 0.3)])
def test_a_body_that_is_not_there_is_no_answer(caster: Caster) -> None:
    assert estimated(paint(BOX, azimuth_deg=200.0, elevation_deg=40.0), caster).light is None


def test_two_percent_of_measuring_error_cost_a_degree() -> None:
    """2 % of a height are 0.6 degrees of a light at 45; width and depth that err the other way add to that."""
    scene = paint(BOX, ground="checkered", azimuth_deg=200.0, elevation_deg=40.0)
    for factor in (0.98, 1.02):
        sizes = (factor * BOX.width_m, BOX.width_m, BOX.height_m / factor)
        estimate = estimated(scene, Caster.box(*sizes))
        assert error_deg(estimate, scene) < 1.5


def test_a_hull_of_the_same_corners_is_the_same_body() -> None:
    scene = paint(BOX, azimuth_deg=200.0, elevation_deg=40.0)
    hull = Caster.hull(np.array(KNOWN["box"].spheroids)[:, :3])
    one, other = (estimated(scene, caster, FAST).light.to_light_marker for caster in (KNOWN["box"], hull))
    assert math.degrees(angle_between(one, other)) < 0.1


def test_all_fits_of_all_looks_know_the_body_and_the_kind_of_light() -> None:
    preset = ACCURATE.assuming("sun", KNOWN["box"])
    assert [look.light for look in preset.looks] == ["sun", "sun"]
    assert [look.caster for look in preset.looks] == [KNOWN["box"]] * 2
    assert {preset.first_fit.caster, preset.fine_fit.caster} == {KNOWN["box"]}
    assert preset.assuming() == ACCURATE
    assert all(each.caster is None for each in (FAST, BALANCED, ACCURATE))


def test_the_papers_method_has_no_use_for_it() -> None:
    with pytest.raises(UserError, match="no use of a known caster"):
        make_estimator("paper", BALANCED.assuming(caster=KNOWN["box"]))


def test_an_empty_table_has_no_light_with_a_known_body_either() -> None:
    assert estimated(paint(), KNOWN["box"], FAST).light is None
