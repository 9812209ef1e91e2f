"""How a lamp is stated: by its object's shadow as far as that is believed, else by the light on the ground."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import NearFit, Proposal, explained, explained_near
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.ground.shadow_shift import shadow_ratio
from ashe_live.light.labels.associate import Split
from ashe_live.light.lamps.kinds import AUTO, LAMP, SUN
from ashe_live.light.lamps.lamp import PictureContext, StatedExplanation, stated
from ashe_live.light.lamps.sources import shadow_middle
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import lamp_parameters
from ashe_live.light.shape.light_points import towards
from ashe_live.render.lights.lighting import angular_size
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX

LAMP_M = (-0.3, -0.1, 0.45)
FIT = partial(explained_near, preset=BALANCED.fine_fit)


def answer(
    confidence: float,
    lamp_m: tuple[float, ...] | None = LAMP_M,
    fit: NearFit = FIT,
    kind: str = LAMP,
    found_again: bool = False,
) -> StatedExplanation:
    """A box's explanation, under a lamp or a sun, stated as a light of a kind.

    fit: of lamps to its labels; found_again: whether another explanation of the same box was judged beside it.
    """
    here = painted_region(BOX, lamp_m=lamp_m)
    (sun,) = explained([Proposal(here.region, here.materials, Split(here.body, here.shadow))], BALANCED.fine_fit)
    assert sun is not None
    tracked = here.scene.tracked
    fine = View.of(tracked, BALANCED.fine_width_px)
    scene = PictureContext(
        tracked,
        fine.scaled(BALANCED.coarse_width_px),
        here.ground,
        here.unlit,
        [fine],
        [(replace(sun, as_object=sun.as_object.copy()), 5.0)] if found_again else [],
        list,
        fit,
        [],
        fitted_judge(),
    )
    ratios = [shadow_ratio(here.ground, here.true_shift)]
    return stated(sun, confidence, ratios, scene, kind)


def test_a_lamp_is_between_where_its_shadow_and_where_the_ground_puts_it_by_what_the_shadow_is_worth() -> None:
    lamps = (answer(confidence).lights[0].homogeneous for confidence in (0.9, 0.6, 0.3))
    believed, doubted, less = map(lamp_parameters, lamps)
    assert np.linalg.norm(believed - less) > 0.05
    np.testing.assert_allclose(doubted, (believed + less) / 2, atol=0.01)


def test_a_shadow_that_is_believed_leaves_a_narrower_lamp() -> None:
    believed, doubted = (answer(confidence).lights[0] for confidence in (0.99, 0.6))
    assert np.degrees(angle_between(believed.to_light_marker, np.array(LAMP_M))) < 3
    assert believed.sigma_rad is not None
    assert doubted.sigma_rad is not None
    assert believed.sigma_rad < 0.8 * doubted.sigma_rad
    assert believed.covariance_rad2 is not None
    assert doubted.covariance_rad2 is not None
    assert (np.linalg.eigvalsh(doubted.covariance_rad2 - believed.covariance_rad2) > 0).all()


@pytest.mark.parametrize("confidence", [0.0, 1.0])
def test_certainty_of_either_kind_is_finite(confidence: float) -> None:
    (light,) = answer(confidence).lights
    assert light.lamp_covariance is not None
    assert (np.linalg.eigvalsh(light.lamp_covariance) > 0).all()
    assert 0 <= (light.confidence or 0.0) <= 1


@pytest.mark.parametrize("angular_size_rad", [0.01, 0.3])
def test_a_lamp_is_drawn_as_large_as_it_was_seen(angular_size_rad: float) -> None:
    lamp = replace(answer(0.9).lights[0], angular_size_rad=None).with_angular_size(angular_size_rad)
    assert lamp.inverse_distance > 0
    assert angular_size(lamp) == pytest.approx(angular_size_rad, rel=1e-9)


def test_a_lamp_is_as_bright_at_the_marker_as_by_the_inverse_square_and_the_cosine_from_its_shadow() -> None:
    """The shadow's ratio tells of the lamp's light where the shadow lies."""
    here, found = painted_region(BOX, lamp_m=LAMP_M), answer(0.9)
    lamp, ratio = found.lights[0], shadow_ratio(here.ground, here.true_shift)
    assert lamp.position_marker_m is not None

    def irradiance(place: np.ndarray) -> float:
        towards = lamp.position_marker_m - np.append(place, 0.0)
        return float(towards[2] / np.linalg.norm(towards) ** 3)

    brighter = irradiance(np.zeros(2)) / irradiance(shadow_middle(found.explanation))
    assert abs(brighter - 1) > 0.1
    np.testing.assert_allclose(lamp.intensity_rgb_ratio, brighter * (1 - ratio) / ratio, rtol=1e-6)


def test_the_middle_of_the_shadow_is_behind_the_middle_of_the_body() -> None:
    explanation = answer(0.9).explanation
    lit = explanation.lit
    ground = np.append(shadow_middle(explanation), 0.0)
    middle = np.array([*lit.body.frame.origin_marker, lit.body.middle_m])
    to_middle = (middle - ground) / np.linalg.norm(middle - ground)
    np.testing.assert_allclose(to_middle, towards(lit.lights[0], ground), atol=1e-9)


def test_no_sun_is_believed_where_the_ground_is_lit_by_a_lamp_and_no_lamp_fits_the_labels() -> None:
    def no_fit(several):
        return [None for _ in several]

    (excluded,) = answer(0.9, lamp_m=(-0.15, -0.05, 0.2), fit=no_fit, kind=AUTO).lights
    assert excluded.inverse_distance == 0
    assert excluded.confidence == 0
    (sun,) = answer(0.9, lamp_m=None, fit=no_fit, kind=AUTO).lights
    assert (sun.confidence or 0.0) > 0.5


def test_an_object_that_was_found_again_adds_no_information_on_the_sun() -> None:
    once, twice = (answer(0.9, lamp_m=None, kind=SUN, found_again=again).lights[0] for again in (False, True))
    assert (twice.to_light_marker == once.to_light_marker).all()
    assert twice.sigma_rad == once.sigma_rad
