"""Lamps in the place of suns: found from a sun's explanation, told from it, and not found where there is none."""

from functools import partial

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import Proposal, explained, explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.labels.associate import Split
from ashe_live.light.lamps.hypotheses import MOST_BY_OUTLINES, LampEvidence, LampHypotheses
from ashe_live.light.lamps.kinds import AUTO, SUN
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import nearness_of
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster

FIT = partial(explained_near, preset=BALANCED.fine_fit)
LAMP_M = (-0.3, -0.1, 0.45)


def by_a_sun(here: PaintedRegion) -> tuple[Explanation, Sharpener]:
    sharpener = Sharpener.of([View.of(here.scene.tracked, BALANCED.fine_width_px)])
    (rough,) = explained([Proposal(here.region, here.materials, Split(here.body, here.shadow))], BALANCED.fine_fit)
    assert rough is not None
    (sharp,) = sharpener.sharpened([rough])
    return sharp, sharpener


def hypotheses(here: PaintedRegion, kind: str = AUTO) -> LampHypotheses:
    return LampHypotheses.of(View.of(here.scene.tracked, BALANCED.coarse_width_px), here.ground, here.unlit, kind)


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_a_lamp_is_found_from_a_suns_explanation(ground: str, caster: Caster) -> None:
    """Outlines and the fall of light agree, and free the nearness that one object alone is said not to tell."""
    here = painted_region(caster, ground=ground, lamp_m=LAMP_M)
    sun, sharpener = by_a_sun(here)
    lamp = hypotheses(here).decided(sun, FIT, sharpener)
    assert lamp.lights[0].is_lamp
    assert lamp.nearness is not None
    assert abs(nearness_of(lamp.lights[0].light) * LAMP_M[2] - 1) < 0.15
    assert np.degrees(angle_between(lamp.lights[0].to_light_marker, np.array(LAMP_M))) < 2.5
    assert lamp.steps.shadow <= sun.steps.shadow


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_a_lamp_that_is_known_stays_where_it_is(caster: Caster) -> None:
    """Its own nearness is tried, not only that which the fall of light asks for in the direction that a sun has."""
    here = painted_region(caster, ground="bricks", lamp_m=LAMP_M)
    sun, sharpener = by_a_sun(here)
    tried = hypotheses(here)
    lamp = tried.decided(sun, FIT, sharpener)
    again = tried.decided(lamp, FIT, sharpener)
    assert again.lights[0].is_lamp
    assert again.criterion <= lamp.criterion + 1
    assert np.degrees(angle_between(again.lights[0].to_light_marker, np.array(LAMP_M))) < 2.5
    without_ground = hypotheses(here, SUN).decided(lamp, FIT, sharpener)
    assert not without_ground.lights[0].is_lamp


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_a_sun_stays_one(caster: Caster) -> None:
    here = painted_region(caster, ground="bricks")
    sun, sharpener = by_a_sun(here)
    tried = hypotheses(here)
    assert tried.decided(sun, FIT, sharpener) is sun
    assert tried.likelier([sun], FIT) == [sun]
    assert tried.agreement(sun) == 0


def test_no_lamp_is_tried_where_lights_are_taken_for_suns() -> None:
    here = painted_region(BOX, lamp_m=LAMP_M)
    sun, sharpener = by_a_sun(here)
    assert hypotheses(here, SUN).evidence(sun, FIT, sharpener).lamp is None


def test_a_ground_that_darkens_makes_no_lamp_of_a_sun_whose_shadow_the_outlines_show() -> None:
    lamp, _ = by_a_sun(painted_region(BOX))
    assert LampEvidence(lamp, by_fall=50.0, by_outlines=-5.0).is_lamp
    assert not LampEvidence(lamp, by_fall=60.0, by_outlines=-MOST_BY_OUTLINES).is_lamp
    assert LampEvidence(lamp, by_fall=120.0, by_outlines=-MOST_BY_OUTLINES).is_lamp


def test_a_sun_that_is_kept_knows_what_its_outlines_say_against_a_lamp(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its direction at the marker depends on how likely a lamp is, which is not for the ground alone to say."""
    here = painted_region(BOX)
    sun, sharpener = by_a_sun(here)
    monkeypatch.setattr(LampHypotheses, "evidence", lambda *_: LampEvidence(sun, by_fall=40.0, by_outlines=-15.0))
    assert hypotheses(here).decided(sun, FIT, sharpener).sun_by_outlines == -15.0


def test_in_several_views_outlines_that_speak_for_a_sun_keep_it() -> None:
    """They show a lamp's parallax, which uneven ground cannot imitate."""
    lamp, _ = by_a_sun(painted_region(BOX))
    assert not LampEvidence(lamp, by_fall=55.0, by_outlines=-30.0, in_views=True).is_lamp
    assert not LampEvidence(lamp, by_fall=-2.0, by_outlines=30.0, in_views=True).is_lamp
    assert LampEvidence(lamp, by_fall=2.0, by_outlines=20.0, in_views=True).is_lamp
