"""Light and model by hand: what is grabbed follows the mouse, and nothing leaves the possible."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.contract import light_by_hand_json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angles_from_direction, direction_from_angles
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.mesh import Model
from ashe_live.models.placement import UNMOVED, Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.render.beside import picture_axes
from ashe_live.render.lights.lighting import angular_size, lighting_of
from ashe_live.viewer.hands.hand import (
    FARTHER_STEP,
    FARTHEST_LAMP_SIDES,
    FARTHEST_SIDES,
    FIRST_ELEVATION_RAD,
    HIGHEST_RAD,
    LARGEST,
    LIGHT_STEP_RAD,
    LOWEST_RAD,
    MOVE_STEP_SIDES,
    NEAREST_LAMP_SIDES,
    SCALE_STEP,
    SMALLEST,
    SOFTER_STEP,
    SOFTEST_RAD,
    TURN_STEP_RAD,
    Hand,
    HandContext,
)
from ashe_live.viewer.hands.pointing import ground_at, pixel_of
from ashe_live.viewer.hands.requests import Command, Drag, Request
from tests.camera_poses import looking_at

SIZE = (640, 480)
SIDE_M = 0.08
PINHOLE = Camera.from_focal(SIZE, 600.0)
BENT = Camera(SIZE, PINHOLE.K, np.array((-0.25, 0.08, 0.0, 0.0, 0.0)), "file")
MODEL = placed_on_marker(Model("box", (box((1, 1, 1)),)), SIDE_M)
HEIGHT_M = SIDE_M
ESTIMATED = Illumination(
    (
        Light(
            direction_from_angles(math.radians(200), math.radians(40)),
            np.eye(2) * 1e-3,
            0.05,
            0.9,
            0.01,
            np.array((0.3, 0.4, 0.5)),
        ),
        Light((0.0, 0.3, 1.0), shadow_rgb_ratio=np.array((0.8, 0.8, 0.8))),
    ),
    ambient_rgb_ratio=np.array((0.2, 0.25, 0.3)),
    ground_rgb=np.array((0.5, 0.4, 0.3)),
    real_object=Proxy("cup", np.array([(0.1, 0.0, 0.0, 0.03, 0.0), (0.1, 0.0, 0.08, 0.03, 0.0)])),
)

NEAR = replace(ESTIMATED, lights=(replace(ESTIMATED.lights[0], inverse_distance=2.0, radius_m=0.02),))


def seen_from(eye: tuple[float, float, float], camera: Camera = PINHOLE, aim=(0.0, 0.0, 0.0)) -> TrackedFrame:
    pose = MarkerPose(looking_at(aim, eye), np.zeros((4, 2)), SIDE_M, 0.1, None)
    return TrackedFrame(Frame(np.zeros((SIZE[1], SIZE[0], 3), np.uint8), 7, 0.0), camera, pose)


EYES = ((0.1, -0.5, 0.35), (0.4, 0.3, 0.5), (0.0, 0.1, 0.6))


def sight(tracked: TrackedFrame, illumination: Illumination = ESTIMATED) -> HandContext:
    return HandContext(tracked, illumination, MODEL)


def drag(hand: Hand, command: Command, seen: HandContext, begin, *ends) -> None:
    for place, end in enumerate(ends):
        hand.obey(Request(command, Drag(begin, end, place == 0)), seen)


def shadow_end(hand: Hand) -> np.ndarray:
    """(2,) of the top of the model's middle axis."""
    x, y, z, inverse = hand.light.light.homogeneous
    height, foot = HEIGHT_M * hand.placement.scale, np.array(hand.placement.shift_m)
    return (z * foot - height * np.array((x, y))) / (z - inverse * height)


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("camera", [PINHOLE, BENT], ids=["pinhole", "lens"])
def test_the_grabbed_point_of_the_table_stays_under_the_mouse(eye, camera):
    tracked, hand = seen_from(eye, camera), Hand()
    begin = (300.0, 260.0)
    grabbed = ground_at(tracked, begin)
    for now in ((350.0, 250.0), (360.0, 300.0), (210.0, 222.0)):
        hand.obey(Request(Command.MOVE_MODEL, Drag(begin, now, now[0] == 350)), sight(tracked))
        assert pixel_of(tracked, grabbed + hand.placement.shift_m) == pytest.approx(now, abs=0.01)
    drag(hand, Command.MOVE_MODEL, sight(tracked), (210.0, 222.0), begin)  # a new drag goes on from there
    np.testing.assert_allclose(hand.placement.shift_m, (0, 0), atol=1e-4)


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("camera", [PINHOLE, BENT], ids=["pinhole", "lens"])
@pytest.mark.parametrize("estimated", [ESTIMATED, Illumination(), NEAR], ids=["estimated", "none", "lamp"])
def test_the_shadows_end_follows_the_mouse(eye, camera, estimated):
    """Grabbed there, it stays under the mouse; grabbed elsewhere, it moves as many pixels."""
    tracked = seen_from(eye, camera)
    for beside in (0.0, 25.0):
        hand = Hand()
        hand.obey(Request(Command.MOVE_LIGHT, (0, 0)), sight(tracked, estimated))
        x, y = pixel_of(tracked, shadow_end(hand))
        for dx, dy in ((12.0, 4.0), (-30.0, 20.0), (40.0, -15.0)):
            begin, now = (x + beside, y), (x + beside + dx, y + dy)
            hand.obey(Request(Command.MOVE_LIGHT, Drag(begin, now, dx == 12)), sight(tracked, estimated))
            assert pixel_of(tracked, shadow_end(hand)) == pytest.approx((x + dx, y + dy), abs=0.01)


def test_a_model_that_stands_elsewhere_turned_and_enlarged_follows_the_mouse_and_so_does_its_shadow():
    tracked, hand = seen_from(EYES[0]), Hand()
    anchor = Placement(2.0, 1.0, (0.05, -0.02))
    begin, now = (300.0, 260.0), (350.0, 250.0)
    drag(hand, Command.MOVE_MODEL, HandContext(tracked, ESTIMATED, MODEL, anchor), begin, now)
    moved = np.subtract((anchor @ hand.placement).shift_m, anchor.shift_m)
    assert pixel_of(tracked, ground_at(tracked, begin) + moved) == pytest.approx(now, abs=0.01)

    hand = Hand()
    hand.obey(Request(Command.SCALE_MODEL, -5), sight(tracked))
    hand.obey(Request(Command.MOVE_LIGHT, (0, 0)), sight(tracked))
    x, y = pixel_of(tracked, shadow_end(hand))
    drag(hand, Command.MOVE_LIGHT, sight(tracked), (x, y), (x + 30, y + 10))
    assert pixel_of(tracked, shadow_end(hand)) == pytest.approx((x + 30, y + 10), abs=0.01)


@pytest.mark.parametrize("elevation_deg", [-10, 0.5, 8])
def test_a_shadow_whose_end_is_out_of_the_picture_comes_to_the_mouse(elevation_deg):
    estimated = replace(ESTIMATED, lights=(Light(direction_from_angles(1.0, math.radians(elevation_deg))),))
    tracked, hand = seen_from(EYES[0]), Hand()
    drag(hand, Command.MOVE_LIGHT, sight(tracked, estimated), (250.0, 300.0), (255.0, 300.0), (300.0, 310.0))
    assert pixel_of(tracked, shadow_end(hand)) == pytest.approx((300.0, 310.0), abs=0.01)


@pytest.mark.parametrize("eye", EYES)
def test_dragging_turns_the_light_the_way_the_shadow_goes(eye):
    """Around the foot clockwise on the table, the azimuth falls by as much; away from the foot, the light sinks."""
    tracked, hand = seen_from(eye), Hand()
    hand.obey(Request(Command.MOVE_LIGHT, (0, 0)), sight(tracked, Illumination()))
    azimuth, elevation = angles_from_direction(hand.light.light.to_light_marker)
    end = shadow_end(hand)
    turned = np.array([(math.cos(-0.3), -math.sin(-0.3)), (math.sin(-0.3), math.cos(-0.3))]) @ end
    drag(hand, Command.MOVE_LIGHT, sight(tracked), pixel_of(tracked, end), pixel_of(tracked, turned))
    now_azimuth, now_elevation = angles_from_direction(hand.light.light.to_light_marker)
    assert math.remainder(now_azimuth - azimuth + 0.3, math.tau) == pytest.approx(0, abs=1e-4)
    assert now_elevation == pytest.approx(elevation, abs=1e-4)
    drag(hand, Command.MOVE_LIGHT, sight(tracked), pixel_of(tracked, turned), pixel_of(tracked, 1.5 * turned))
    assert math.tan(elevation) / math.tan(angles_from_direction(hand.light.light.to_light_marker)[1]) == pytest.approx(
        1.5, abs=1e-3
    )


def test_keys_turn_and_raise_the_light_by_their_steps():
    tracked, hand = seen_from(EYES[0]), Hand()
    azimuth, elevation = angles_from_direction(ESTIMATED.light.to_light_marker)
    for step, turned, raised in (((1, 0), 1, 0), ((0, 1), 1, 1), ((-1, 0), 0, 1), ((0, -1), 0, 0)):
        hand.obey(Request(Command.MOVE_LIGHT, step), sight(tracked))
        expected = (azimuth + turned * LIGHT_STEP_RAD, elevation + raised * LIGHT_STEP_RAD)
        assert angles_from_direction(hand.light.light.to_light_marker) == pytest.approx(expected)


def test_a_first_light_comes_from_the_left_in_the_picture():
    for eye in EYES:
        tracked, hand = seen_from(eye), Hand()
        hand.obey(Request(Command.MOVE_LIGHT, (0, 0)), sight(tracked, Illumination()))
        right, _ = picture_axes(tracked)
        light = hand.light.light
        assert light.to_light_marker[:2] / np.linalg.norm(light.to_light_marker[:2]) == pytest.approx(-right)
        assert angles_from_direction(light.to_light_marker)[1] == pytest.approx(FIRST_ELEVATION_RAD)
        assert light.shadow_rgb_ratio is None


def test_what_was_measured_stays_and_what_was_known_of_the_direction_does_not():
    hand = Hand()
    hand.obey(Request(Command.MOVE_LIGHT, (5, 0)), sight(seen_from(EYES[0])))
    set_light, estimated = hand.light.light, ESTIMATED.light
    assert hand.frame_index == 7
    assert set_light.covariance_rad2 is set_light.sigma_rad is set_light.confidence is None
    assert set_light.angular_size_rad == estimated.angular_size_rad
    np.testing.assert_array_equal(set_light.shadow_rgb_ratio, estimated.shadow_rgb_ratio)
    np.testing.assert_array_equal(hand.light.ambient_rgb_ratio, ESTIMATED.ambient_rgb_ratio)
    np.testing.assert_array_equal(hand.light.ground_rgb, ESTIMATED.ground_rgb)
    assert hand.light.real_object is ESTIMATED.real_object
    assert hand.light.lights[1:] == ESTIMATED.lights[1:]


def test_the_light_stays_above_the_table():
    tracked, hand = seen_from(EYES[0]), Hand()
    for _ in range(100):
        hand.obey(Request(Command.MOVE_LIGHT, (0, -1)), sight(tracked))
    assert angles_from_direction(hand.light.light.to_light_marker)[1] == pytest.approx(LOWEST_RAD)
    azimuth = angles_from_direction(hand.light.light.to_light_marker)[0]
    for _ in range(100):
        hand.obey(Request(Command.MOVE_LIGHT, (0, 1)), sight(tracked))
    assert angles_from_direction(hand.light.light.to_light_marker) == pytest.approx((azimuth, HIGHEST_RAD))


@pytest.mark.parametrize("estimated", [ESTIMATED, NEAR], ids=["sun", "lamp"])
def test_no_drag_makes_anything_impossible(estimated):
    """Over horizon and zenith, on a plane seen from above, nearly edge on, edge on, from below."""
    random = np.random.default_rng(5)
    eyes = (*EYES, (0.0, -0.5, 0.02), (0.0, -0.5, 0.0), (0.1, -0.5, -0.2))
    for eye in eyes:
        tracked, hand = seen_from(eye, aim=(0.0, 0.3, 0.0)), Hand()
        for place in range(60):
            for command in (Command.MOVE_LIGHT, Command.MOVE_MODEL):
                begin, now = random.uniform(-300, 1200, (2, 2))
                drawn = Drag(tuple(begin), tuple(now), place % 3 == 0)
                hand.obey(Request(command, drawn), sight(tracked, estimated))
        if hand.light is not None:
            assert hand.light.light.inverse_distance == estimated.light.inverse_distance
            assert angles_from_direction(hand.light.light.to_light_marker)[1] >= LOWEST_RAD - 1e-9
        assert np.linalg.norm(hand.placement.shift_m) <= FARTHEST_SIDES * SIDE_M + 1e-9
        assert np.isfinite(hand.placement.marker_from_placed).all()


def test_above_the_horizon_nothing_moves():
    tracked, hand = seen_from((0.0, -0.5, 0.05)), Hand()
    drag(hand, Command.MOVE_MODEL, sight(tracked), (320.0, 300.0), (330.0, 300.0), (330.0, -200.0))
    moved = hand.placement
    assert moved != UNMOVED
    drag(hand, Command.MOVE_MODEL, sight(tracked), (320.0, -200.0), (330.0, 300.0))  # nothing to hold there
    assert hand.placement == moved


def test_keys_move_the_model_as_the_picture_shows_it():
    for eye in EYES:
        tracked, hand = seen_from(eye), Hand()
        for step in ((1, 0), (0, 1)):
            x, y = pixel_of(tracked, np.array(hand.placement.shift_m))
            before = np.array(hand.placement.shift_m)
            hand.obey(Request(Command.MOVE_MODEL, step), sight(tracked))
            now_x, now_y = pixel_of(tracked, np.array(hand.placement.shift_m))
            assert (now_x > x) if step == (1, 0) else (now_y < y)
            assert np.linalg.norm(hand.placement.shift_m - before) == pytest.approx(MOVE_STEP_SIDES * SIDE_M)


def test_the_model_grows_and_shrinks_between_its_limits():
    hand = Hand()
    hand.obey(Request(Command.SCALE_MODEL, 1), None)
    hand.obey(Request(Command.SCALE_MODEL, 1.5), None)
    assert hand.placement.scale == pytest.approx(SCALE_STEP**2.5)
    for notches, limit in ((1e9, LARGEST), (1, LARGEST), (-1e9, SMALLEST), (-1e9, SMALLEST)):
        said = [hand.obey(Request(Command.SCALE_MODEL, notches), None) for _ in range(5)]
        assert hand.placement.scale == limit
        assert "from 10 % to 500 %" in said[-1]


def test_the_model_turns_and_a_full_turn_is_none():
    hand = Hand()
    hand.obey(Request(Command.TURN_MODEL, 1), None)
    assert hand.placement.turn_rad == pytest.approx(TURN_STEP_RAD)
    hand.obey(Request(Command.TURN_MODEL, math.tau / TURN_STEP_RAD), None)
    assert hand.placement.turn_rad == pytest.approx(TURN_STEP_RAD)


def test_reset_gives_everything_back():
    tracked, hand = seen_from(EYES[0]), Hand()
    for request in (
        Request(Command.MOVE_LIGHT, (1, 1)),
        Request(Command.MOVE_MODEL, (1, 1)),
        Request(Command.SCALE_MODEL, 2),
        Request(Command.TURN_MODEL, 2),
    ):
        hand.obey(request, sight(tracked))
    hand.reset()
    assert (hand.light, hand.placement) == (None, UNMOVED)


def ratio(hand: Hand) -> np.ndarray:
    return hand.light.light.shadow_rgb_ratio


@pytest.mark.parametrize("estimated", [ESTIMATED, Illumination()], ids=["estimated", "none"])
def test_the_light_by_hand_becomes_stronger_softer_and_warmer(estimated):
    """Its shadow is darker; its disc larger; and it takes more red than blue away. And back again."""
    tracked = seen_from(EYES[0])
    for command in (Command.LIGHT_STRENGTH, Command.LIGHT_SOFTNESS, Command.LIGHT_COLOUR):
        hand = Hand()
        hand.obey(Request(Command.MOVE_LIGHT, (0, 0)), sight(tracked, estimated))
        hand.obey(Request(command, 0), sight(tracked, estimated))
        direction, size, before = hand.light.light.to_light_marker, hand.light.light.angular_size_rad, ratio(hand)
        said = hand.obey(Request(command, 1), sight(tracked, estimated))
        np.testing.assert_array_equal(hand.light.light.to_light_marker, direction)
        darker = before - ratio(hand)
        if command is Command.LIGHT_STRENGTH:
            assert (darker > 0).all()
        elif command is Command.LIGHT_SOFTNESS:
            assert hand.light.light.angular_size_rad > size
        else:
            assert darker[0] > 0 > darker[2]
        # What is said is what the key changes.
        assert ("wide" in said, "red" in said) == (
            command is Command.LIGHT_SOFTNESS,
            command is Command.LIGHT_COLOUR,
        )
        hand.obey(Request(command, -1), sight(tracked, estimated))
        np.testing.assert_allclose(ratio(hand), before, atol=1e-9)
        assert hand.light.light.angular_size_rad == pytest.approx(size)


def test_each_press_softens_by_the_same_factor_and_the_other_key_goes_back():
    hand, tracked, sizes = Hand(), seen_from(EYES[0]), [angular_size(ESTIMATED.light)]
    for notch in (1, 1, -1, -1, -1):
        hand.obey(Request(Command.LIGHT_SOFTNESS, notch), sight(tracked))
        sizes.append(angular_size(hand.light.light))
    steps = np.array((0, 1, 2, 1, 0, -1))
    np.testing.assert_allclose(sizes, sizes[0] * SOFTER_STEP**steps)


def test_a_warmer_light_blocks_more_red_and_as_much_less_blue_and_no_other_green():
    """In how often the light is dimmed in its shadow: its product over red and blue stays."""
    hand = Hand()
    hand.obey(Request(Command.LIGHT_COLOUR, 2), sight(seen_from(EYES[0])))
    red, green, blue = np.log(ratio(hand)) / np.log(ESTIMATED.light.shadow_rgb_ratio)
    assert red > 1.1
    assert (red * blue, green) == pytest.approx((1, 1))


def test_a_light_that_casts_no_shadow_becomes_strong():
    """Its shadow dims nothing: a factor of that alone would be nothing again."""
    hand, tracked = Hand(), seen_from(EYES[0])
    faint = Illumination((Light(ESTIMATED.light.to_light_marker, shadow_rgb_ratio=np.ones(3)),))
    for _ in range(30):
        hand.obey(Request(Command.LIGHT_STRENGTH, 1), sight(tracked, faint))
    assert (ratio(hand) < 0.5).all()


@pytest.mark.parametrize(
    "command", [Command.LIGHT_STRENGTH, Command.LIGHT_SOFTNESS, Command.LIGHT_COLOUR, Command.LIGHT_DISTANCE]
)
def test_a_light_by_hand_states_no_uncertainty(command):
    hand = Hand()
    hand.obey(Request(command, -1), sight(seen_from(EYES[0])))
    light = hand.light.light
    assert light.sigma_rad is light.confidence is light.covariance_rad2 is light.lamp_covariance is None
    assert hand.frame_index == 7, "the frame that was shown"


def test_no_key_makes_a_light_that_cannot_be():
    tracked = seen_from(EYES[0])
    for command in (Command.LIGHT_STRENGTH, Command.LIGHT_SOFTNESS, Command.LIGHT_COLOUR):
        for notch in (1, -1):
            hand = Hand()
            for _ in range(200):
                hand.obey(Request(command, notch), sight(tracked))
            assert (ratio(hand) > 0).all()
            assert (ratio(hand) < 1).all()
            lighting = lighting_of(hand.light.lights, hand.light.ambient_rgb_ratio)
            assert np.isfinite(lighting.irradiances).all()
            assert (np.array(lighting.sky) >= 0).all()


def test_a_light_by_hand_comes_nearer_and_goes_away_again():
    """By the same factor each notch, as large as it is; farther than the farthest lamp it is the sun that it was."""
    tracked, hand = seen_from(EYES[0]), Hand()
    said = hand.obey(Request(Command.LIGHT_DISTANCE, -1), sight(tracked))
    first = hand.light.light
    assert np.linalg.norm(first.position_marker_m) == pytest.approx(FARTHEST_LAMP_SIDES * SIDE_M)
    assert "320 cm" in said
    assert angular_size(first) == pytest.approx(ESTIMATED.light.angular_size_rad)
    np.testing.assert_array_equal(first.to_light_marker, ESTIMATED.light.to_light_marker)
    hand.obey(Request(Command.LIGHT_DISTANCE, -2.5), sight(tracked))
    nearer = hand.light.light
    assert nearer.inverse_distance == pytest.approx(first.inverse_distance * FARTHER_STEP**2.5)
    assert nearer.radius_m == pytest.approx(first.radius_m)
    assert nearer.lamp_covariance is nearer.covariance_rad2 is nearer.confidence is None
    hand.obey(Request(Command.LIGHT_DISTANCE, 1), sight(tracked))
    assert hand.light.light.inverse_distance == pytest.approx(nearer.inverse_distance / FARTHER_STEP)
    for _ in range(3):
        said = hand.obey(Request(Command.LIGHT_DISTANCE, 1), sight(tracked))
    assert hand.light.light.kind == "directional"
    assert "far away" in said
    assert hand.light.light.angular_size_rad == pytest.approx(ESTIMATED.light.angular_size_rad)
    hand.obey(Request(Command.LIGHT_DISTANCE, -1e9), sight(tracked))
    for _ in range(3):
        hand.obey(Request(Command.LIGHT_DISTANCE, -1e9), sight(tracked))
    assert 1 / hand.light.light.inverse_distance == pytest.approx(NEAREST_LAMP_SIDES * SIDE_M)


def test_of_a_light_whose_shadow_leaves_two_fifths_it_is_said_that_it_gives_three():
    two_fifths = Light(ESTIMATED.light.to_light_marker, shadow_rgb_ratio=np.full(3, 0.4))
    said = Hand().obey(Request(Command.LIGHT_STRENGTH, 0), sight(seen_from(EYES[0]), Illumination((two_fifths,))))
    assert "light: 60 % " in said


def test_a_wide_light_that_comes_near_is_as_wide_as_the_softest_at_most():
    tracked, hand = seen_from(EYES[0]), Hand()
    for command, notches in ((Command.LIGHT_SOFTNESS, 100), (Command.LIGHT_DISTANCE, -1), (Command.LIGHT_DISTANCE, -9)):
        hand.obey(Request(command, notches), sight(tracked))
        assert angular_size(hand.light.light) == pytest.approx(SOFTEST_RAD)


def test_a_snapshot_knows_where_the_lamp_by_hand_is():
    tracked, hand = seen_from(EYES[0]), Hand()
    hand.obey(Request(Command.LIGHT_DISTANCE, -1), sight(tracked))
    for _ in range(10):
        hand.obey(Request(Command.LIGHT_DISTANCE, -1), sight(tracked))
    written = light_by_hand_json(hand.light, hand.frame_index)["light"]
    light = hand.light.light
    assert written["kind"] == "lamp"
    np.testing.assert_allclose(written["position_marker_m"], light.to_light_marker / light.inverse_distance)
    assert written["radius_m"] == light.radius_m


def test_a_lamps_softness_is_its_radius():
    tracked, hand = seen_from(EYES[0]), Hand()
    hand.obey(Request(Command.LIGHT_SOFTNESS, 1), sight(tracked, NEAR))
    assert hand.light.light.radius_m > NEAR.light.radius_m
    assert hand.light.light.inverse_distance == NEAR.light.inverse_distance


@pytest.mark.parametrize("command", [Command.LIGHT_SOFTNESS, Command.LIGHT_DISTANCE])
def test_a_lamp_is_written_as_large_as_it_is_drawn(command: Command) -> None:
    hand, tracked = Hand(), seen_from((0.3, -0.4, 0.5))
    hand.obey(Request(command, 2), sight(tracked, NEAR))
    assert hand.light is not None
    written = light_by_hand_json(hand.light, 0)["lights"][0]["angular_size_deg"]
    assert written == pytest.approx(math.degrees(angular_size(hand.light.light)))


def test_a_lamp_is_not_dragged_to_where_it_would_be_below_the_models_top():
    estimated = replace(NEAR, lights=(replace(NEAR.lights[0], inverse_distance=1 / (1.5 * HEIGHT_M)),))
    tracked, hand = seen_from(EYES[1]), Hand()
    for step in np.linspace(0, 200, 21):
        drawn = Drag((320.0, 240.0), (320.0 - step, 240.0 + step), step == 0)
        hand.obey(Request(Command.MOVE_LIGHT, drawn), sight(tracked, estimated))
        light = estimated.light if hand.light is None else hand.light.light
        assert np.isfinite(light.homogeneous).all()
        if hand.light is not None:
            assert light.position_marker_m[2] > HEIGHT_M
