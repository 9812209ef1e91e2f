"""An object's shadow that no explanation has: found by the object's shape, and only where it shows its border."""

import math
from dataclasses import replace

import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.searches.first_shadow import with_shadows_searched
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.labels.associate import Split
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster


def beside_its_shadow(here: PaintedRegion) -> Explanation:
    """The object with what surrounds it, and is no shadow, labelled as one."""
    ring = grown(here.body, 4) & ~here.body & ~here.shadow & here.region.is_ground
    (found,) = explained([Proposal(here.region, here.materials, Split(here.body, ring))], BALANCED.fine_fit)
    assert found is not None
    return found


def searched(here: PaintedRegion, *judged: Explanation) -> list[Explanation]:
    view = here.view
    sharpen = Sharpener.of([view.fine]).sharpened
    return with_shadows_searched(judged, view, BALANCED.region_px, sharpen, as_the_steps_say)


def as_the_steps_say(explanation: Explanation) -> float:
    return -explanation.steps.shadow


def errors_deg(found: list[Explanation], to_light: Float) -> list[float]:
    return [math.degrees(angle_between(each.lights[0].to_light_marker, to_light)) for each in found]


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_a_shadow_that_labels_missed_is_found_by_the_shape_of_its_object(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    wrong = beside_its_shadow(here)
    (before,) = errors_deg([wrong], here.scene.to_light)
    assert before > 10
    found = searched(here, wrong)
    assert min(errors_deg(found, here.scene.to_light)) < 3


def test_one_object_by_nearly_one_light_is_explained_once() -> None:
    here = painted_region(CYLINDER)
    sharpener = Sharpener.of([View.of(here.scene.tracked, BALANCED.fine_width_px)])
    (rough,) = explained([Proposal(here.region, here.materials, Split(here.body, here.shadow))], BALANCED.fine_fit)
    assert rough is not None
    (right,) = sharpener.sharpened([rough])
    near = [error for error in errors_deg(searched(here, right), here.scene.to_light) if error < 10]
    assert len(near) == 1


def test_what_is_no_clear_object_has_no_shadow_searched() -> None:
    here = painted_region(CYLINDER)
    wrong = beside_its_shadow(here)
    unclear = replace(wrong, alignment=replace(wrong.alignment, clear_body=0.4))
    assert searched(here, unclear) == [unclear]
