"""What is found late is asked the same questions as what is found at once."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.estimators.refining import Refiner
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.labels.associate import Split
from ashe_live.light.lamps.hypotheses import LampHypotheses
from ashe_live.light.pixels.areas import grown
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import CYLINDER, OtherLight

OTHER = OtherLight(80.0, 45.0, (0.25, 0.25, 0.25))


def doubtful(explanation: Explanation) -> float:
    return -3.0 - explanation.steps.shadow


def with_a_wrong_shadow(here: PaintedRegion) -> Explanation:
    ring = grown(here.body, 4) & ~here.body & ~here.shadow & here.region.is_ground
    (wrong,) = explained([Proposal(here.region, here.materials, Split(here.body, ring))], BALANCED.fine_fit)
    assert wrong is not None
    return wrong


def refiner_of(here: PaintedRegion) -> Refiner:
    return Refiner(here.view, Sharpener.of([here.view.fine]), BALANCED, LampHypotheses(None, here.ground))


@pytest.mark.parametrize("other", [None, OTHER], ids=["one light", "two lights"])
def test_a_shadow_found_by_the_shape_of_its_object_may_have_a_second_beside_it(other: OtherLight | None) -> None:
    here = painted_region(CYLINDER, other=other)
    found = refiner_of(here).refined_and_others([with_a_wrong_shadow(here)], doubtful)
    truths = [here.scene.to_light, *([] if other is None else [other.to_light])]
    right = [
        len(each.lights)
        for each in found
        if all(
            min(math.degrees(angle_between(light.to_light_marker, truth)) for truth in truths) < 4
            for light in each.lights
        )
    ]
    assert right
    assert set(right) == {len(truths)}


@pytest.mark.parametrize("certain", [False, True], ids=["doubtful before", "certain before"])
def test_a_second_light_that_takes_away_a_doubt_may_be_the_only_one(
    certain: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = painted_region(CYLINDER)
    wrong = with_a_wrong_shadow(here)
    (first,) = wrong.lights
    second = replace(first, light=np.append(here.scene.to_light, 0.0))
    pair = replace(wrong, lights=(first, second))
    monkeypatch.setattr(Refiner, "_refined_apart", lambda *_: ([pair], []))

    def odds(explanation: Explanation) -> float:
        return 3.0 if explanation is pair or (certain and explanation is wrong) else doubtful(explanation)

    found = refiner_of(here).refined_and_others([wrong], odds)
    alone = [each.lights[0].to_light_marker for each in found if len(each.lights) == 1]
    is_found = any(math.degrees(angle_between(light, here.scene.to_light)) < 4 for light in alone)
    assert is_found is not certain
