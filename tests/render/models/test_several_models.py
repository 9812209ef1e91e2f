"""Several models in one picture: what one model of all their parts would look like, in one light."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.models.catalogue import load_model
from ashe_live.models.mesh import Model
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, FAST, QUALITIES
from ashe_live.render.gl.offscreen import live_gl_objects
from ashe_live.render.scene import Scene

GROUND = 200
RATIO = (0.2, 0.25, 0.3)
RIGHT, LEFT = Placement(0.8, math.radians(40), (0.07, 0.01)), Placement(shift_m=(-0.08, 0.0))


def _joined(*models: tuple[PlacedModel, Placement]) -> PlacedModel:
    """One model of all parts, each where its placement brings it."""
    parts = []
    for placed, placement in models:
        matrix = placement.marker_from_placed
        for part in placed.model.parts:
            places = (part.vertices @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
            normals = (part.normals @ matrix[:3, :3].T / placement.scale).astype(np.float32)
            parts.append(replace(part, vertices=places, normals=normals))
    model = Model("joined", tuple(parts))
    return PlacedModel(model, model.bounds)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_they_look_like_one_model_of_all_their_parts(make_renderer, stage, quality: str) -> None:
    mug, goblet = (placed_on_marker(load_model(name), 0.08) for name in ("mug", "goblet"))
    cup = Proxy("cup", np.array([(-0.05, 0.08, z, 0.02, 0) for z in (0.0, 0.05)]))
    tracked = stage.tracked(GROUND, stage.pose(-70, 40, 0.6))
    lit = Illumination((stage.light(160, 35, RATIO), stage.light(20, 60, (0.8, 0.8, 0.8))), real_object=cup)
    pictures = []
    for scene in (
        Scene(tracked, mug, lit, others=((goblet, RIGHT),)),
        Scene(tracked, _joined((mug, UNMOVED), (goblet, RIGHT)), lit),
    ):
        pictures.append(stage.picture(make_renderer(QUALITIES[quality].render), scene).astype(float))
    changed = np.abs(pictures[1] - GROUND).max(axis=2) > 8
    here = np.abs(pictures[0] - pictures[1]).max(axis=2)
    assert changed.sum() > 10_000
    # One contact patch of both has coarser texels at their feet, and one albedo for what both throw onto the ground.
    assert np.mean(here[changed] > 8) < 0.05
    assert here.mean() < 0.4


def test_each_shades_the_other(make_renderer, stage) -> None:
    """A tower to the east takes the low eastern sun from a plate beside it."""
    plate = stage.placed(stage.glowing_green(box((0.03, 0.03, 0.002))))
    white = stage.placed(box((0.03, 0.03, 0.002), (1.0, 1.0, 1.0, 1.0)))
    tower = stage.placed(box((0.02, 0.06, 0.08), (1.0, 1.0, 1.0, 1.0)))
    tracked = stage.tracked(GROUND, stage.pose(-90, 60, 0.5))
    sun = Illumination((stage.light(0, 40, RATIO),))
    seen = stage.picture(make_renderer(BALANCED.render), Scene(tracked, plate, sun)).astype(int)
    is_plate = seen[..., 1] - seen[..., 2] > 60
    levels = []
    for others in ((), ((tower, Placement(shift_m=(0.05, 0.0))),), ((tower, Placement(shift_m=(-0.05, 0.0))),)):
        renderer = make_renderer(BALANCED.render)
        renderer.render(Scene(tracked, white, sun, others=others))
        levels.append(np.median(renderer.read_bgr()[is_plate].astype(float), axis=0).mean())
    alone, to_the_sun, behind = levels
    assert to_the_sun < 0.75 * alone
    assert behind == pytest.approx(alone, rel=0.05)


def test_the_sky_that_both_hide_is_hidden_by_both(make_renderer, stage) -> None:
    """Without any sun: between two walls it is darker than beside one, and each as dark as the other."""
    wall = stage.placed(box((0.01, 0.1, 0.06)))
    tracked = stage.tracked(GROUND, stage.pose(-90, 70, 0.5))
    where = np.array((-0.02, 0.02))  # on both sides of the first
    levels = []
    for others in ((), ((wall, Placement(shift_m=(0.05, 0.0))),)):
        renderer = make_renderer(BALANCED.render)
        renderer.render(Scene(tracked, wall, Illumination(), others=others))
        levels.append(stage.along(renderer.read_bgr(), tracked, where))
    assert levels[0][0] == pytest.approx(levels[0][1], rel=0.03)
    assert levels[1][0] == pytest.approx(levels[0][0], rel=0.05)
    assert levels[1][1] < 0.95 * levels[0][1]


def test_in_a_deep_shadow_a_foot_is_as_dark_whichever_model_comes_first(make_renderer, stage) -> None:
    """What hangs above the ground beside a mug's foot is lit by shaded ground."""
    mug, cube = (placed_on_marker(load_model(name), 0.08) for name in ("mug", "cube"))
    tracked = stage.tracked(GROUND, stage.pose(-70, 30, 0.5))
    deep = Illumination((stage.light(90, 45, (0.04, 0.04, 0.04)),))
    pictures = []
    for scene in (
        Scene(tracked, mug, deep, placement=LEFT, others=((cube, RIGHT),)),
        Scene(tracked, cube, deep, placement=RIGHT, others=((mug, LEFT),)),
    ):
        pictures.append(stage.picture(make_renderer(BALANCED.render), scene).astype(float))
    changed = np.abs(pictures[0] - GROUND).max(axis=2) > 8
    assert changed.sum() > 10_000
    assert np.abs(pictures[0] - pictures[1]).max() <= 3


def test_one_whose_marker_is_not_in_view_is_not_drawn_and_comes_back_at_once(make_renderer, stage) -> None:
    mug, tree = (placed_on_marker(load_model(name), 0.08) for name in ("mug", "tree"))
    tracked, lit = stage.tracked(GROUND, stage.pose(-90, 40, 0.6)), Illumination((stage.light(120, 40),))
    renderer = make_renderer(FAST.render)
    both, one = (Scene(tracked, mug, lit, others=((tree, place),)) for place in (RIGHT, None))
    renderer.render(both, waits=False)
    together, objects = renderer.read_bgr(), live_gl_objects()
    renderer.render(one, waits=False)
    alone = renderer.read_bgr()
    assert live_gl_objects() <= objects
    renderer.render(both, waits=False)
    np.testing.assert_array_equal(renderer.read_bgr(), together)
    renderer.render(Scene(tracked, mug, lit), waits=False)
    np.testing.assert_array_equal(renderer.read_bgr(), alone)
    assert (together != alone).any(axis=2).sum() > 3000


def test_one_that_is_taken_away_leaves_the_others_where_they_are(make_renderer, stage) -> None:
    """Also while models are switched when they are ready, and not at once."""
    mug, tree, cube = (placed_on_marker(load_model(name), 0.08) for name in ("mug", "tree", "cube"))
    tracked, lit = stage.tracked(GROUND, stage.pose(-90, 40, 0.7)), Illumination((stage.light(120, 40),))
    renderer = make_renderer(FAST.render)
    renderer.render(Scene(tracked, mug, lit, others=((tree, RIGHT), (cube, LEFT))))
    for left in (Scene(tracked, mug, lit, others=((cube, LEFT),)), Scene(tracked, cube, lit, placement=LEFT)):
        fresh = make_renderer(FAST.render)
        fresh.render(left)
        renderer.render(left, waits=False)
        assert renderer.is_settled
        np.testing.assert_array_equal(renderer.read_bgr(), fresh.read_bgr())
