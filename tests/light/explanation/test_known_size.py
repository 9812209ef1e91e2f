"""Whether a caster has the sizes that it is given: bodies of other heights that one view cannot tell from it."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.caster import Caster
from ashe_live.light.explanation.known_size import OTHER_HEIGHTS, _of_other_heights
from ashe_live.light.shape.body import Body, BodyFrame, LitBody
from ashe_live.light.shape.known import family_of, unit_m
from ashe_live.light.shape.light_points import cast_on_ground

SUN, LAMP = np.array([0.5, -0.4, 1.0, 0.0]), np.array([0.5, -0.4, 1.0, 1.5])


@pytest.mark.parametrize("light", [SUN, LAMP], ids=["sun", "lamp"])
@pytest.mark.parametrize("caster", [Caster.box(0.06, 0.04, 0.09), Caster.cylinder(0.03, 0.1)], ids=["box", "cylinder"])
def test_bodies_of_other_heights_cast_the_shadow_of_the_given_one(caster: Caster, light: Float) -> None:
    family = family_of(caster)
    shape = np.array([0.2, -0.1, 0.3])[: family.size]
    given = LitBody(Body(BodyFrame(np.array([0.08, 0.05]), unit_m(caster)), family, shape), light[None])

    def shadow(lit: LitBody) -> Float:
        cast = cast_on_ground(lit.body.proxy.points_marker(), lit.lights[0])
        assert cast is not None
        return cast

    others = _of_other_heights(given, caster)
    np.testing.assert_allclose([each.body.proxy.height_m / caster.height_m for each in others], OTHER_HEIGHTS)
    for each in others:
        np.testing.assert_allclose(shadow(each), shadow(given), atol=1e-12)
