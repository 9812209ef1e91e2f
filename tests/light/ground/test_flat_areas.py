"""What other views confirm to lie on the plane is no part of an object, whatever its colour."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.materials import object_cost
from ashe_live.light.pixels.areas import grown, shrunk
from ashe_live.light.pixels.mixtures import UNEXPLAINED
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX


@pytest.fixture(scope="module")
def scene() -> PaintedRegion:
    return painted_region(BOX)


def with_borders_on_plane(scene: PaintedRegion, flat: Mask) -> Region:
    """The region as others see it: the border of `flat` stays in its place, the body's shears, insides tell nothing."""
    rim = grown(flat, 1) & ~shrunk(flat, 2) & ~scene.body
    on_plane = np.where(rim, 1.5, 0.0) - np.where(scene.body & ~shrunk(scene.body, 2), 3.0, 0.0)
    return dataclasses.replace(scene.region, on_plane=on_plane.astype(np.float32))


def test_an_area_whose_border_stays_is_flat_all_over(scene: PaintedRegion) -> None:
    region = with_borders_on_plane(scene, scene.shadow)
    assert region.flat is not None
    inside = shrunk(scene.shadow, 2)
    assert region.on_plane is not None
    assert not region.on_plane[inside].any()
    assert region.flat[inside].mean() > 0.95
    assert not region.flat[shrunk(scene.body, 2)].any()


def test_one_view_tells_of_none(scene: PaintedRegion) -> None:
    assert scene.region.flat is None


def test_a_flat_area_costs_as_much_as_what_no_object_explains_though_it_was_taken_for_one(scene: PaintedRegion) -> None:
    wrong = scene.body | scene.shadow
    inside = shrunk(scene.shadow, 3)
    assert np.median(object_cost(scene.region, wrong)[inside]) < UNEXPLAINED - 5
    costs = object_cost(with_borders_on_plane(scene, scene.shadow), wrong)
    assert (costs[inside] == np.float32(UNEXPLAINED)).mean() > 0.95
    # The object's own colours are learned without it.
    alone = object_cost(scene.region, scene.body)
    body = shrunk(scene.body, 3)
    assert np.median(costs[body]) == pytest.approx(float(np.median(alone[body])), abs=1.0)
