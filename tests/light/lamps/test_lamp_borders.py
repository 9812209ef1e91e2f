"""What borders tell of a lamp where they leave open how long a shadow is."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.edges.nearness import NearnessBySteps
from ashe_live.light.explanation.alignment import measured
from ashe_live.light.explanation.explain import END_IN_VIEW
from ashe_live.light.explanation.light_covariance import lights_of
from ashe_live.light.explanation.normal_equations import placed_in
from ashe_live.light.lamps.lamp_borders import lamp_borders, length_by_light
from ashe_live.light.shape.layout import light_parameters
from ashe_live.light.shape.light_points import cast_on_ground
from ashe_live.light.views.joint.aligned import JointStart, explained_where_it_stands
from tests.light.lamps.test_hypotheses import by_a_sun
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster


@pytest.mark.parametrize("azimuth_deg", [90.0, 180.0])
@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_a_shadow_that_leaves_the_picture_ends_there_in_a_nearer_light_too(caster: Caster, azimuth_deg: float) -> None:
    """The top h throws a shadow as long as s h / (1 - k h): if the end stays, s falls by s h with k.

    By the sides of the shadow alone, which say nothing of its length, s changes by 10 to 10,000 times as much.
    """
    explanation, _ = by_a_sun(painted_region(caster, azimuth_deg=azimuth_deg, elevation_deg=12.0))
    assert explanation.alignment.ends_in_view[0] < END_IN_VIEW
    lit = explanation.lit
    spheroids = explanation.proxy.spheroids_marker
    top = float((spheroids[:, 2] + spheroids[:, 4]).max())
    end_stays = -light_parameters(lit.lights)[0] * top
    (borders,) = lamp_borders(explanation)
    at_foot = borders.by_nearness - lit.body.frame.origin_marker
    assert np.linalg.norm(at_foot - end_stays) < 3 * np.linalg.norm(end_stays)
    assert 0.1 < borders.nearness_sigma < 3.0


@pytest.mark.parametrize(("caster", "azimuth_deg"), [(BOX, 90.0), (CYLINDER, 90.0), (CYLINDER, 180.0)])
def test_what_is_asked_of_a_shadow_without_an_end_is_not_what_is_held(caster: Caster, azimuth_deg: float) -> None:
    """The borders ask for much the same nearness, whichever one the light was held at when they were looked at."""
    explanation, _ = by_a_sun(painted_region(caster, azimuth_deg=azimuth_deg, elevation_deg=12.0))
    asked = []
    for held in (0.0, 0.3, 0.6):
        here = explanation.alignment.placed
        (placed,) = placed_in([(here.lit.with_first_light_near(held), here.sight, here.costs)])
        (alignment,) = measured([placed])
        assert alignment.ends_in_view[0] < END_IN_VIEW
        (borders,) = lamp_borders(replace(explanation, alignment=alignment, lights=lights_of(alignment)))
        asked.append(borders.nearness)
    assert np.ptp(asked) < 0.1


@pytest.mark.parametrize("nearness", [0.0, 0.3, 0.8])
def test_how_a_shadows_length_follows_from_its_light_near_or_far(nearness: float) -> None:
    """By the projection of a point at the height 0.9, in a light whose displacement and nearness change a little."""
    top, light = np.array([[0.0, 0.0, 0.9]]), np.array([0.6, -1.1, 1.0, nearness])

    def length(light: Float) -> float:
        cast = cast_on_ground(top, light)
        assert cast is not None
        return float(np.linalg.norm(cast[0, :2]))

    slopes = np.array([(length(light + step) - length(light - step)) / 2e-6 for step in 1e-6 * np.eye(4)[[0, 1, 3]]])
    along = slopes[:2] @ light[:2] / np.linalg.norm(light[:2])
    np.testing.assert_allclose(length_by_light(light, 0.9), slopes / along, rtol=1e-6)


@pytest.mark.parametrize(("share", "least", "most"), [(0.02, 1.0, 1.02), (3.0, 100.0, np.inf)])
def test_what_is_beyond_the_first_order_is_not_estimated(share: float, least: float, most: float) -> None:
    """Borders may ask for any lamp: nearer than one over the body's height, it would be below the body's top."""
    explanation, _ = by_a_sun(painted_region(BOX))
    frame = explanation.lit.body.frame
    nearness, sigma = share / explanation.proxy.points_marker()[:, 2].max(), 0.3
    asked = NearnessBySteps(np.array([0, 0, nearness * frame.unit_m]), np.eye(3) / (sigma * frame.unit_m) ** 2)
    (borders,) = lamp_borders(replace(explanation, nearness=asked))
    assert borders.nearness == pytest.approx(nearness)
    assert least <= borders.nearness_sigma / sigma < most
    # The displacement that is known is that at the body: seen from the marker, a nearer light moves with the way there.
    np.testing.assert_allclose(borders.by_nearness, frame.origin_marker, atol=1e-9)


def test_several_views_say_as_much_more_of_the_nearness_as_of_the_direction() -> None:
    """What they share is no news for either: the body's model, the ground's texture along its borders."""
    explanation, _ = by_a_sun(painted_region(BOX))
    costs, lit = explanation.costs, explanation.lit
    one, nine = (explained_where_it_stands(JointStart(explanation, lit, [costs] * count)) for count in (1, 9))
    assert one is not None
    assert nine is not None
    in_direction, in_nearness = (
        [float(np.trace(lights_of(each.joint.alignment)[0].covariance_rad2)) for each in (one, nine)],
        [lamp_borders(each.joint)[0].nearness_sigma ** 2 for each in (one, nine)],
    )
    assert in_nearness[1] / in_nearness[0] == pytest.approx(in_direction[1] / in_direction[0], rel=0.03)
    assert in_nearness[1] > 0.3 * in_nearness[0]
