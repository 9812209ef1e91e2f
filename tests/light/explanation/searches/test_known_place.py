"""A known body's place in a light that the picture may show, found without a split of what stands out."""

import math

import numpy as np
import pytest

from ashe_live.core.caster import Caster
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.searches.known_place import Hint, explanations_by_place, hints_of
from ashe_live.light.labels.associate import Split
from ashe_live.light.shape.light_points import at_infinity
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER
from tests.light.painted_scenes import Caster as Shape

KNOWN = {
    "box": Caster.box(BOX.width_m, BOX.width_m, BOX.height_m),
    "cylinder": Caster.cylinder(CYLINDER.width_m / 2, CYLINDER.height_m),
}


def placed(here: PaintedRegion, caster: Caster, turned_deg: float = 0.0) -> list[Explanation]:
    """By the true light, turned about the vertical."""
    c, s = math.cos(math.radians(turned_deg)), math.sin(math.radians(turned_deg))
    light = at_infinity((np.array([(c, -s, 0), (s, c, 0), (0, 0, 1)]) @ here.scene.to_light)[None])[0]
    hint = Hint(light, here.true_shift)
    return explanations_by_place(caster, [hint], here.view, here.unlit, BALANCED.region_px)


@pytest.mark.parametrize("shape", [BOX, CYLINDER], ids=lambda shape: shape.shape)
@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_a_body_is_found_where_it_stands_by_a_light_that_is_nearly_right(ground: str, shape: Shape) -> None:
    here = painted_region(shape, ground=ground)
    best = placed(here, KNOWN[shape.shape], turned_deg=4.0)[0]
    assert np.linalg.norm(best.proxy.foot_marker[:2] - shape.at) < 0.005
    assert here.error_deg(best) < 2


def test_lights_that_are_nearly_the_same_are_one_hint() -> None:
    here = painted_region(CYLINDER)
    (one,) = explained([Proposal(here.region, here.materials, Split(here.body, here.shadow))], BALANCED.fine_fit)
    assert one is not None
    (hint,) = hints_of([one, one], 5)
    np.testing.assert_array_equal(hint.shift, here.materials.shift)
    assert hints_of([one], 0) == []


def test_nothing_that_stands_out_is_no_place() -> None:
    here = painted_region(CYLINDER)
    hint = Hint(at_infinity(here.scene.to_light[None])[0], here.true_shift)
    nothing = np.zeros_like(here.unlit)
    assert explanations_by_place(KNOWN["cylinder"], [hint], here.view, nothing, 100) == []
