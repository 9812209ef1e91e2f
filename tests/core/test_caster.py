"""Bodies of known shape and size: as they are written, and where they stand."""

import math
import pickle

import numpy as np
import pytest

from ashe_live.core.caster import Caster, parsed_caster
from ashe_live.errors import UserError

WRITTEN = {
    "box:0.06x0.04x0.1": Caster.box(0.06, 0.04, 0.1),
    "cylinder:0.03X0.12": Caster.cylinder(0.03, 0.12),
    "sphere:4e-2": Caster.sphere(0.04),
}


@pytest.mark.parametrize("spec", WRITTEN)
def test_what_is_written_is_meant_and_can_be_sent(spec: str) -> None:
    assert parsed_caster(spec) == WRITTEN[spec]
    assert pickle.loads(pickle.dumps(WRITTEN[spec])) == WRITTEN[spec]
    assert hash(parsed_caster(spec)) == hash(WRITTEN[spec])


@pytest.mark.parametrize(
    "spec",
    [
        "", "tin", "ball:0.04", "box", "box:", "box:0.1", "box:0.1x0.1", "box:0.1x0.1x0.1x0.1", "box:axbxc",
        "cylinder:0.1", "cylinder:0.03x0.12x1", "sphere:0.1x0.1", "sphere:nan", "sphere:inf", "sphere:-0.1", "sphere:0",
        "sphere:40", "cylinder:9x9", "box:60x40x100",
    ],
)  # fmt: skip
def test_what_is_no_body_on_a_table_is_said_in_one_line(spec: str) -> None:
    with pytest.raises(UserError) as told:
        parsed_caster(spec)
    assert "\n" not in str(told.value)
    assert told.value.remedy


def test_a_box_stands_on_its_foot_and_is_as_large_as_it_was_measured() -> None:
    points = np.array(Caster.box(0.06, 0.04, 0.1).spheroids)[:, :3]
    np.testing.assert_allclose(np.ptp(points, axis=0), (0.06, 0.04, 0.1))
    np.testing.assert_allclose(points.min(axis=0), (-0.03, -0.02, 0))


def test_a_ball_and_a_tin_touch_the_table() -> None:
    (ball,) = Caster.sphere(0.04).spheroids
    assert ball == (0, 0, 0.04, 0.04, 0.04)
    assert Caster.cylinder(0.03, 0.12).spheroids == ((0, 0, 0, 0.03, 0), (0, 0, 0.12, 0.03, 0))


def test_a_hull_is_set_on_its_lowest_point_over_the_middle_of_its_extent() -> None:
    points = np.array([(1, 2, 5), (1.1, 2, 5.02), (1, 2.06, 5.3)])
    hull = np.array(Caster.hull(points).spheroids)[:, :3]
    np.testing.assert_allclose(hull[:, 2], (0, 0.02, 0.3), atol=1e-12)
    np.testing.assert_allclose(hull[:, :2].min(axis=0) + hull[:, :2].max(axis=0), 0, atol=1e-12)
    np.testing.assert_allclose(hull - hull[0], points - points[0], atol=1e-12)


def test_a_flat_hull_casts_no_shadow() -> None:
    with pytest.raises(UserError, match="casts no shadow"):
        Caster.hull(np.array([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], dtype=float))


def test_bodies_repeat_after_the_turn_that_they_say() -> None:
    assert Caster.box(0.06, 0.04, 0.1).period_rad == math.pi
    assert Caster.box(0.06, 0.06, 0.1).period_rad == math.pi / 2
    assert Caster.cylinder(0.03, 0.1).period_rad == 0.0
    assert Caster.hull(np.array([(0, 0, 0), (0.1, 0, 0.1), (0, 0.1, 0)])).period_rad == 2 * math.pi


def test_a_breadth_is_the_mean_over_all_sides() -> None:
    assert Caster.cylinder(0.03, 0.1).radius_m == pytest.approx(0.03)
    # The mean half breadth of a flat convex shape is its circumference over 2 pi (Cauchy).
    for width, depth in ((0.06, 0.06), (0.06, 0.02)):
        assert Caster.box(width, depth, 0.1).radius_m == pytest.approx((width + depth) / math.pi, rel=0.02)
