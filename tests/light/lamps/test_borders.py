"""What borders tell of a lamp where they leave open how long a shadow is."""

import numpy as np
import pytest

from ashe_live.light.explanation.explain import END_IN_VIEW
from ashe_live.light.lamps.borders import lamp_borders
from ashe_live.light.shape.layout import light_parameters
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
    lit = explanation.alignment.placed.lit
    spheroids = explanation.proxy.spheroids_marker
    top = float((spheroids[:, 2] + spheroids[:, 4]).max())
    end_stays = -light_parameters(lit.lights)[0] * top
    (borders,) = lamp_borders(explanation)
    at_foot = borders.by_nearness - lit.body.frame.origin_marker
    assert np.linalg.norm(at_foot - end_stays) < 3 * np.linalg.norm(end_stays)
    assert 0.1 < borders.nearness_sigma < 3.0
