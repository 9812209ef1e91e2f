"""Real and virtual share the light: what hides, shades and is shaded by what."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy, ProxyMesh
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.light.hull.surface import surface_of
from ashe_live.models.material import WHITE, LinearRGBA
from ashe_live.models.placement import Placement
from ashe_live.models.primitives import box
from ashe_live.quality import FAST, QUALITIES
from ashe_live.render.camera.white import ASSUMED_WHITE
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.scene import Scene

RATIO = (0.3, 0.4, 0.5)
GREY = 180
BLACK = (0.0, 0.0, 0.0, 1.0)
PRESETS = [quality.render for quality in QUALITIES.values()]
IDS = list(QUALITIES)


def _proxy_box(x: float, y: float, half: float, height: float) -> Proxy:
    corners = [(x + a, y + b, z, 0.0, 0.0) for a in (-half, half) for b in (-half, half) for z in (0.0, height)]
    return Proxy("box", np.array(corners))


def _video_of_object(stage, renderer, light: Light, colour: LinearRGBA = WHITE) -> TrackedFrame:
    """Of a box whose shadow begins at y = 0.04."""
    pose = stage.pose(-90, 60, 0.5)
    double = stage.placed(box((0.04, 0.04, 0.08), colour).moved(1.0, np.array([0.0, 0.06, 0.0])))
    scene = Scene(stage.tracked(GREY, pose), double, Illumination((light,)))
    return stage.tracked(stage.picture(renderer, scene), pose)


def _over_shadow(stage, picture: np.ndarray, tracked: TrackedFrame, ys: Float, ratio: tuple[float, ...]) -> Float:
    """(n, 3) the light that is left on the ground along a line across the shadow's border, over that in a shadow."""
    seen = [stage.rgb_at(picture, tracked, (0.08, y, 0.0)) for y in ys]
    return LINEAR_FROM_SRGB_8BIT[seen] / LINEAR_FROM_SRGB_8BIT[GREY] / ratio


def _volume(points: np.ndarray, triangles: np.ndarray) -> float:
    """By the divergence theorem; positive for a closed surface whose triangles face outwards."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_surface_of_a_box_is_the_box_and_that_of_a_ball_nearly_the_ball() -> None:
    assert _volume(*_proxy_box(0.1, -0.2, 0.03, 0.08).surface()) == pytest.approx(0.06**2 * 0.08, rel=1e-9)
    ball = Proxy("ball", np.array([(0.1, 0.0, 0.05, 0.05, 0.05)]))
    assert _volume(*ball.surface()) == pytest.approx(4 / 3 * np.pi * 0.05**3, rel=0.02)
    cup = Proxy("cup", np.array([(0, 0, 0, 0.03, 0), (0, 0, 0.1, 0.04, 0)]))
    cone = np.pi * 0.1 / 3 * (0.03**2 + 0.03 * 0.04 + 0.04**2)
    assert _volume(*cup.surface()) == pytest.approx(cone, rel=0.02)


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_model_behind_the_object_is_hidden_by_it(make_renderer, stage, preset) -> None:
    renderer = make_renderer(preset)
    tracked = stage.tracked(GREY, stage.pose(-90, 25, 0.5))
    model = stage.placed(box((0.05, 0.03, 0.05), (0.0, 1.0, 0.0, 1.0)))
    in_front = _proxy_box(0.0, -0.08, 0.02, 0.06)
    behind = _proxy_box(0.0, 0.08, 0.02, 0.02)
    point = (0.0, -0.015, 0.02)  # on the front of the model
    for caster, seen in ((in_front, GREY), (behind, None)):
        renderer.render(Scene(tracked, model, Illumination(real_object=caster)))
        red, green, blue = stage.rgb_at(renderer.read_bgr(), tracked, point)
        assert (red, green, blue) == (seen,) * 3 if seen else green > red + 30


def test_model_behind_a_hull_is_hidden_by_it_and_seen_past_it(make_renderer, stage) -> None:
    tracked = stage.tracked(GREY, stage.pose(-90, 25, 0.5))
    model = stage.placed(box((0.05, 0.03, 0.05), (0.0, 1.0, 0.0, 1.0)))
    # An L, as voxels: its low part does not hide what the convex hull of both would.
    occupied = np.zeros((20, 8, 24), np.bool_)
    occupied[:10], occupied[:, :, :4] = True, True
    points, triangles = surface_of(occupied, np.array([-0.025, -0.1, 0.0]), 0.0025)
    assert _volume(points, triangles) == pytest.approx(occupied.sum() * 0.0025**3, rel=0.1)
    corners = np.column_stack([points, np.zeros((len(points), 2))])
    hull = Proxy("silhouettes", corners, ProxyMesh(points, triangles))
    picture = stage.picture(make_renderer(PRESETS[0]), Scene(tracked, model, Illumination(real_object=hull)))
    hidden, seen = (stage.rgb_at(picture, tracked, (x, -0.015, 0.02)) for x in (-0.015, 0.018))
    assert hidden.tolist() == [GREY] * 3
    assert seen[1] > seen[0] + 30


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_object_shades_the_model(make_renderer, stage, preset) -> None:
    renderer = make_renderer(preset)
    tracked = stage.tracked(GREY, stage.pose(-90, 60, 0.4))
    model = stage.placed(box((0.08, 0.04, 0.01)))
    light = stage.light(180, 45, RATIO)  # the tall object at x = -0.1 throws its shadow up to x = 0.02
    brightness = []
    for caster in (None, _proxy_box(-0.1, 0.0, 0.02, 0.1)):
        picture = stage.picture(renderer, Scene(tracked, model, Illumination((light,), real_object=caster)))
        seen = [stage.rgb_at(picture, tracked, (x, 0.0, 0.01)) for x in (-0.02, 0.03)]
        brightness.append(LINEAR_FROM_SRGB_8BIT[seen])
    np.testing.assert_allclose(brightness[0][0], ASSUMED_WHITE, rtol=0.02)
    np.testing.assert_allclose(brightness[1][0], ASSUMED_WHITE * np.array(RATIO), rtol=0.03)
    np.testing.assert_allclose(brightness[1][1], ASSUMED_WHITE, rtol=0.02)


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_models_shadow_falls_on_the_object(make_renderer, stage, preset) -> None:
    """Darker by what is left of the light on the side that it lights, and untouched above the shadow."""
    renderer = make_renderer(preset)
    tracked = stage.tracked(GREY, stage.pose(125, 30, 0.5, target=(0.05, 0, 0.03)))
    light = stage.light(180, 30, RATIO)
    object_ = _proxy_box(0.1, 0.0, 0.03, 0.12)  # its lit side is at x = 0.07, where the shadow is 0.045 high
    renderer.render(Scene(tracked, stage.placed(box((0.02, 0.05, 0.08))), Illumination((light,), real_object=object_)))
    picture = renderer.read_bgr()
    lighting = lighting_of((light,))
    sky, bounce = np.array(lighting.sky) / 2, np.array(lighting.bounce) / 2
    sun = np.array(lighting.lights[0].irradiance) * np.cos(np.radians(30))
    # A third of the ground's light comes from beyond 2.8 times the height: from beyond the model and its shadow.
    left = (1 + 2 * np.array(RATIO)) / 3
    shaded = LINEAR_FROM_SRGB_8BIT[stage.rgb_at(picture, tracked, (0.07, 0.01, 0.03))] / LINEAR_FROM_SRGB_8BIT[GREY]
    np.testing.assert_allclose(shaded, (sky + left * bounce) / (sky + bounce + sun), rtol=0.04)
    np.testing.assert_array_equal(stage.rgb_at(picture, tracked, (0.07, 0.0, 0.12)), GREY)


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_a_round_object_is_shaded_by_its_own_normals_and_by_the_ground_that_is_shaded_too(
    make_renderer, stage, preset
) -> None:
    """A wall takes all of the sun: what is left is the sky, and the light of ground that has none but the sky's."""
    renderer = make_renderer(preset)
    tracked = stage.tracked(GREY, stage.pose(180, 30, 0.5, target=(0.1, 0, 0.03)))
    light = stage.light(180, 30, RATIO)
    cylinder = Proxy("cylinder", np.array([(0.12, 0.0, z, 0.04, 0.0) for z in (0.0, 0.07)]))
    wall = stage.placed(box((0.01, 0.8, 0.4)))
    lit = Illumination((light,), real_object=cylinder)
    scene = Scene(tracked, wall, lit, placement=Placement(shift_m=(-0.25, 0.0)), shows_model=False)
    picture, lighting = stage.picture(renderer, scene), lighting_of((light,))
    sky, bounce = np.array(lighting.sky) / 2, np.array(lighting.bounce) / 2
    for azimuth in np.radians(np.arange(-55.0, 56.0, 2.5)):
        place = 0.12 - 0.04 * np.cos(azimuth), 0.04 * np.sin(azimuth), 0.02
        sun = np.array(lighting.lights[0].irradiance) * np.cos(np.radians(30)) * np.cos(azimuth)
        shaded = LINEAR_FROM_SRGB_8BIT[stage.rgb_at(picture, tracked, place)] / LINEAR_FROM_SRGB_8BIT[GREY]
        np.testing.assert_allclose(shaded, (sky + bounce * RATIO) / (sky + bounce + sun), rtol=0.035)


def test_ground_in_the_objects_own_shadow_gives_it_no_less_light(make_renderer, stage) -> None:
    """On the side that faces away from the sun there is nothing that a model could take, also none of the ground's."""
    tracked = stage.tracked(GREY, stage.pose(0, 30, 0.5, target=(0.1, 0, 0.03)))
    tall = _proxy_box(0.1, 0.0, 0.04, 0.12)
    wall = stage.placed(box((0.01, 0.3, 0.3)))
    lit = Illumination((stage.light(180, 30, RATIO),), real_object=tall)
    scene = Scene(tracked, wall, lit, placement=Placement(shift_m=(-0.1, 0.0)), shows_model=False)
    picture = stage.picture(make_renderer(), scene)
    for height in (0.01, 0.02):
        np.testing.assert_allclose(stage.rgb_at(picture, tracked, (0.14, 0.0, height)), GREY, atol=1)


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_a_model_without_its_shadow_shades_no_object(make_renderer, stage, preset) -> None:
    renderer = make_renderer(preset)
    tracked = stage.tracked(GREY, stage.pose(125, 30, 0.5, target=(0.05, 0, 0.03)))
    lit = Illumination((stage.light(180, 30, RATIO),), real_object=_proxy_box(0.1, 0.0, 0.03, 0.12))
    whole = Scene(tracked, stage.placed(box((0.02, 0.05, 0.08))), lit)
    on_lit_side = (0.07, 0.015, 0.03)
    seen = []
    for scene in (whole, replace(whole, casts_shadow=False)):
        seen.append(stage.rgb_at(stage.picture(renderer, scene), tracked, on_lit_side))
    assert (seen[0] < GREY - 20).all()
    np.testing.assert_array_equal(seen[1], GREY)


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_ground_in_the_objects_shadow_is_not_darkened_again(make_renderer, stage, preset) -> None:
    renderer = make_renderer(preset)
    tracked = stage.tracked(GREY, stage.pose(-90, 60, 0.5))
    light = stage.light(180, 30, RATIO)
    model = stage.placed(box((0.03, 0.06, 0.05)))  # its shadow ends at x = 0.1
    object_ = _proxy_box(0.0, 0.06, 0.02, 0.08)  # its shadow covers y > 0.04
    places = [(0.07, 0.02, 0.0), (0.07, 0.028, 0.0), (0.085, 0.05, 0.0)]
    lone, shared = [], []
    for caster, found in ((None, lone), (object_, shared)):
        renderer.render(Scene(tracked, model, Illumination((light,), real_object=caster)))
        found += [stage.rgb_at(renderer.read_bgr(), tracked, place) for place in places]
    assert (lone[0] < GREY - 30).all()
    np.testing.assert_array_equal(shared[0], lone[0])
    np.testing.assert_array_equal(shared[2], GREY)
    overlap = _proxy_box(0.0, 0.0, 0.015, 0.05)  # the model's double: all of its shadow is there already
    renderer.render(Scene(tracked, model, Illumination((light,), real_object=overlap)))
    np.testing.assert_allclose(stage.rgb_at(renderer.read_bgr(), tracked, (0.07, 0.0, 0.0)), GREY, atol=1)


@pytest.mark.parametrize("off_m", [-0.0015, 0.0015])
@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_where_both_shadows_meet_there_is_no_seam_though_the_objects_outline_is_off(
    make_renderer, stage, preset, off_m: float
) -> None:
    """All along a line across the outline the ground is as dark as in either shadow; no seam of twice or none."""
    renderer = make_renderer(preset)
    light = stage.light(180, 30, RATIO)
    tracked = _video_of_object(stage, renderer, light)
    model = stage.placed(box((0.03, 0.12, 0.05)))  # its shadow crosses that
    lit = LINEAR_FROM_SRGB_8BIT[GREY]
    for ground_rgb in (None, np.full(3, lit)):
        caster = _proxy_box(0.0, 0.06 + off_m, 0.02, 0.08)
        renderer.render(Scene(tracked, model, Illumination((light,), real_object=caster, ground_rgb=ground_rgb)))
        picture = renderer.read_bgr()
        left = _over_shadow(stage, picture, tracked, np.linspace(0.034, 0.046, 25), RATIO)
        if ground_rgb is None:
            assert left.min() < 0.6 or left.max() > 1.5
        else:
            np.testing.assert_allclose(left, 1, atol=0.3)


@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_a_shadow_in_the_video_is_not_darkened_again_where_a_poor_proxy_knows_of_none(
    make_renderer, stage, preset
) -> None:
    """The proxy's shadow begins 4 mm, some pixels, farther in than the one that the video shows."""
    renderer = make_renderer(preset)
    light = stage.light(180, 30, RATIO)
    tracked = _video_of_object(stage, renderer, light)
    lit = LINEAR_FROM_SRGB_8BIT[GREY]
    caster = _proxy_box(0.0, 0.064, 0.02, 0.08)
    model = stage.placed(box((0.03, 0.12, 0.05)))
    renderer.render(Scene(tracked, model, Illumination((light,), real_object=caster, ground_rgb=np.full(3, lit))))
    picture = renderer.read_bgr()
    left = _over_shadow(stage, picture, tracked, np.linspace(0.0405, 0.0435, 7), RATIO)
    np.testing.assert_allclose(left, 1, atol=0.3)


@pytest.mark.parametrize("off_m", [-0.0015, 0.0, 0.003])
def test_no_bright_line_is_left_in_the_border_of_a_dark_soft_shadow(make_renderer, stage, off_m: float) -> None:
    """What little light a border has is the model's to take: half of the sun's is five times as much as the sky's."""
    dark = (0.1, 0.1, 0.1)
    renderer = make_renderer(FAST.render)
    light = stage.light(180, 30, dark)
    sharp = _video_of_object(stage, renderer, light, BLACK)
    soft = cv2.GaussianBlur(LINEAR_FROM_SRGB_8BIT[sharp.frame.image_bgr], (0, 0), 1.3)
    tracked = stage.tracked(np.round(255 * srgb_from_linear(soft)).astype(np.uint8), sharp.pose.T_cam_marker)
    lit = LINEAR_FROM_SRGB_8BIT[GREY]
    caster = _proxy_box(0.0, 0.06 + off_m, 0.02, 0.08)
    model = stage.placed(box((0.03, 0.12, 0.05), BLACK))
    renderer.render(Scene(tracked, model, Illumination((light,), real_object=caster, ground_rgb=np.full(3, lit))))
    picture = renderer.read_bgr()
    left = _over_shadow(stage, picture, tracked, np.linspace(0.034, 0.048, 29), dark)
    assert left.max() < 1.4
    assert left.min() > 0.6


@pytest.mark.parametrize("inverse_distance", [0.0, 2.0])
def test_ground_that_the_object_darkens_at_its_lit_foot_is_not_taken_for_its_shadow(
    make_renderer, stage, inverse_distance: float
) -> None:
    """The object hides the sky there, and none of the light: the model takes as much of that as without the object."""
    renderer = make_renderer(FAST.render)
    pose = stage.pose(-90, 60, 0.5)
    light = replace(stage.light(180, 30, RATIO), inverse_distance=inverse_distance)
    foot = [(0.07, -0.03, 0.0), (0.08, -0.03, 0.0), (0.08, 0.03, 0.0), (0.07, 0.03, 0.0)]
    video = np.full((360, 480, 3), GREY, np.uint8)
    outline = project(stage.camera(), pose, foot)
    cv2.fillConvexPoly(video, np.round(outline).astype(np.int32), (125,) * 3)
    tracked = stage.tracked(video, pose)
    model = stage.placed(box((0.03, 0.06, 0.05)))  # its shadow reaches the object's lit side, which is at x = 0.08
    lit = np.full(3, LINEAR_FROM_SRGB_8BIT[GREY])
    strip = [(x, 0.0, 0.0) for x in np.linspace(0.073, 0.078, 6)]
    left = []
    for caster in (None, _proxy_box(0.1, 0.0, 0.02, 0.06)):
        renderer.render(Scene(tracked, model, Illumination((light,), real_object=caster, ground_rgb=lit)))
        picture = renderer.read_bgr()
        left.append(LINEAR_FROM_SRGB_8BIT[[stage.rgb_at(picture, tracked, place) for place in strip]])
    assert np.array(left[0]).max() < 0.7 * LINEAR_FROM_SRGB_8BIT[125]
    np.testing.assert_allclose(left[1], left[0], rtol=0.05)


def test_a_joint_of_the_ground_goes_on_where_both_shadows_meet(make_renderer, stage) -> None:
    """It is as dark as a shadow on its pale ground, but has pale ground on either side."""
    renderer = make_renderer(FAST.render)
    light = stage.light(180, 30, RATIO)
    pose = stage.pose(-90, 60, 0.5)
    video = np.full((360, 480, 3), GREY, np.uint8)
    ends = [(0.08, 0.06, 0.0), (0.08, 0.0, 0.0)]
    (column, first), (_, last) = np.round(project(stage.camera(), pose, ends)).astype(int)
    video[first:last, column : column + 2] = 90
    double = stage.placed(box((0.04, 0.04, 0.08)).moved(1.0, np.array([0.0, 0.06, 0.0])))
    renderer.render(Scene(stage.tracked(video, pose), double, Illumination((light,))))
    tracked = stage.tracked(renderer.read_bgr(), pose)  # a video of an object whose shadow begins at y = 0.04
    model = stage.placed(box((0.03, 0.12, 0.05)))  # its shadow crosses that
    caster = _proxy_box(0.0, 0.06, 0.02, 0.08)
    lit = np.full(3, LINEAR_FROM_SRGB_8BIT[GREY])
    renderer.render(Scene(tracked, model, Illumination((light,), real_object=caster, ground_rgb=lit)))
    picture = renderer.read_bgr()
    places = [(0.08, y, 0.0) for y in np.linspace(0.03, 0.05, 21)]
    rows = np.round(project(stage.camera(), pose, places)[:, 1]).astype(int)
    joint = LINEAR_FROM_SRGB_8BIT[picture[rows, column, ::-1]] / LINEAR_FROM_SRGB_8BIT[90] / RATIO
    np.testing.assert_allclose(joint, 1, atol=0.3)


def test_the_object_ends_a_shadow_behind_it_on_a_smooth_line_also_with_one_sample_a_pixel(make_renderer, stage) -> None:
    """As with several samples: as a staircase these pixels would be off by 0.29 of the step."""
    tracked = stage.tracked(GREY, stage.pose(-80, 35, 0.5))
    model = stage.placed(box((0.03, 0.03, 0.08)))
    cone = Proxy("cone", np.array([(-0.1, -0.03, 0.0, 0.015, 0.0), (-0.1, -0.03, 0.09, 0.03, 0.0)]))
    light = Illumination((stage.light(0, 30, RATIO),), real_object=cone)
    pictures = []
    for samples in (0, 4):
        renderer = make_renderer(replace(FAST.render.with_samples(samples), matches_noise=False, matches_blur=False))
        pictures.append(stage.picture(renderer, Scene(tracked, model, light))[..., 1].astype(float))
    rough, fine = pictures
    sides = project(
        tracked.camera,
        tracked.marker.T_cam_marker,
        [(-0.1 + side * (0.015 + 0.015 * up), -0.03, 0.09 * up) for side in (-1, 1) for up in (0.1, 0.6)],
    )
    near = np.zeros(fine.shape, np.uint8)
    for low, high in (sides[:2], sides[2:]):
        cv2.line(near, np.round(low).astype(int).tolist(), np.round(high).astype(int).tolist(), 1, 5)
    step = GREY - fine[near > 0].min()
    mixed = (near > 0) & (fine > GREY - 0.9 * step) & (fine < GREY - 0.1 * step)
    assert mixed.sum() > 20
    assert np.abs(rough - fine)[mixed].mean() < 0.15 * step


@pytest.mark.parametrize("up_to_outline", [False, True], ids=["within a side", "up to the outline"])
@pytest.mark.parametrize("preset", PRESETS, ids=IDS)
def test_where_a_shadow_on_the_object_ends_pixels_are_as_dark_as_the_part_of_them_in_it(
    make_renderer, stage, preset, up_to_outline: bool
) -> None:
    """As the means of seven times as many pixels a side: a border is no staircase, and no wider than its pixels."""
    times, preset = 7, replace(preset, matches_blur=False, matches_noise=False)
    lit = Illumination((stage.light(180, 30, (0.2, 0.2, 0.2)),), real_object=_proxy_box(0.1, 0.0, 0.03, 0.12))
    # Out of view beside the object, and so near that a bare sun's penumbra is narrower than a pixel.
    plate = box((0.02, 0.1, 0.35)).moved(1.0, np.array([-0.15, 0.0, 0.0])) if up_to_outline else box((0.02, 0.03, 0.12))
    rolled = np.eye(4)
    rolled[:2, :2] = (0.9, -0.436), (0.436, 0.9)  # no border is upright in the picture
    pose = rolled @ stage.pose(140, 20, 0.5, target=(0.07, 0, 0.08))
    shares = []
    for columns, rows in ((160, 120), (160 * times, 120 * times)):
        camera = stage.camera((columns, rows)).from_hfov((columns, rows), 20)
        tracked = stage.tracked(np.full((rows, columns, 3), GREY, np.uint8), pose, camera)
        picture = stage.picture(make_renderer(preset, (columns, rows)), Scene(tracked, stage.placed(plate), lit))
        shares.append(LINEAR_FROM_SRGB_8BIT[picture[..., 1]] / LINEAR_FROM_SRGB_8BIT[GREY])
    found, true = shares[0], shares[1].reshape(120, times, 160, times).mean(axis=(1, 3))
    # The side that is lit, at x = 0.07, but where it meets the ground.
    side = np.array([(0.07, y, z) for y in (-0.03, 0.03) for z in (0.02, 0.12)])
    corners = project(stage.camera((160, 120)).from_hfov((160, 120), 20), pose, side)
    near = np.zeros(found.shape, np.uint8)
    cv2.fillConvexPoly(near, cv2.convexHull(np.round(corners).astype(np.int32)), 1)
    near = cv2.dilate(near, np.ones((3, 3))) if up_to_outline else cv2.erode(near, np.ones((5, 5)))
    darkest, lightest = true[near > 0].min(), true[near > 0].max()
    border = (near > 0) & (true > darkest + 0.02) & (true < lightest - 0.02)
    assert border.sum() > 60
    error = (found - true)[border] / (lightest - darkest)
    assert np.sqrt(np.square(error).mean()) < (0.12 if up_to_outline else 0.07)
