"""The shadow catcher: how dark, where, and that it touches nothing else."""

import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.transforms import raycast_to_plane
from ashe_live.models.primitives import box, revolved
from ashe_live.quality import QUALITIES
from ashe_live.render.lights.lighting import ASSUMED_SHADOW_RATIO
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

POLE_HEIGHT = 0.06
GREY = (0.3, 0.3, 0.3, 1.0)


def _pole(stage):
    return stage.placed(box((0.02, 0.02, POLE_HEIGHT)))


@pytest.mark.parametrize(("quality", "grey"), in_turns((grey,) for grey in (60, 128, 200, 255)))
def test_shadow_multiplies_the_video_by_the_ratio_in_linear_light(
    make_renderer, stage, quality: str, grey: int
) -> None:
    ratio_rgb = np.array((0.25, 0.4, 0.55))
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(grey, stage.pose(-90, 50, 0.5))
    # At 25 degrees the shadow is 0.129 long, and well beyond the contact zone at 0.09.
    renderer.render(Scene(tracked, _pole(stage), Illumination((stage.light(180, 25, tuple(ratio_rgb)),))))
    shadowed = stage.rgb_at(renderer.read_bgr(), tracked, (0.09, 0, 0))
    expected = LINEAR_FROM_SRGB_8BIT[grey] * ratio_rgb
    # As near as eight bits can tell.
    np.testing.assert_allclose(shadowed, srgb_from_linear(expected) * 255, atol=0.51)
    if grey == 255:
        np.testing.assert_allclose(LINEAR_FROM_SRGB_8BIT[shadowed], expected, rtol=0.01)


def test_unmeasured_ratio_is_the_documented_one(make_renderer, stage) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(255, stage.pose(-90, 50, 0.5))
    renderer.render(Scene(tracked, _pole(stage), Illumination((stage.light(180, 25),))))
    shadowed = stage.rgb_at(renderer.read_bgr(), tracked, (0.09, 0, 0))
    np.testing.assert_allclose(LINEAR_FROM_SRGB_8BIT[shadowed], ASSUMED_SHADOW_RATIO, rtol=0.01)


def _ground_beyond(tracked, half_width: float) -> np.ndarray:
    """(h, w) True where the ground that a pixel shows is farther than `half_width` from the origin in x or y."""
    rows, columns = np.mgrid[0:360, 0:480]
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    ground = raycast_to_plane(tracked.camera, tracked.marker.T_cam_marker, pixels)[:, :2]
    return (np.abs(ground).max(axis=1) > half_width).reshape(360, 480)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_without_a_light_only_the_contact_zone_is_darkened(make_renderer, stage, quality: str) -> None:
    image = stage.noise()
    tracked = stage.tracked(image, stage.pose(-70, 60, 0.4))
    picture = stage.picture(make_renderer(QUALITIES[quality].render), Scene(tracked, _pole(stage)))
    # The pole seen from 60 degrees hides ground up to 0.035 behind its foot, the contact zone ends at 0.07.
    far = _ground_beyond(tracked, 0.071)
    assert far.mean() > 0.3
    np.testing.assert_array_equal(picture[far], image[far])


def test_contact_darkening_has_no_direction(make_renderer, stage) -> None:
    """Nothing that could be taken for a sun: a round model darkens the ground alike on all sides."""
    round_model = stage.placed(revolved([(0, 0), (0.02, 0), (0.02, 0.05), (0, 0.05)], 48, GREY))
    tracked = stage.tracked(255, stage.pose(-90, 89, 0.4, target=(0, 0, 0)))
    picture = stage.picture(make_renderer(), Scene(tracked, round_model))
    angles = np.radians(np.arange(0, 360, 15))
    near, beyond = (
        np.array([stage.rgb_at(picture, tracked, (r * np.cos(a), r * np.sin(a), 0))[0] for a in angles])
        for r in (0.026, 0.1)
    )
    assert near.max() < 245
    assert near.max() - near.min() < 16
    assert (beyond == 255).all()


def _hidden_by_a_box(side: float, away: float) -> float:
    """Of the sky, beside the middle of a cube's wall: by rays to the sky, as many as their cosines."""
    place = np.array([0.0, -(0.5 + away) * side, 0.0])
    rng = np.random.default_rng(2)
    turn, share = 2 * np.pi * rng.random(20_000), rng.random(20_000)
    rays = np.column_stack([np.sqrt(share) * np.cos(turn), np.sqrt(share) * np.sin(turn), np.sqrt(1 - share)])
    ends = np.array([(-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)]) * side
    to_sides = np.sort((ends[:, None] - place) / rays, axis=0)
    return float((to_sides[1].min(axis=1) > np.maximum(to_sides[0].max(axis=1), 0)).mean())


@pytest.mark.parametrize(
    ("away", "is_shadowed"), [(0.15, False), (0.25, False), (0.35, False), (0.5, True), (0.7, True)]
)
def test_contact_is_what_the_model_hides_of_the_sky(make_renderer, stage, away: float, is_shadowed: bool) -> None:
    """Beside a black box: under the sky alone, and farther away in a shadow, where the sky is all there is."""
    side, sky = 0.05, 0.4
    tracked = stage.tracked(200, stage.pose(-90, 70, 0.35, target=(0, 0, 0)))
    renderer = make_renderer()
    lights = (stage.light(90, 30, (sky, sky, sky)),) if is_shadowed else ()
    renderer.render(Scene(tracked, stage.placed(box((side, side, side), (0.0, 0.0, 0.0, 1.0))), Illumination(lights)))
    place = (0.0, -(0.5 + away) * side, 0.0)
    seen = LINEAR_FROM_SRGB_8BIT[stage.rgb_at(renderer.read_bgr(), tracked, place)[2]]
    left = sky if is_shadowed else 1.0
    hidden = 1 - seen / (left * LINEAR_FROM_SRGB_8BIT[200])
    assert hidden == pytest.approx(_hidden_by_a_box(side, away), abs=0.02 if is_shadowed else 0.03)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_video_away_from_model_and_shadow_is_untouched(make_renderer, stage, quality: str) -> None:
    renderer = make_renderer(QUALITIES[quality].render)
    image = stage.noise()
    tracked = stage.tracked(image, stage.pose(-90, 60, 0.5))
    renderer.render(Scene(tracked, _pole(stage), Illumination((stage.light(180, 45, (0.3, 0.3, 0.3)),))))
    picture = renderer.read_bgr()
    changed = (picture != image).any(axis=2)
    assert changed.sum() > 500
    far = _ground_beyond(tracked, 0.09)
    assert far.mean() > 0.3
    assert not changed[far].any()


def test_ground_is_not_darkened_seen_from_below(make_renderer, stage) -> None:
    image = stage.noise()
    tracked = stage.tracked(image, stage.pose(-90, -40, 0.4))
    picture = stage.picture(make_renderer(), Scene(tracked, _pole(stage), Illumination((stage.light(180, 30),))))
    shadow_only = stage.rgb_at(picture, tracked, (0.06, 0, 0))
    np.testing.assert_array_equal(shadow_only, stage.rgb_at(image, tracked, (0.06, 0, 0)))
    assert (picture != image).any()  # the model is there


@pytest.mark.parametrize(
    ("light_elevation_deg", "scale"),
    [
        *((elevation_deg, 0.08) for elevation_deg in (90.0, 89.999, 5.0, 0.5, 0.01, 0.0, -10.0, -90.0)),
        *((elevation_deg, scale) for elevation_deg in (5.0, 0.01) for scale in (0.001, 10.0)),
    ],
)
def test_extreme_lights_and_sizes_are_drawn(make_renderer, stage, light_elevation_deg: float, scale: float) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(220, stage.pose(-90, 40, 3 * scale, target=(0, 0, 0.4 * scale)))
    model = stage.placed(box((0.8 * scale, 0.8 * scale, scale), (0.0, 1.0, 0.0, 1.0)))
    renderer.render(Scene(tracked, model, Illumination((stage.light(200, light_elevation_deg),)), shows_light=True))
    picture = renderer.read_bgr().astype(int)
    is_model = picture[..., 1] > picture[..., 2] + 10
    assert is_model.mean() > 0.05
    if light_elevation_deg <= 0:
        # No shadow is cast: the ground beside the contact zone is as it was.
        beside = stage.rgb_at(picture, tracked, (1.4 * scale, 0.2 * scale, 0))
        np.testing.assert_array_equal(beside, (220, 220, 220))


def test_flat_model_is_seen_above_its_ground(make_renderer, stage) -> None:
    renderer = make_renderer()
    sheet = stage.placed(box((0.06, 0.06, 0.0), (0.0, 1.0, 0.0, 1.0)))
    tracked = stage.tracked(200, stage.pose(-90, 40))
    renderer.render(Scene(tracked, sheet, Illumination((stage.light(180, 40),))))
    red, green, blue = stage.rgb_at(renderer.read_bgr(), tracked, (0.01, 0.01, 0))
    assert green > red + 50
    assert green > blue + 50


def _lit_beside(make_renderer, stage, colour: tuple[float, ...], azimuth_deg: float) -> np.ndarray:
    """(3,) linear RGB of ground 2 cm before a wall's +x side, over what it is without the wall."""
    renderer = make_renderer()
    tracked = stage.tracked(128, stage.pose(0, 55, 0.5))
    wall = stage.placed(box((0.02, 0.2, 0.1), colour))
    renderer.render(Scene(tracked, wall, Illumination((stage.light(azimuth_deg, 30, (0.25, 0.25, 0.25)),))))
    seen = stage.rgb_at(renderer.read_bgr(), tracked, (0.03, 0, 0))
    return LINEAR_FROM_SRGB_8BIT[seen] / LINEAR_FROM_SRGB_8BIT[128]


def test_a_sunlit_wall_lights_the_ground_before_it_in_its_own_colour(make_renderer, stage) -> None:
    """By Lambert: a wall that fills the fraction F of the sky adds F times its radiance to what is left of the sky."""
    black = _lit_beside(make_renderer, stage, (0.0, 0.0, 0.0, 1.0), 0)
    orange = _lit_beside(make_renderer, stage, (0.8, 0.4, 0.0, 1.0), 0)
    assert (black < 0.97).all()  # of a sky that gives a quarter of the light, a third or so is hidden
    assert orange[0] > 1.1
    np.testing.assert_allclose((orange - black)[:2], (orange - black)[0] * np.array((1.0, 0.5)), rtol=0.08)
    assert orange[2] == pytest.approx(black[2], abs=0.01)
    hidden = (1 - black[0]) / 0.25
    # The sun of 30 degrees gives level ground 0.75, a wall across from it cot(30 degrees) times that; the sky half of
    # its 0.25, and the ground, whose albedo is taken to be 0.35, half of its own.
    radiance = 0.8 * (0.75 / np.tan(np.radians(30)) + 0.125 + 0.35 / 2)
    assert (orange - black)[0] == pytest.approx(hidden * radiance, rel=0.25)


def test_a_wall_in_its_own_shade_lights_nothing_much(make_renderer, stage) -> None:
    black, white = (_lit_beside(make_renderer, stage, (grey, grey, grey, 1.0), 180) for grey in (0.0, 1.0))
    # What is behind the wall lies in its shadow: of the sky's quarter only.
    assert (white < 0.25).all()
    assert (white >= black).all()


def test_the_foot_of_a_wall_over_its_own_shadow_is_darker_than_over_lit_ground(make_renderer, stage) -> None:
    """The light from below is that of the ground there: the same shaded wall, its shadow before it or beside it."""
    feet = []
    for azimuth_deg in (180, 90):  # from behind; along the wall, which so gets none either
        renderer = make_renderer()
        tracked = stage.tracked(200, stage.pose(0, 40, 0.5))
        light = stage.light(azimuth_deg, 40, (0.25, 0.25, 0.25))
        bright = Illumination((light,), ground_rgb=np.full(3, 0.5), seen_in=tracked)
        renderer.render(Scene(tracked, stage.placed(box((0.02, 0.2, 0.1))), bright))
        feet.append(LINEAR_FROM_SRGB_8BIT[stage.rgb_at(renderer.read_bgr(), tracked, (0.01, 0, 0.008))[2]])
    assert feet[0] < 0.8 * feet[1]


def test_ground_in_the_lee_of_the_brighter_sky_is_darker(make_renderer, stage) -> None:
    """A sky that leans by k times a direction's x: what a wall's foot loses by it is three slopes of the wall's own."""
    tracked = stage.tracked(200, stage.pose(-90, 70, 0.5))
    wall = stage.placed(stage.glowing_green(box((0.01, 0.3, 0.15))))
    renderer = make_renderer()
    away = 0.05
    lit = []
    for slope in (0.0, 0.15):
        leaning = np.array([np.full(3, slope), np.zeros(3)])
        renderer.render(Scene(tracked, wall, Illumination((), sky_slope_rgb=leaning)))
        lit.append(stage.along(renderer.read_bgr(), tracked, np.array([-away, away])) / LINEAR_FROM_SRGB_8BIT[200])
    (even_west, even_east), (west, east) = lit
    assert even_west == pytest.approx(even_east, abs=0.01)
    # Over pi, cosines times k x of all directions below that to the wall's top: 2 k / (3 pi) times the sine's cube.
    top = np.arctan2(0.15, away)
    change = 3 * 0.15 * 2 / (3 * np.pi) * np.sin(top) ** 3
    assert even_west - west == pytest.approx(change, rel=0.2)
    assert east - even_east == pytest.approx(change, rel=0.2)
