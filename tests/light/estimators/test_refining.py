"""What is found late is asked the same questions as what is found at once."""

import math

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
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import CYLINDER, OtherLight

OTHER = OtherLight(80.0, 45.0, (0.25, 0.25, 0.25))


def doubtful(explanation: Explanation) -> float:
    return -3.0 - explanation.steps.shadow


@pytest.mark.parametrize("other", [None, OTHER], ids=["one light", "two lights"])
def test_a_shadow_found_by_the_shape_of_its_object_may_have_a_second_beside_it(other: OtherLight | None) -> None:
    here = painted_region(CYLINDER, other=other)
    ring = grown(here.body, 4) & ~here.body & ~here.shadow & here.region.is_ground
    (wrong,) = explained([Proposal(here.region, here.materials, Split(here.body, ring))], BALANCED.fine_fit)
    assert wrong is not None
    view = here.view
    lamps = LampHypotheses(None, here.ground)
    refiner = Refiner(view, Sharpener.of([view.fine]), BALANCED, lamps)
    found = refiner.refined_and_others([wrong], doubtful)
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
