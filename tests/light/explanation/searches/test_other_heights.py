"""Bodies whose top the labels lack: found along their shadow, and only where the steps of light ask for it."""

from dataclasses import replace

import pytest

from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.searches.other_heights import with_other_heights
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.labels.associate import Split
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster


def sharpener_of(here: PaintedRegion) -> Sharpener:
    return Sharpener.of([View.of(here.scene.tracked, BALANCED.fine_width_px)])


def right(here: PaintedRegion) -> Explanation:
    (rough,) = explained([Proposal(here.region, here.materials, Split(here.body, here.shadow))], BALANCED.fine_fit)
    assert rough is not None
    (sharp,) = sharpener_of(here).sharpened([rough])
    return sharp


def stretched(here: PaintedRegion, factor: float) -> Explanation:
    """The right explanation by a body so many times as high, which throws the same shadow in another light."""
    one = right(here)
    placed = one.alignment.placed
    lit = placed.lit.stretched(factor)
    assert lit is not None
    light = replace(one.lights[0], light=lit.lights[0])
    wrong = replace(one, alignment=replace(one.alignment, placed=replace(placed, lit=lit)), lights=(light,))
    (seen,) = sharpener_of(here).measured([wrong])
    return seen


def found(here: PaintedRegion, *several: Explanation) -> list[Explanation]:
    sharpener = sharpener_of(here)
    return with_other_heights(several, sharpener, BALANCED.fine_fit, sharpener.sharpened, as_the_steps_say)


def as_the_steps_say(explanation: Explanation) -> float:
    return -explanation.steps.body


@pytest.mark.parametrize("factor", [0.75, 1.3])
@pytest.mark.parametrize("ground", ["plain", "checkered"])
@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_a_wrong_height_is_found_out(caster: Caster, ground: str, factor: float) -> None:
    here = painted_region(caster, ground=ground)
    wrong = stretched(here, factor)
    assert here.error_deg(wrong) > 5
    (better,) = found(here, wrong)
    assert here.error_deg(better) < 1.5


def test_a_body_on_the_steps_of_light_stays() -> None:
    here = painted_region(CYLINDER)
    one = right(here)
    assert found(here, one) == [one]


def test_a_body_whose_shadow_is_wrong_as_well_is_no_matter_of_its_height() -> None:
    here = painted_region(BOX)
    one = stretched(here, 0.75)
    off = replace(one, steps=replace(one.steps, shadow=one.steps.body))
    assert found(here, off) == [off]
