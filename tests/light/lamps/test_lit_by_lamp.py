"""The lit ground under a painted lamp is even once its light's fall is taken out of it; under a sun nothing is."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.estimators.steps import BALANCED
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground
from ashe_live.light.lamps.kinds import AUTO, SUN
from ashe_live.light.lamps.lit_by_lamp import lit_ground_of
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import Caster, paint

OVERHEAD, BESIDE = np.array([0.0, 0.0, 0.2]), np.array([0.3, -0.2, 0.25])
FAR_AWAY = Caster("box", (5.0, 5.0), height_m=0.01)  # out of the picture


def grounds(lamp_m: Float | None, kind: str = AUTO) -> tuple[View, LitGround, LitGround]:
    view = View.of(paint(FAR_AWAY, lamp_m=lamp_m).tracked, BALANCED.coarse_width_px)
    by_quadratic = fit_lit_ground(view.image_bgr, view.is_ground, BALANCED.ground)
    found = lit_ground_of(view, BALANCED.ground, kind)
    assert by_quadratic is not None
    assert found is not None
    return view, by_quadratic, found


def unevenness(ground: LitGround, view: View) -> float:
    """Standard deviation of the log brightness, averaged over cells that are larger than the ground's texture."""
    brightness = np.where(view.is_ground, ground.colours[..., 0], np.nan)
    cells = [np.nanmean(block) for rows in np.array_split(brightness, 6) for block in np.array_split(rows, 8, axis=1)]
    return float(np.nanstd(cells))


@pytest.mark.parametrize("lamp_m", [OVERHEAD, BESIDE], ids=["overhead", "beside"])
def test_a_lamps_ground_becomes_more_even(lamp_m: Float) -> None:
    view, by_quadratic, found = grounds(lamp_m)
    assert found.fall is not None
    before, after = (unevenness(each, view) for each in (by_quadratic, found))
    assert after < 0.8 * before


@pytest.mark.parametrize(("lamp_m", "kind"), [(None, AUTO), (OVERHEAD, SUN)])
def test_no_fall_is_taken_out_under_a_sun(lamp_m: Float | None, kind: str) -> None:
    view, by_quadratic, found = grounds(lamp_m, kind)
    assert found.fall is None
    np.testing.assert_array_equal(found.colours[view.is_ground], by_quadratic.colours[view.is_ground])
