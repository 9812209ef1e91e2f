"""A body in the frame of a guess, and what it is in the marker's."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.transforms import camera_centre
from ashe_live.light.shape.body import HIGHEST_NEARNESS, Body, BodyFrame, LitBody
from ashe_live.light.shape.families import FAMILIES
from ashe_live.light.shape.layout import light_parameters, nearness_of
from ashe_live.light.shape.light_points import towards
from ashe_live.light.shape.predicted import lit_outlines, outlines
from ashe_live.light.shape.sight import Sight
from tests.light.painted_bodies import body_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster
from tests.light.synthetic_masks import direction


def painted(caster: Caster) -> Body:
    return body_of(painted_region(caster), caster).body


def test_a_boxs_corners_are_in_metres_where_it_stands() -> None:
    points = painted(BOX).proxy.spheroids_marker
    expected = np.concatenate([np.roll(corners, 2, axis=0) for corners in (BOX.base(), BOX.top())])
    np.testing.assert_allclose(points[:, :3], expected, atol=1e-12)
    np.testing.assert_array_equal(points[:, 3:], 0)


def test_a_cylinders_rings_are_in_metres_where_it_stands() -> None:
    (x, y), radius = CYLINDER.at, CYLINDER.width_m / 2
    expected = [(x, y, 0, radius, 0), (x, y, CYLINDER.height_m, radius, 0)]
    np.testing.assert_allclose(painted(CYLINDER).proxy.spheroids_marker, expected, atol=1e-12)


def test_a_radius_has_no_sign() -> None:
    body = painted(CYLINDER)
    turned = replace(body, shape=body.shape * [1, 1, 1, -1, -1])
    np.testing.assert_allclose(turned.proxy.spheroids_marker, body.proxy.spheroids_marker)


def test_lights_are_unit_vectors_from_which_the_shadow_falls() -> None:
    here = painted_region(BOX)
    lights = [here.scene.to_light, direction(30.0, 5.0), direction(0.0, 90.0)]
    for found, light in zip(body_of(here, BOX, *lights).to_lights_marker, lights, strict=True):
        np.testing.assert_allclose(found, light, atol=1e-12)


@pytest.mark.parametrize("name", FAMILIES)
def test_steps_go_to_the_lights_first_and_back_again(name: str) -> None:
    start = body_of(painted_region(BOX), BOX, direction(30.0, 40.0), direction(110.0, 70.0))
    count = len(FAMILIES[name].spread)
    body = Body(start.body.frame, FAMILIES[name], np.linspace(-1, 1, count))
    lit = LitBody(body, start.lights)
    step = np.arange(4.0 + count)
    there = lit.moved(step)
    np.testing.assert_array_equal(light_parameters(there.lights), light_parameters(lit.lights) + step[:4].reshape(2, 2))
    np.testing.assert_array_equal(there.body.shape, body.shape + step[4:])
    np.testing.assert_allclose(there.moved(-step).body.proxy.spheroids_marker, body.proxy.spheroids_marker, atol=1e-12)
    assert (body.proxy.spheroids_marker[:, 3:] >= 0).all()


def test_a_lamp_in_a_bodys_own_frame_stands_where_it_stood() -> None:
    place, lamp = BodyFrame(np.array([0.3, -0.2]), 0.05), np.array([[0.4, 0.1, 0.8, 1.0]])
    x, y, z, w = (place.T_marker_body @ place.lights(lamp)[0]).tolist()
    np.testing.assert_allclose(np.array([x, y, z]) / w, lamp[0, :3])
    np.testing.assert_allclose(place.lights_marker(place.lights(lamp)), lamp)


def test_a_lamp_is_seen_from_the_bodys_foot() -> None:
    body, lamp = painted(BOX), np.array([0.4, 0.1, 0.8, 1.0])
    (found,) = LitBody(body, lamp[None]).to_lights_marker
    offset = lamp[:3] - (*BOX.at, 0.0)
    np.testing.assert_allclose(found, offset / np.linalg.norm(offset))


@pytest.mark.parametrize("light", [(0.5, 0.2, 0.9, 0.0), (-0.4, 0.3, 0.8, 1.1)], ids=["sun", "lamp"])
@pytest.mark.parametrize("nearness", [0.0, 0.7, 2.0, 1e6])
def test_a_light_brought_nearer_is_seen_in_the_same_direction_from_the_bodys_middle(
    light: tuple[float, ...], nearness: float
) -> None:
    other = np.array([0.1, -0.7, 0.6, 0.3])
    lit = LitBody(painted(BOX), np.array([light, other]))
    near = lit.with_first_light_near(nearness).lights
    middle = np.array([*BOX.at, lit.body.middle_m])
    np.testing.assert_allclose(towards(near[0], middle), towards(np.array(light), middle), atol=1e-9)
    # A lamp stays well above the body's top.
    assert nearness_of(near[:1])[0] == pytest.approx(min(nearness, HIGHEST_NEARNESS / lit.body.middle_m))
    np.testing.assert_allclose(near[1] / near[1, 2], other / other[2])
    several = lit.first_light_near([0.0, nearness])
    np.testing.assert_allclose(several[1], near[0] / near[0, 2])
    assert nearness_of(several)[0] == 0


def test_a_step_of_the_nearness_keeps_a_lamp_above_the_body() -> None:
    lit = LitBody(painted(BOX), np.array([[0.5, 0.2, 0.9, 0.3]]))
    for step, expected in ((-10.0, 0.0), (1000.0, HIGHEST_NEARNESS / lit.body.middle_m)):
        moved = lit.moved(np.array([0, 0, step, 0, 0, 0, 0, 0, 0.0]), with_nearness=True)
        assert nearness_of(moved.lights)[0] == pytest.approx(expected)


def test_a_step_leaves_a_lamp_as_high_as_it_was() -> None:
    lit = LitBody(painted(BOX), np.array([[0.8, 0.2, 1.6, 2.0]]))
    there = lit.moved(np.array([0.3, -0.1, 0, 0, 0, 0, 0, 0])).lights
    np.testing.assert_allclose(there / there[:, 3:], [[0.4 + 0.3 * 0.8, 0.1 - 0.1 * 0.8, 0.8, 1.0]])


def test_outlines_of_several_bodies_are_those_of_each() -> None:
    """Of different families in different views."""
    several = [
        (painted_region(caster, azimuth_deg=azimuth), caster) for caster in (BOX, CYLINDER) for azimuth in (80.0, 200.0)
    ]
    bodies = [body_of(here, caster) for here, caster in several]
    views = [here.region.view for here, _ in several]
    sights = [Sight.of(view) for view in views]
    for lit, view, found in zip(bodies, views, lit_outlines(bodies, sights), strict=True):
        for hull, expected in zip(found, outlines(lit.body.proxy, lit.lights, view), strict=True):
            assert hull is not None
            assert expected is not None
            angles = np.linspace(0, 2 * np.pi, 60)
            directions = np.array([np.cos(angles), np.sin(angles)])
            # Circles are drawn with corners, which need not be the same.
            np.testing.assert_allclose((hull @ directions).max(axis=0), (expected @ directions).max(axis=0), atol=0.2)


def test_a_shadow_that_reaches_behind_the_camera_is_cut_off_before_it() -> None:
    """Projected without that it would turn round, and lie on the other side of the picture."""
    here = painted_region(BOX)
    view = here.region.view
    eye = camera_centre(view.T_cam_marker)
    # A sun opposite the camera, a little higher than where the shadow's end is at the camera's foot.
    towards_camera = np.degrees(np.arctan2(eye[1] - BOX.at[1], eye[0] - BOX.at[0]))
    lit = body_of(here, BOX, direction(float(towards_camera) + 180.0, 2.0))
    body, shadow = lit_outlines([lit], [Sight.of(view)])[0]
    expected_body, expected_shadow = outlines(lit.body.proxy, lit.lights, view)
    assert body is not None
    assert shadow is not None
    for found, expected in ((body, expected_body), (shadow, expected_shadow)):
        np.testing.assert_allclose(found.min(axis=0), expected.min(axis=0), atol=0.5)
        np.testing.assert_allclose(found.max(axis=0), expected.max(axis=0), rtol=1e-3)
    # It begins at the body, and leaves the picture towards the camera, which is below.
    assert shadow[:, 1].max() > view.size[1]
    assert shadow[:, 1].min() > body[:, 1].min()


@pytest.mark.parametrize("lamp", [False, True], ids=["sun", "lamp"])
@pytest.mark.parametrize("factor", [0.7, 1.6])
@pytest.mark.parametrize("name", [name for name, family in FAMILIES.items() if family.heights and name != "lump"])
def test_a_stretched_body_throws_the_same_shadow(name: str, factor: float, lamp: bool) -> None:
    here = painted_region(BOX)
    frame, sight = body_of(here, BOX).body.frame, Sight.of(here.region.view)
    body = Body(frame, FAMILIES[name], np.full(len(FAMILIES[name].spread), -0.6))
    light = np.array([0.4, -0.2, 0.5, 1.0 if lamp else 0.0])
    lit = LitBody(body, light[None])
    taller = lit.stretched(factor)
    assert taller is not None
    own, stretched = (each.body.proxy.points_marker()[:, 2].max() for each in (lit, taller))
    assert stretched == pytest.approx(factor * own)
    (_, before), (_, after) = lit_outlines([lit, taller], [sight] * 2)
    assert before is not None
    assert after is not None
    angles = np.linspace(0, 2 * np.pi, 60)
    directions = np.array([np.cos(angles), np.sin(angles)])
    # Circles are drawn with corners, which need not be the same.
    np.testing.assert_allclose((after @ directions).max(axis=0), (before @ directions).max(axis=0), atol=0.2)


def test_a_ball_is_no_stretched_ball() -> None:
    body = Body(painted(BOX).frame, FAMILIES["sphere"], np.zeros(3))
    assert LitBody(body, np.array([[0.3, 0.2, 1.0, 0.0]])).stretched(1.5) is None


def spheroids_of(name: str, *shape: float) -> np.ndarray:
    """(k, 5) of a member of a family whose frame is the marker's."""
    return Body(BodyFrame(np.zeros(2), 1.0), FAMILIES[name], np.array(shape)).proxy.spheroids_marker


def fraction(share: float) -> float:
    """The parameter that stands for it."""
    return float(np.log(share / (1 - share)))


def test_a_wagon_is_an_l_raised_on_four_feet() -> None:
    breadth, depth, height, length, level, clearance, inset = 0.5, 0.3, 0.8, 0.4, 0.6, 0.25, 0.7
    points = spheroids_of(
        "wagon",
        2.0,
        -1.0,
        np.pi / 2,
        *np.log([breadth, depth, height, length]),
        *map(fraction, (level, clearance, inset)),
    )
    assert not points[:, 3:].any()
    tall, low, feet = points[:8, :3], points[8:12, :3], points[12:, :3]
    lift = clearance * height
    # Turned by a quarter, what is across runs along y, and what is along it against x.
    np.testing.assert_allclose(np.ptp(tall, axis=0), (2 * depth, 2 * breadth, height - lift))
    np.testing.assert_allclose((tall[:, 2].min(), tall[:, 2].max()), (lift, height))
    np.testing.assert_allclose((low[:, 2].min(), low[:, 2].max()), (lift, lift + level * (height - lift)))
    np.testing.assert_allclose(low[:, 1], -1.0 + breadth + length)
    np.testing.assert_allclose(feet[:, 2], 0)
    np.testing.assert_allclose(np.ptp(feet[:, 1]), inset * (2 * breadth + length))
    np.testing.assert_allclose(feet[:, 1].mean(), -1.0 + length / 2)
    np.testing.assert_allclose(np.sort(np.unique(points[:, 0].round(9))), (2.0 - depth, 2.0 + depth))


def test_an_ell_is_a_box_and_a_lower_one_at_its_side() -> None:
    breadth, depth, height, length, level = 0.5, 0.3, 0.8, 0.4, 0.6
    points = spheroids_of("ell", 2.0, -1.0, 0.0, *np.log([breadth, depth, height, length]), fraction(level))
    tall, low = points[:8, :3], points[8:, :3]
    np.testing.assert_allclose((tall.min(axis=0), tall.max(axis=0)), ((1.5, -1.3, 0), (2.5, -0.7, height)))
    np.testing.assert_allclose((low.min(axis=0), low.max(axis=0)), ((2.9, -1.3, 0), (2.9, -0.7, level * height)))


def test_a_pylon_is_a_cone_on_a_square_plate_and_a_mug_has_its_handle_at_its_side() -> None:
    plate = spheroids_of("pylon", 2.0, -1.0, 0.0, np.log(0.5), fraction(0.1), np.log(0.8), 0.2)
    np.testing.assert_allclose(
        (plate[:8, :3].min(axis=0), plate[:8, :3].max(axis=0)), ((1.5, -1.5, 0), (2.5, -0.5, 0.08))
    )
    np.testing.assert_allclose(plate[8], (2.0, -1.0, 0.8, 0.2, 0))
    mug = spheroids_of("mug", 2.0, -1.0, np.log(0.8), 0.3, 0.4, 0.5, -0.1, fraction(0.5), *np.log([0.1, 0.2]))
    np.testing.assert_allclose(mug, [(2, -1, 0, 0.3, 0), (2, -1, 0.8, 0.4, 0), (2.5, -1.1, 0.4, 0.1, 0.2)])
