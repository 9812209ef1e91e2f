"""An object's shadow that no explanation has: found by the object's shape, and only where it shows its border."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.searches.first_shadow import with_shadows_searched
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.pixels.areas import grown, resized
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import PaintedRegion, in_region, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster

BESIDE = replace(BOX, at=(-0.02, -0.15))


def beside_its_shadow(here: PaintedRegion) -> Explanation:
    """The object with what surrounds it, and is no shadow, labelled as one."""
    ring = grown(here.body, 4) & ~here.body & ~here.shadow & here.region.is_ground
    (found,) = explained([Proposal(here.region, here.materials, Split(here.body, ring))], BALANCED.fine_fit)
    assert found is not None
    return found


def seen_in(here: PaintedRegion, region: Region, body: Mask, shadow: Mask) -> PaintedRegion:
    """What another region of the same scene shows; body, shadow: masks of the whole frame."""
    return replace(here, region=region, body=in_region(region, body), shadow=in_region(region, shadow))


def seen_again(here: PaintedRegion) -> PaintedRegion:
    """The same object and shadow in a larger region."""
    body, shadow = here.region.in_frame(here.body), here.region.in_frame(here.shadow)
    area = grown(resized(body | shadow, here.unlit.shape[::-1]), 12)
    return seen_in(here, here.view.region(area, BALANCED.region_px), body, shadow)


def as_the_steps_say(explanation: Explanation) -> float:
    return -explanation.steps.shadow


def searched(
    here: PaintedRegion, *judged: Explanation, log_odds: Callable[[Explanation], float] = as_the_steps_say
) -> list[Explanation]:
    view = here.view
    sharpen = Sharpener.of([view.fine]).sharpened
    return with_shadows_searched(judged, view, BALANCED.region_px, sharpen, log_odds)


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


def test_one_object_that_two_regions_show_is_explained_once_by_one_light() -> None:
    here = painted_region(CYLINDER)
    again = seen_again(here)
    (rough,) = explained([Proposal(again.region, again.materials, Split(again.body, again.shadow))], BALANCED.fine_fit)
    assert rough is not None
    (right,) = Sharpener.of([here.view.fine]).sharpened([rough])
    found = searched(here, beside_its_shadow(here), right)
    assert len([error for error in errors_deg(found, here.scene.to_light) if error < 10]) == 1


def test_an_object_that_two_regions_show_takes_no_other_objects_place() -> None:
    here = painted_region(CYLINDER, BESIDE)
    first, second = (seen_in(here, region, here.scene.body, here.scene.shadow) for region in here.regions[:2])
    twice = [beside_its_shadow(first), beside_its_shadow(seen_again(first))]
    last = beside_its_shadow(second)
    order = {id(each): float(i) for i, each in enumerate([last, *twice])}
    found = searched(here, *twice, last, log_odds=lambda each: order.get(id(each), 10.0))
    new = [each for each in found if id(each) not in order]
    near_last = [each for each in new if each.stands_as(last, 0.2)]
    assert min(errors_deg(near_last, here.scene.to_light)) < 5


def test_what_is_no_clear_object_has_no_shadow_searched() -> None:
    here = painted_region(CYLINDER)
    wrong = beside_its_shadow(here)
    unclear = replace(wrong, alignment=replace(wrong.alignment, clear_body=0.4))
    assert searched(here, unclear) == [unclear]
