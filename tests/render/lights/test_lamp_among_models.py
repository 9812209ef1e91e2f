"""A lamp among several models, which no single view from it shows: each of them casts its shadow all the same."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import box_corners
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project, transform_points
from ashe_live.models.placement import Placement
from ashe_live.models.primitives import box
from ashe_live.quality import QUALITIES
from ashe_live.render.lights.light_view import seen_together, sees_all, view_of
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.scene import Scene
from tests.render.green_model import split
from tests.render.inside import inside_px

POLE = (0.02, 0.03, 0.06)
CORNERS = box_corners(np.array([(-POLE[0] / 2, -POLE[1] / 2, 0), (POLE[0] / 2, POLE[1] / 2, POLE[2])]))
LEFT, RIGHT, BEHIND = (
    Placement(shift_m=(-0.08, -0.01)),
    Placement(1.1, 0.6, (0.09, 0.02)),
    Placement(shift_m=(0.0, 0.1), turn_rad=1.0),
)
LAMP = np.array((0.01, 0.0, 0.08))


def _lamp(place: np.ndarray, ratio: float, radius_m: float = 0.001) -> Light:
    return Light(
        place,
        shadow_rgb_ratio=np.full(3, ratio),
        inverse_distance=1 / float(np.linalg.norm(place)),
        radius_m=radius_m,
    )


def _of_pole(placement: Placement) -> np.ndarray:
    return transform_points(placement.marker_from_placed, CORNERS)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_their_shadows_fall_where_the_planar_projection_says(make_renderer, stage, quality: str) -> None:
    """Whichever way around the lamp they stand, and however many of them."""
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(200, stage.pose(-90, 60, 0.6))
    pole = stage.placed(stage.glowing_green(box(POLE)))
    T_cam_marker = tracked.marker.T_cam_marker
    around = np.array([(math.cos(turn), math.sin(turn), 0.0) for turn in np.linspace(0, math.tau, 48, endpoint=False)])
    near = inside_px(project(tracked.camera, T_cam_marker, 0.2 * around)) > 0  # where the lamp outshines the rest
    for places in ((LEFT, RIGHT), (LEFT, RIGHT, BEHIND)):
        standing = [_of_pole(each) for each in places]
        (lamp,) = lighting_of((_lamp(LAMP, 0.02),)).lights
        assert view_of(lamp, np.concatenate(standing)) is None
        first, *others = places
        scene = Scene(
            tracked,
            pole,
            Illumination((_lamp(LAMP, 0.02),)),
            placement=first,
            others=tuple((pole, at) for at in others),
        )
        is_model, is_shadow = split(stage.picture(renderer, scene))
        inside = np.full(near.shape, -np.inf)
        for points in standing:
            cast = points + (points - LAMP) * (points[:, 2:] / (LAMP[2] - points[:, 2:]))
            in_shadow = inside_px(project(tracked.camera, T_cam_marker, cast))
            assert (is_shadow | is_model)[near & (in_shadow > 1.5)].all()
            assert (is_shadow & near & (in_shadow > 1.5)).sum() > 300
            inside = np.maximum(inside, in_shadow)
        assert not is_shadow[near & (inside < -1.5)].any()
        dark, _ = split(stage.picture(renderer, replace(scene, illumination=Illumination())))
        assert (dark == is_model).mean() > 0.999  # the lamp may be taken away again


@pytest.mark.parametrize("real_object", [None, Proxy("cup", np.array([(0.3, 0.3, z, 0.02, 0) for z in (0.0, 0.05)]))])
@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4), (0, 2, 4, 1, 3), (0, 3, 1, 4, 2)])
def test_beside_three_other_lights_those_around_a_lamp_cast_shadows(stage, make_renderer, order, real_object) -> None:
    """Which leaves few depth maps for each light: the shadows of five are all there, and of two beside a real object.

    A pole that is taller than the lamp shades all that is behind it.
    """
    turns = [math.tau * number / 5 for number in order]
    places = [Placement(shift_m=(0.08 * math.cos(turn), 0.08 * math.sin(turn)), turn_rad=turn) for turn in turns]
    tracked = stage.tracked(200, stage.pose(-90, 75, 0.7))
    pole = stage.placed(stage.glowing_green(box(POLE)))
    lamp = Light((0.0, 0.0, 1.0), shadow_rgb_ratio=np.full(3, 0.1), inverse_distance=1 / 0.035, radius_m=0.001)
    lights = (lamp, *(stage.light(90 * turn, 60, (0.999,) * 3) for turn in range(3)))
    first, *others = ((pole, place) for place in places)
    lit = Illumination(lights, real_object=real_object)
    scene = Scene(tracked, pole, lit, placement=first[1], others=tuple(others))
    renderer = make_renderer()
    behind = np.array([(0.12 * math.cos(turn), 0.12 * math.sin(turn), 0.0) for turn in turns])
    columns, rows = project(tracked.camera, tracked.marker.T_cam_marker, behind).round().astype(int).T
    seen = []
    for casts_shadow in (True, False):
        seen.append(stage.picture(renderer, replace(scene, casts_shadow=casts_shadow))[rows, columns, 1].astype(float))
    # Beside the contact shadows, which are there in any case.
    assert (seen[0] < 0.93 * seen[1]).sum() >= (5 if real_object is None else 2)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_a_suns_shadows_stay_what_they_are_where_a_faint_lamp_is_among_them(make_renderer, stage, quality: str) -> None:
    """On the ground, on one another and beside the real object's, though each has a depth map of its own now."""
    cup = Proxy("cup", np.array([(0.17, 0.0, z, 0.02, 0) for z in (0.0, 0.08)]))
    tracked = stage.tracked(200, stage.pose(-70, 45, 0.6))
    white, plate = stage.placed(box(POLE)), stage.placed(box((0.05, 0.05, 0.01)))
    sun, faint = stage.light(170, 25, (0.3, 0.3, 0.3)), _lamp(LAMP, 0.998)
    pictures = []
    for lights in ((sun,), (sun, faint)):
        renderer = make_renderer(QUALITIES[quality].render)
        lit = Illumination(lights, real_object=cup, ground_rgb=np.full(3, 0.55), seen_in=tracked)
        places = ((plate, Placement(shift_m=(0.03, -0.02))), (white, RIGHT))
        pictures.append(stage.picture(renderer, Scene(tracked, white, lit, placement=LEFT, others=places)).astype(int))
    points = np.concatenate([_of_pole(LEFT), _of_pole(RIGHT)])
    assert view_of(lighting_of((faint,)).lights[0], points) is None
    difference = np.abs(pictures[0] - pictures[1]).max(axis=2)
    assert (np.abs(pictures[0] - 200).max(axis=2) > 30).sum() > 5000
    # Borders are as sharp as the texels of their depth map.
    assert (difference > 3).mean() < 0.01
    assert (difference > 25).mean() < 0.001


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_their_penumbrae_are_as_wide_as_the_lamp_looks_from_below_each(make_renderer, stage, quality: str) -> None:
    """By the law of a disc that a straight edge covers, though from the middle between them the lamp looks narrower."""
    height, top, edge, radius = 0.1, 0.03, 0.1, 0.012
    plate = stage.placed(stage.glowing_green(box((0.04, 0.06, 0.002)).moved(1.0, np.array([0.0, 0.0, top - 0.002]))))
    tracked = stage.tracked(255, stage.pose(0, 50, 0.4, target=(0.14, 0, 0)))
    renderer = make_renderer(QUALITIES[quality].render)
    lit = Illumination((_lamp(np.array((0.0, 0.0, height)), 0.0, radius),))
    here, there = Placement(shift_m=(edge - 0.02, 0.0)), Placement(shift_m=(0.02 - edge, 0.0))
    renderer.render(Scene(tracked, plate, lit, placement=here, others=((plate, there),)))
    xs = np.linspace(0.12, 0.17, 51)
    over = np.arctan2(height, xs) - np.arctan2(top, xs - edge)
    t = np.clip(over / np.arcsin(radius / np.hypot(height, xs)), -1, 1)
    free = 0.5 + (t * np.sqrt(1 - t**2) + np.arcsin(t)) / math.pi
    assert ((free > 0.05) & (free < 0.95)).sum() > 12
    assert np.abs(stage.along(renderer.read_bgr(), tracked, xs) - free).mean() < 0.02


def test_groups_are_as_few_as_a_lamp_can_see() -> None:
    """Each of them as one; a body that holds a lamp is alone, and without a lamp near by all are one group."""
    bodies = [_of_pole(each) for each in (LEFT, RIGHT, BEHIND, Placement(shift_m=(0.12, 0.03)))]
    sun = lighting_of((Light((1.0, 0.0, 1.0)),)).lights
    far = lighting_of((_lamp(np.array((0.0, 0.0, 0.5)), 0.3),)).lights
    among = lighting_of((_lamp(LAMP, 0.3), Light((1.0, 0.0, 1.0)))).lights
    inside = lighting_of((_lamp(np.array((-0.08, -0.01, 0.03)), 0.3),)).lights
    for lights in (sun, far, (*sun, *far)):
        assert seen_together(bodies, lights, 5) == [[0, 1, 2, 3]]
    groups = seen_together(bodies, among, 5)
    assert sorted(number for group in groups for number in group) == [0, 1, 2, 3]
    assert 2 <= len(groups) <= 3
    assert any({1, 3} <= set(group) for group in groups)  # next to one another
    for group in groups:
        assert view_of(among[0], np.concatenate([bodies[number] for number in group])) is not None
    for one, group in itertools.product((*far, *among), seen_together(bodies, (*far, *among), 5)):
        assert view_of(one, np.concatenate([bodies[number] for number in group])) is not None
    assert [0] in seen_together(bodies, inside, 5)
    assert len(seen_together(bodies, among, 1)) == 1


def test_what_too_few_groups_do_not_show_is_left_out_of_as_few_as_possible() -> None:
    """Three around a lamp in two groups are all seen; of one that holds the lamp the others keep their views."""
    around = [Placement(shift_m=(0.08 * math.cos(turn), 0.08 * math.sin(turn))) for turn in (0.0, 2.1, 4.2)]
    low, holds = np.array((0.0, 0.0, 0.035)), Placement()
    (lamp,) = lighting_of((_lamp(low, 0.3),)).lights
    for places, unseen in ((around, 0), ([holds, *around[:2]], 1), ([*around[:2], holds], 1)):
        bodies = [_of_pole(each) for each in places]
        groups = seen_together(bodies, (lamp,), 2 if unseen == 0 else 3)
        views = [view_of(lamp, np.concatenate([bodies[number] for number in group])) for group in groups]
        assert sum(view is None for view in views) == unseen
    # Two side by side stay seen where the one across has to share its view with those that hold the lamp.
    beside = [Placement(shift_m=(0.08, 0.03 * number)) for number in range(2)]
    places = [*beside, Placement(shift_m=(-0.08, 0.0)), holds, replace(holds, turn_rad=0.5)]
    assert seen_together([_of_pole(each) for each in places], (lamp,), 2) == [[0, 1], [2, 3, 4]]
    suns = tuple(Light((0.1 * number, 0.0, 1.0)) for number in range(3))
    ring = [_of_pole(Placement(shift_m=(0.08 * math.cos(turn), 0.08 * math.sin(turn)))) for turn in 0.7 * np.arange(9)]
    for lights, beside_real in itertools.product(((_lamp(low, 0.3),), (_lamp(low, 0.3), *suns)), (False, True)):
        assert sees_all(lights, ring, beside_real) == (len(lights) == 1 or not beside_real)
