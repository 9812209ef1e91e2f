"""Penumbrae as wide as the light's angular size makes them, several lights, and edges that stand still."""

import math

import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import direction_from_angles, light_view, project
from ashe_live.models.primitives import box, revolved
from ashe_live.quality import QUALITIES
from ashe_live.render.lights.lighting import SUN_ANGULAR_SIZE_RAD, lighting_of
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

HEIGHT = 0.06
DARK = 0.2


def _light(azimuth_deg: float, elevation_deg: float, size_deg: float | None, ratio: float = DARK) -> Light:
    return Light(
        direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg)),
        angular_size_rad=None if size_deg is None else math.radians(size_deg),
        shadow_rgb_ratio=np.full(3, ratio),
    )


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("size_deg", [4.0, 12.0])
def test_penumbra_is_as_wide_as_the_light_looks(make_renderer, stage, quality: str, size_deg: float) -> None:
    """A plate in the air, whose edge at x = 0.05 leaves a penumbra of half its height times the angle to each side."""
    plate = box((0.1, 0.1, 0.002)).moved(1.0, np.array([0.0, 0.0, HEIGHT - 0.002]))
    tracked = stage.tracked(255, stage.pose(0, 25, 0.35, target=(0.05, 0, 0)))
    renderer = make_renderer(QUALITIES[quality].render)
    # From 45 degrees the edge's shadow lies HEIGHT further on, and the penumbra is wider by 1 / sin, twice.
    renderer.render(Scene(tracked, stage.placed(plate), Illumination((_light(180, 45, size_deg),))))
    edge, half = 0.05 + HEIGHT, HEIGHT * math.tan(math.radians(size_deg / 2)) * 2
    xs = edge + half * np.linspace(-1.6, 1.6, 33)
    lit = (stage.along(renderer.read_bgr(), tracked, xs) - DARK) / (1 - DARK)
    assert lit[0] < 0.03
    assert lit[-1] > 0.97
    # How high the edge stands over the sun's centre, in radii; then what a straight edge leaves free of a disc.
    over = np.radians(45) - np.arctan2(HEIGHT, xs - 0.05)
    t = np.clip(over / math.radians(size_deg / 2), -1, 1)
    expected = 0.5 + (t * np.sqrt(1 - t**2) + np.arcsin(t)) / np.pi
    assert np.abs(lit - expected).mean() < 0.03


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_a_stems_penumbra_is_wider_than_the_stem(make_renderer, stage, quality: str) -> None:
    """Across its shadow near the top: what a strip leaves free of a disc."""
    width, height, seen_height = 0.004, 0.1, 0.08
    tracked = stage.tracked(255, stage.pose(-90, 70, 0.3, target=(0.09, 0, 0)))
    stem = stage.placed(stage.glowing_green(box((width, width, height))))
    renderer = make_renderer(QUALITIES[quality].render)
    picture = stage.picture(renderer, Scene(tracked, stem, Illumination((_light(180, 40, 8.0, 0.0),))))
    radius = seen_height / math.sin(math.radians(40)) * math.tan(math.radians(4))
    ys = radius * np.linspace(-1.4, 1.4, 57)
    x = seen_height / math.tan(math.radians(40))
    lit = np.array([stage.along(picture, tracked, np.array([x]), y)[0] for y in ys])
    below = [np.clip((ys + side * width / 2) / radius, -1, 1) for side in (1, -1)]
    first, second = (0.5 + (t * np.sqrt(1 - t**2) + np.arcsin(t)) / math.pi for t in below)
    assert np.abs(lit - (1 - (first - second))).mean() < 0.015


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_a_wide_penumbra_has_no_dots(make_renderer, stage, quality: str) -> None:
    """Along a straight edge as much light passes everywhere, however few points of a large light are sampled."""
    plate = box((0.1, 0.1, 0.002)).moved(1.0, np.array([0.0, 0.0, HEIGHT - 0.002]))
    tracked = stage.tracked(255, stage.pose(0, 25, 0.35, target=(0.05, 0, 0)))
    renderer = make_renderer(QUALITIES[quality].render)
    picture = stage.picture(renderer, Scene(tracked, stage.placed(plate), Illumination((_light(180, 45, 20.0),))))
    half = HEIGHT * math.tan(math.radians(10.0)) * 2
    xs, ys = 0.05 + HEIGHT + half * np.linspace(-0.8, 0.8, 21), np.linspace(-0.02, 0.02, 41)
    lit = np.array([stage.along(picture, tracked, xs, y) for y in ys])
    assert lit[:, 0].mean() < 0.5 < 0.8 < lit[:, -1].mean()
    assert lit.std(axis=0).max() < 0.01


def test_light_of_unknown_size_is_as_wide_as_the_sun() -> None:
    assert lighting_of((_light(0, 40, None),)).lights[0].angular_size_rad == SUN_ANGULAR_SIZE_RAD == math.radians(0.53)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_each_light_casts_its_own_shadow(make_renderer, stage, quality: str) -> None:
    """Of four lights each takes its own share away, and where two are blocked, both."""
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(255, stage.pose(-90, 60, 0.6, target=(0, 0, 0)))
    pole = stage.placed(box((0.03, 0.03, 0.06)))
    lights = tuple(_light(90 * turn, 30, 0.5, 1 - share) for turn, share in enumerate((0.1, 0.15, 0.2, 0.25)))
    picture = stage.picture(renderer, Scene(tracked, pole, Illumination(lights)))
    for turn, share in enumerate((0.1, 0.15, 0.2, 0.25)):
        away = -direction_from_angles(math.pi / 2 * turn, 0.0)[:2] * 0.09
        found = stage.along(picture, tracked, np.array([away[0]]), away[1])[0]
        assert found == pytest.approx(1 - share, abs=0.012)
    two = tuple(_light(azimuth_deg, 30, 0.5, 0.7) for azimuth_deg in (176, 184))
    renderer.render(Scene(tracked, pole, Illumination(two)))
    assert stage.along(renderer.read_bgr(), tracked, np.array([0.06]))[0] == pytest.approx(0.4, abs=0.012)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_shadows_edge_stands_still_while_the_camera_turns(make_renderer, stage, quality: str) -> None:
    preset = QUALITIES[quality].render
    renderer = make_renderer(preset)
    pole = stage.placed(box((0.03, 0.03, 0.06)))
    light = _light(180, 35, None)
    xs = np.linspace(0.06, 0.14, 400)
    edges = []
    for azimuth_deg in range(-60, 61, 12):
        tracked = stage.tracked(255, stage.pose(azimuth_deg, 65, 0.3, target=(0.09, 0, 0)))
        picture = stage.picture(renderer, Scene(tracked, pole, Illumination((light,))))
        lit = stage.along(picture, tracked, xs)
        edges.append(float(np.interp((1 + DARK) / 2, lit[100:300], xs[100:300])))
    reach = 0.015 + 0.06 / math.tan(math.radians(35))
    texel = 0.06 / preset.ground_shadow_size / math.sin(math.radians(35))
    assert np.ptp(edges) < max(texel, 0.0002)
    assert np.mean(edges) == pytest.approx(reach, abs=2 * texel)


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("size_deg", [0.5, 8.0])
def test_models_shadow_on_itself_is_as_soft_as_its_light(make_renderer, stage, quality: str, size_deg: float) -> None:
    """A roof over a table top: where its edge's shadow lies on that, light goes over from none to all."""
    top, roof = box((0.2, 0.1, 0.01)), box((0.1, 0.1, 0.004)).moved(1.0, np.array([-0.05, 0.0, HEIGHT + 0.006]))
    tracked = stage.tracked(255, stage.pose(0, 25, 0.35, target=(0.08, 0, 0)))
    renderer = make_renderer(QUALITIES[quality].render)
    renderer.render(Scene(tracked, stage.placed(top, roof), Illumination((_light(180, 60, size_deg),))))
    xs = np.linspace(0.01, 0.08, 141)
    points = np.column_stack([xs, np.zeros(141), np.full(141, 0.01)])
    columns, rows = project(tracked.camera, tracked.marker.T_cam_marker, points).round().astype(int).T
    seen = LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()[rows, columns, 1]]
    dark, bright = np.median(seen[:10]), np.median(seen[-10:])
    share = (seen - dark) / (bright - dark)
    # Half of the disc is hidden where the ray from its middle meets the edge.
    assert xs[np.flatnonzero(share > 0.5)[0]] == pytest.approx(HEIGHT / math.tan(math.radians(60)), abs=0.003)
    width = xs[np.flatnonzero(share > 0.9)[0]] - xs[np.flatnonzero(share > 0.1)[0]]
    # Of a disc's share the 10 and 90 % are 0.69 of its diameter apart, which is the light's angle times the ray.
    expected = 0.69 * math.radians(size_deg) * HEIGHT / math.sin(math.radians(60)) ** 2
    assert width == pytest.approx(expected, abs=0.25 * expected + 0.0012)


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("elevation_deg", [25, 50])
def test_models_shadow_on_itself_ends_where_the_ray_past_its_edge_does(
    make_renderer, stage, quality: str, elevation_deg: float
) -> None:
    """What keeps a surface from shading itself moves no shadow on it by more than a texel across the light."""
    top, roof = box((0.2, 0.1, 0.01)), box((0.1, 0.1, 0.004)).moved(1.0, np.array([-0.05, 0.0, 0.04]))
    edge = 0.034 / math.tan(math.radians(elevation_deg))
    camera = stage.camera((960, 720))
    pose = stage.pose(0, 50, 0.2, target=(edge, 0, 0.01))
    tracked = stage.tracked(np.full((720, 960, 3), 200, np.uint8), pose, camera)
    renderer = make_renderer(QUALITIES[quality].render, camera.size)
    renderer.render(Scene(tracked, stage.placed(top, roof), Illumination((_light(180, elevation_deg, 0.01),))))
    xs = np.linspace(edge - 0.015, edge + 0.015, 301)
    columns, rows = project(camera, pose, np.column_stack([xs, 0 * xs, 0.01 + 0 * xs])).round().astype(int).T
    seen = LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()[rows, columns, 1]]
    is_lit = seen > (np.median(seen[:20]) + np.median(seen[-20:])) / 2
    # Both boxes are within 0.15 m across the light, and a pixel is 0.2 mm.
    texel = 0.15 / QUALITIES[quality].render.shadow_map_size / math.sin(math.radians(elevation_deg))
    assert xs[np.flatnonzero(is_lit)[0]] == pytest.approx(edge, abs=texel + 0.0002)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_where_a_bar_hides_little_of_a_wide_light_no_dots_are_fully_lit(make_renderer, stage, quality: str) -> None:
    """A bar over a table top: few samples of the light meet it, and in some places none."""
    top, bar = box((0.2, 0.1, 0.01)), box((0.006, 0.1, 0.002)).moved(1.0, np.array([-0.03, 0.0, HEIGHT + 0.006]))
    tracked = stage.tracked(255, stage.pose(0, 40, 0.3, target=(0.0, 0, 0)))
    renderer = make_renderer(QUALITIES[quality].render)
    renderer.render(Scene(tracked, stage.placed(top, bar), Illumination((_light(180, 60, 20.0),))))
    xs, ys = np.meshgrid(np.linspace(-0.015, 0.03, 16), np.linspace(-0.02, 0.02, 61), indexing="ij")
    points = np.column_stack([xs.ravel(), ys.ravel(), np.full(xs.size, 0.01)])
    columns, rows = project(tracked.camera, tracked.marker.T_cam_marker, points).round().astype(int).T
    seen = LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()[rows, columns, 1]].reshape(xs.shape)
    brightest = seen.max(axis=1) - np.median(seen, axis=1)
    assert brightest.max() < 0.14 * seen.mean()


@pytest.mark.parametrize(("quality", "size_deg"), in_turns([(8.0,), (15.0,), (15.0,)]))
def test_the_rims_shadow_in_a_bowl_is_as_soft_as_its_light(make_renderer, stage, quality: str, size_deg: float) -> None:
    """A ray from half a hollow ball is lit where it would meet it again above the rim: its own sides block nothing."""
    radius, wall = 0.045, 0.002
    middle = np.array([0.0, 0.0, radius + wall])
    turns = np.linspace(0, math.pi / 2, 49)
    profile = [
        (r * math.sin(turn), radius + wall - r * math.cos(turn)) for r in (radius + wall, radius) for turn in turns
    ]
    outer, inner = [(0, 0), *profile[1:49]], [*profile[:49:-1], (0, wall)]
    tracked = stage.tracked(128, stage.pose(-90, 60, 0.25, target=(0, 0, 0.03)))
    light = _light(150, 40, size_deg, 0.0)
    renderer = make_renderer(QUALITIES[quality].render)
    renderer.render(
        Scene(tracked, stage.placed(revolved([*outer, *inner], 128, (0.5, 0.5, 0.5, 1.0))), Illumination((light,)))
    )

    tilts, around = np.meshgrid(np.linspace(0.1, 1.45, 50), np.linspace(0, math.tau, 200))
    outwards = np.stack([np.sin(tilts) * np.cos(around), np.sin(tilts) * np.sin(around), -np.cos(tilts)], -1).reshape(
        -1, 3
    )
    to_eye = np.linalg.inv(tracked.marker.T_cam_marker)[:3, 3] - middle - radius * outwards
    cosine = -(outwards @ light.to_light_marker)
    is_seen = _leaves_past(outwards, to_eye[:, None] / np.linalg.norm(to_eye, axis=1)[:, None, None])[:, 0] > 0.05
    outwards, cosine = outwards[is_seen & (cosine > 0.25)], cosine[is_seen & (cosine > 0.25)]
    columns, rows = (
        project(tracked.camera, tracked.marker.T_cam_marker, middle + radius * outwards).round().astype(int).T
    )
    seen = LINEAR_FROM_SRGB_8BIT[renderer.read_bgr()[rows, columns, 1]]
    towards = _points_of_disc(light.to_light_marker, math.radians(size_deg / 2), 200)
    expected = (_leaves_past(outwards, towards[None]) > 0).mean(axis=1)
    # What arrives is proportional to cosine and share; the light that is thrown between the bowl's sides comes on top.
    of_light = np.column_stack([np.ones(len(seen)), cosine * expected])
    thrown, whole = np.linalg.lstsq(of_light, seen, rcond=None)[0]
    found = (seen - thrown) / (whole * cosine)
    assert 0.2 < expected.mean() < 0.8
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.035


def _leaves_past(outwards: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(n, m) heights above its rim, in radii, at which rays from points (n, 3) of half a ball meet the ball again."""
    along = -2 * (outwards[:, None] * directions).sum(axis=2)
    return outwards[:, None, 2] + along * directions[..., 2]


def _points_of_disc(direction: np.ndarray, radius: float, count: int) -> np.ndarray:
    """(count, 3) unit vectors, spread evenly over a disc around a direction."""
    across, along = light_view(direction)[:2, :3]
    numbers = np.arange(count) + 0.5
    aside, turns = np.sqrt(numbers / count) * math.tan(radius), numbers * math.pi * (3 - math.sqrt(5))
    points = direction + np.outer(aside * np.cos(turns), across) + np.outer(aside * np.sin(turns), along)
    return points / np.linalg.norm(points, axis=1, keepdims=True)
