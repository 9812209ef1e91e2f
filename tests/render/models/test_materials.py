"""Each property of a material does to the picture what its definition says."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.transforms import light_view, project
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh
from ashe_live.quality import FAST, QUALITIES
from ashe_live.render.camera.white import ASSUMED_WHITE
from ashe_live.render.lights.lighting import GROUND_ALBEDO, lighting_of
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

HEIGHT_M = 0.01
CORNERS = np.float32(
    [(-0.03, -0.03, HEIGHT_M), (0.03, -0.03, HEIGHT_M), (0.03, 0.03, HEIGHT_M), (-0.03, 0.03, HEIGHT_M)]
)
LIFT = np.array((0.0, 0.0, 0.02))
UVS = np.float32([(0, 0), (1, 0), (1, 1), (0, 1)])
TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)])


def _texels(*rgba: int) -> np.ndarray:
    return np.full((4, 4, 4), rgba, dtype=np.uint8)


def _sheet(material: Material, normal: tuple[float, ...] = (0, 0, 1), **fields) -> Mesh:
    """A level square over the marker's centre."""
    normals = np.tile(np.float32(normal) / np.float32(np.linalg.norm(normal)), (4, 1))
    return Mesh(CORNERS, normals, TRIANGLES, uvs=UVS, material=material, **fields)


def _ball(material: Material, radius_m: float = 0.03) -> Mesh:
    polar, around = np.meshgrid(np.linspace(0, math.pi, 33), np.linspace(0, 2 * math.pi, 65), indexing="ij")
    normals = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], -1)
    row, column = np.mgrid[:32, :64].reshape(2, -1)
    a = row * 65 + column
    triangles = np.concatenate([np.stack([a, a + 65, a + 66], 1), np.stack([a, a + 66, a + 1], 1)])
    normals = normals.reshape(-1, 3).astype(np.float32)
    return Mesh(normals * radius_m + np.float32((0, 0, radius_m)), normals, triangles, material=material)


class _Studio:
    """Renders one mesh on a grey ground and reads single points of it, linear RGB."""

    def __init__(self, make_renderer, stage, quality: str = "fast", grey: int = 100, elevation_deg: float = 60) -> None:
        self.renderer = make_renderer(QUALITIES[quality].render)
        self.tracked = stage.tracked(grey, stage.pose(-90, elevation_deg, 0.25))
        self.stage = stage

    def picture(self, mesh: Mesh, *lights) -> np.ndarray:
        self.renderer.render(Scene(self.tracked, self.stage.placed(mesh), Illumination(lights, seen_in=self.tracked)))
        return self.renderer.read_bgr()[..., ::-1]

    def at(self, picture: np.ndarray, point: tuple[float, ...]) -> np.ndarray:
        column, row = np.round(project(self.tracked.camera, self.tracked.marker.T_cam_marker, [point])[0]).astype(int)
        return linear_from_srgb(picture[row, column] / 255)

    def middle(self, mesh: Mesh, *lights) -> np.ndarray:
        return self.at(self.picture(mesh, *lights), (0.004, 0.004, HEIGHT_M))


@pytest.fixture
def studio(make_renderer, stage):
    return _Studio(make_renderer, stage)


@pytest.fixture
def low_studio(make_renderer, stage):
    return _Studio(make_renderer, stage, elevation_deg=9)


def test_factors_and_maps_multiply(studio) -> None:
    material = Material(base_colour=(0.5, 1.0, 0.25, 1.0), base_map=_texels(188, 188, 255, 255))
    colours = np.tile(np.float32((1.0, 0.5, 1.0, 1.0)), (4, 1))
    seen = studio.middle(_sheet(material, colours=colours))
    np.testing.assert_allclose(seen / ASSUMED_WHITE, (0.25, 0.25, 0.25), atol=0.01)


def test_emission_adds_to_what_is_reflected(studio) -> None:
    dark = Material(base_colour=(0.2, 0.2, 0.2, 1.0))
    seen = studio.middle(_sheet(replace(dark, emissive=(0.5, 0.2, 0.0), emissive_map=_texels(255, 188, 255, 255))))
    np.testing.assert_allclose(seen / ASSUMED_WHITE, (0.7, 0.3, 0.2), atol=0.01)


def test_emission_above_one_is_white_and_no_more(studio) -> None:
    np.testing.assert_allclose(studio.middle(_sheet(Material(emissive=(40.0, 40.0, 40.0)))), 1.0)


@pytest.mark.parametrize("emission", [0.0, 1e6])
def test_light_beyond_half_precision_is_white(low_studio, stage, emission: float) -> None:
    """A lamp, and the mirror image of the sun. The layers stay finite: some drivers would store infinity."""
    T = low_studio.tracked.marker.T_cam_marker
    _, y, z = -T[:3, :3].T @ T[:3, 3]
    light = stage.light(90, math.degrees(math.atan2(z - HEIGHT_M, -y)), (0.3, 0.3, 0.3))
    polished = Material(metallic=1.0, roughness=0.0, emissive=(emission,) * 3)
    np.testing.assert_allclose(low_studio.at(low_studio.picture(_sheet(polished), light), (0.0, 0.0, HEIGHT_M)), 1.0)
    added_light = np.frombuffer(low_studio.renderer._surface.layers[0].read(), np.float16)
    assert added_light.max() < 0.5 * np.finfo(np.float16).max


def test_occlusion_keeps_the_sky_away_and_not_the_sun(studio, stage) -> None:
    light = stage.light(-90, 60, (0.4, 0.4, 0.4))
    occluded = Material(occlusion_map=_texels(51, 0, 0, 255), occlusion_strength=0.5)
    open_share = 1 + 0.5 * (0.2 - 1)
    np.testing.assert_allclose(
        studio.middle(_sheet(occluded), light) / ASSUMED_WHITE, 0.6 + 0.4 * open_share, atol=0.01
    )
    np.testing.assert_allclose(studio.middle(_sheet(occluded)) / ASSUMED_WHITE, open_share, atol=0.01)


@pytest.mark.parametrize("tilt", [(0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3), (0.2, -0.2)])
def test_normal_map_tilts_the_surface_as_a_tilted_normal_does(studio, stage, tilt: tuple[float, float]) -> None:
    """The map's x is where u grows, its y where v grows upwards in the picture: here x and y of the marker."""
    light = stage.light(30, 40, (0.1, 0.1, 0.1))
    normal = np.array([*tilt, 1.0]) / np.linalg.norm([*tilt, 1.0])
    red, green, blue = np.round(normal * 127 + 128).astype(int)
    mapped = studio.middle(_sheet(Material(normal_map=_texels(red, green, blue, 255))), light)
    tilted = studio.middle(_sheet(Material(), tuple(normal)), light)
    np.testing.assert_allclose(mapped, tilted, atol=0.015)
    assert np.abs(mapped - studio.middle(_sheet(Material()), light)).max() > 0.02


@pytest.mark.parametrize("stretch", [(4.0, 1.0), (1.0, 4.0), (-3.0, 1.0)])
@pytest.mark.parametrize("tilt", [(0.5, 0.0), (0.0, 0.5)])
def test_a_stretched_normal_map_tilts_the_surface_as_much(
    studio, stage, tilt: tuple[float, float], stretch: tuple[float, float]
) -> None:
    """Its x and y are of tangent space, in which both axes are unit vectors: glTF 2.0, 3.7.2.1 and MikkTSpace."""
    light = stage.light(30, 40, (0.1, 0.1, 0.1))
    normal = np.array([*tilt, 1.0]) / np.linalg.norm([*tilt, 1.0])
    red, green, blue = np.round(normal * 127 + 128).astype(int)
    sheet = _sheet(Material(normal_map=_texels(red, green, blue, 255)))
    mapped = studio.middle(replace(sheet, uvs=UVS * np.float32(stretch)), light)
    tilted = studio.middle(_sheet(Material(), tuple(normal * (math.copysign(1, stretch[0]), 1, 1))), light)
    np.testing.assert_allclose(mapped, tilted, atol=0.015)


@pytest.mark.parametrize(("quality", "elevation_deg", "tilt_deg"), in_turns([(10, 72), (20, 72), (40, 49), (55, 30)]))
def test_a_mapped_normal_that_faces_the_sun_leaves_a_flat_surface_unshaded(
    make_renderer, stage, quality: str, elevation_deg: float, tilt_deg: float
) -> None:
    """No acne: shadows fall on the triangle, whatever its normal map says, and a flat one shades itself nowhere."""
    studio = _Studio(make_renderer, stage, quality)
    normal = np.array([math.sin(math.radians(tilt_deg)), 0.0, math.cos(math.radians(tilt_deg))])
    red, green, blue = np.round(normal * 127 + 128).astype(int)
    material = Material(base_colour=(0.3, 0.3, 0.3, 1.0), normal_map=_texels(red, green, blue, 255), roughness=1.0)
    picture = studio.picture(_sheet(material), stage.light(0, elevation_deg, (0.3, 0.3, 0.3)))
    inside = [(x, y, HEIGHT_M) for x in np.linspace(-0.025, 0.025, 21) for y in np.linspace(-0.025, 0.025, 21)]
    columns, rows = np.round(project(studio.tracked.camera, studio.tracked.marker.T_cam_marker, inside)).astype(int).T
    seen = picture[rows, columns, 1].astype(int)
    assert seen.max() < 250
    assert np.ptp(seen) <= 3


def test_normal_map_may_be_flat_mirrored_or_without_coordinates(studio, stage) -> None:
    light = stage.light(30, 40, (0.1, 0.1, 0.1))
    plain = studio.middle(_sheet(Material()), light)
    flat = Material(normal_map=_texels(128, 128, 255, 255))
    np.testing.assert_allclose(studio.middle(_sheet(flat), light), plain, atol=0.01)
    bumpy = Material(normal_map=_texels(200, 128, 228, 255))
    np.testing.assert_allclose(studio.middle(_sheet(replace(bumpy, normal_scale=0.0)), light), plain, atol=0.01)
    # All corners at one place of the map: no tangent can be told.
    nowhere = replace(_sheet(bumpy), uvs=np.zeros((4, 2), np.float32))
    np.testing.assert_allclose(studio.middle(nowhere, light), plain, atol=0.01)
    mirrored = replace(_sheet(bumpy), uvs=UVS * np.float32((-1, 1)))
    towards, away = studio.middle(_sheet(bumpy), light), studio.middle(mirrored, light)
    assert (towards > plain + 0.02).all()
    assert (away < plain - 0.02).all()


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_polished_metal_shows_the_ground_that_lies_before_it(make_renderer, stage, quality: str) -> None:
    """Never black; its lower half is as bright as the ground, times what the metal reflects."""
    for grey in (60, 140):
        studio = _Studio(make_renderer, stage, quality, grey, elevation_deg=30)
        picture = studio.picture(_ball(Material(base_colour=(0.9, 0.6, 0.3, 1.0), metallic=1.0, roughness=0.1)))
        low = math.radians(-10)
        point = (0.0, -0.03 * math.cos(low), 0.03 + 0.03 * math.sin(low))
        expected = float(linear_from_srgb(grey / 255)) * np.array((0.9, 0.6, 0.3))
        np.testing.assert_allclose(studio.at(picture, point), expected, rtol=0.12)


def test_the_grounds_end_in_a_small_polished_ball_is_as_wide_as_a_pixel_at_least(make_renderer, stage) -> None:
    """It was a staircase: from one pixel to the next all ground became all sky."""
    studio = _Studio(make_renderer, stage, grey=30)
    studio.tracked = stage.tracked(30, stage.pose(-90, 35, 0.7))
    studio.picture(_ball(Material(metallic=1.0, roughness=0.0)))
    (x, y), (edge, _) = project(
        studio.tracked.camera, studio.tracked.marker.T_cam_marker, [(0, 0, 0.03), (0.03, 0, 0.03)]
    )
    light = np.frombuffer(studio.renderer._surface.layers[0].read(), np.float16).reshape(360, 480, 4)[::-1, :, 1]
    shares = []
    for column in range(round(x) - 8, round(x) + 9):
        along = light[round(y - 0.8 * (edge - x)) : round(y + 0.8 * (edge - x)), column].astype(float)
        at = int(np.abs(np.diff(along)).argmax())
        shares.append(abs(along[at + 1] - along[at]) / np.ptp(along[max(at - 3, 0) : at + 5]))
    assert np.median(shares) < 0.55


def test_metal_mirrors_what_the_light_was_seen_in_whichever_frame_is_drawn(make_renderer, stage) -> None:
    """And even ground of an ordinary albedo where no frame is given."""
    studio = _Studio(make_renderer, stage, grey=140, elevation_deg=30)
    seen_in = stage.tracked(60, studio.tracked.marker.T_cam_marker)
    ball = stage.placed(_ball(Material(metallic=1.0, roughness=0.1)))
    low = math.radians(-10)
    point = (0.0, -0.03 * math.cos(low), 0.03 + 0.03 * math.sin(low))
    for given, expected in ((seen_in, float(linear_from_srgb(60 / 255))), (None, GROUND_ALBEDO * ASSUMED_WHITE)):
        studio.renderer.render(Scene(studio.tracked, ball, Illumination(seen_in=given)))
        mirrored = studio.at(studio.renderer.read_bgr()[..., ::-1], point)
        np.testing.assert_allclose(mirrored, expected, rtol=0.12)


def test_metal_mirrors_a_sky_as_bright_as_the_measured_one(make_renderer, stage) -> None:
    """Rough metal that faces up averages it; in full shadow it is as bright as white paper there."""
    studio = _Studio(make_renderer, stage)
    rough = Material(metallic=1.0, roughness=1.0)
    sky = np.array(lighting_of((stage.light(90, 20, (0.3, 0.4, 0.5)),)).sky)
    # The sun is behind the sheet's tilt: only the sky is left.
    turned = _sheet(rough, (0.0, -0.4, 1.0))
    seen = studio.middle(turned, stage.light(90, 20, (0.3, 0.4, 0.5))) / ASSUMED_WHITE
    assert (seen > 0.5 * sky).all()
    assert (seen < 1.5 * sky).all()
    assert seen[2] > seen[1] > seen[0]


def test_highlight_stands_where_the_mirror_direction_says_and_widens_with_roughness(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage, "accurate", 20, elevation_deg=45)
    light = stage.light(-60, 50, (0.5, 0.5, 0.5))
    eye = -studio.tracked.marker.T_cam_marker[:3, :3].T @ studio.tracked.marker.T_cam_marker[:3, 3]
    areas = []
    for roughness in (0.15, 0.3, 0.45):
        ball = _ball(Material(base_colour=(0.0, 0.0, 0.0, 1.0), roughness=roughness))
        shine = linear_from_srgb(studio.picture(ball, light) / 255).mean(axis=2)
        shine -= linear_from_srgb(studio.picture(ball) / 255).mean(axis=2)
        rows, columns = np.nonzero(shine > 0.5 * shine.max())
        centre = np.array([0, 0, 0.03])
        between = light.to_light_marker + (eye - centre) / np.linalg.norm(eye - centre)
        place = centre + 0.03 * between / np.linalg.norm(between)
        expected = project(studio.tracked.camera, studio.tracked.marker.T_cam_marker, [place])[0]
        assert math.dist((columns.mean(), rows.mean()), expected) < 4
        areas.append(len(rows))
    assert areas[0] < areas[1] < areas[2]


@pytest.mark.parametrize(("quality", "size_deg"), in_turns([(10.0,), (16.0,), (24.0,)]))
def test_a_polished_ball_mirrors_a_wide_light_as_large_and_as_bright_as_it_is(
    make_renderer, stage, quality: str, size_deg: float
) -> None:
    """Its disc has one brightness, by which it lights the ground, of which glass mirrors 4 %, and an end."""
    studio = _Studio(make_renderer, stage, quality, 20, elevation_deg=45)
    half = math.radians(size_deg / 2)
    share = 8 * math.sin(half) ** 2
    light = replace(stage.light(-60, 50, (1 - share,) * 3), angular_size_rad=2 * half)
    picture = studio.picture(_ball(Material(base_colour=(0.0, 0.0, 0.0, 1.0), roughness=0.1)), light)
    eye = -studio.tracked.marker.T_cam_marker[:3, :3].T @ studio.tracked.marker.T_cam_marker[:3, 3]
    around, tilts = np.meshgrid(np.linspace(-math.pi, 0, 241), np.linspace(0, 1.2, 121))
    normals = np.stack([np.sin(tilts) * np.cos(around), np.sin(tilts) * np.sin(around), np.cos(tilts)], -1).reshape(
        -1, 3
    )
    to_eye = eye - (0, 0, 0.03) - 0.03 * normals
    to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
    cosines = (normals * to_eye).sum(axis=1)
    mirrored, to_eye = (2 * cosines[:, None] * normals - to_eye)[cosines > 0.3], to_eye[cosines > 0.3]
    aside = np.arccos(np.clip(mirrored @ light.to_light_marker, -1, 1)) / half
    places = (0, 0, 0.03) + 0.03 * normals[cosines > 0.3]
    columns, rows = project(studio.tracked.camera, studio.tracked.marker.T_cam_marker, places).round().astype(int).T
    seen = linear_from_srgb(picture[rows, columns, 1] / 255) / ASSUMED_WHITE
    bright = 0.04 * lighting_of((light,)).lights[0].irradiance[1] / math.sin(half) ** 2
    beside = np.median(seen[(aside > 1.6) & (aside < 2.5)])
    assert beside < 0.2 * bright
    assert np.median(seen[aside < 0.7]) == pytest.approx(bright + beside, rel=0.12)
    assert (seen[aside < 0.7] > 0.7 * bright).mean() > 0.97
    assert (seen[(aside > 1.6) & (aside < 3.0)] < 0.35 * bright).mean() > 0.97


@pytest.mark.parametrize(("quality", "roughness"), in_turns([(0.25,), (0.3,), (0.4,)]))
def test_the_highlight_of_a_wide_light_is_the_mean_of_those_of_its_points(
    make_renderer, stage, quality: str, roughness: float
) -> None:
    studio = _Studio(make_renderer, stage, quality, 20, elevation_deg=45)
    ball = _ball(Material(base_colour=(0.0, 0.0, 0.0, 1.0), roughness=roughness))
    light, half = stage.light(-60, 50, (0.92, 0.92, 0.92)), math.radians(8)

    def shine(direction: np.ndarray, size_rad: float) -> np.ndarray:
        lit = replace(light, to_light_marker=direction, angular_size_rad=size_rad)
        return linear_from_srgb(studio.picture(ball, lit)[..., 1] / 255)

    across, along = light_view(light.to_light_marker)[:2, :3]
    numbers = np.arange(24) + 0.5
    aside, turns = np.sqrt(numbers / 24) * math.tan(half), numbers * math.pi * (3 - math.sqrt(5))
    points = light.to_light_marker + np.outer(aside * np.cos(turns), across) + np.outer(aside * np.sin(turns), along)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    mean = np.mean([shine(point, 1e-4) for point in points], axis=0)
    wide = shine(light.to_light_marker, 2 * half)
    assert mean.max() < 0.8
    assert wide.max() == pytest.approx(mean.max(), rel=0.05)
    is_bright = mean > 0.5 * mean.max()
    assert wide[is_bright].sum() == pytest.approx(mean[is_bright].sum(), rel=0.1)


@pytest.mark.parametrize(
    ("roughness", "expected"), [(0.3, (0.464, 0.811)), (0.6, (0.418, 0.780)), (0.93, (0.282, 0.666))]
)
def test_rough_metal_is_as_saturated_as_a_path_tracer_has_it(make_renderer, stage, roughness: float, expected) -> None:
    """Light that is thrown from facet to facet is coloured each time. Cycles 5.0, even light, seen 30 degrees off."""
    studio = _Studio(make_renderer, stage)
    red, green, blue = studio.middle(_sheet(Material((0.98, 0.457, 0.796, 1.0), metallic=1.0, roughness=roughness)))
    np.testing.assert_allclose((green / red, blue / red), expected, atol=0.02)


def test_normals_that_lean_away_mirror_nothing_from_below_the_surface(make_renderer, stage) -> None:
    """Seen from behind such a normal metal would be as white as any surface at a grazing angle."""
    studio = _Studio(make_renderer, stage)
    red = Material((0.9, 0.2, 0.1, 1.0), metallic=1.0, roughness=0.1)
    for normal in ((0.0, 1.0, 0.2), (0.0, 1.0, 0.6), (1.0, 1.0, 0.1)):
        seen = studio.middle(_sheet(red, normal))
        assert seen[0] > 0.1
        np.testing.assert_allclose(seen / seen[0], np.array((0.9, 0.2, 0.1)) / 0.9, atol=0.08)


def _rod(material: Material, radius_m: float, turned_deg: float) -> Mesh:
    """It lies across the picture, turned a little from its rows."""
    angles = np.linspace(0, 2 * math.pi, 25)
    along = np.array([math.cos(math.radians(turned_deg)), math.sin(math.radians(turned_deg)), 0.0])
    normals = np.outer(np.cos(angles), np.cross((0, 0, 1), along)) + np.outer(np.sin(angles), (0, 0, 1))
    ends = np.concatenate([radius_m * normals - 0.03 * along, radius_m * normals + 0.03 * along])
    a = np.arange(24)
    triangles = np.concatenate([np.stack([a, a + 26, a + 25], 1), np.stack([a, a + 1, a + 26], 1)])
    vertices = (ends + np.array([0, 0, HEIGHT_M])).astype(np.float32)
    return Mesh(vertices, np.tile(normals, (2, 1)).astype(np.float32), triangles, material=material)


def test_the_highlight_on_a_thin_rod_is_a_line_and_no_dots(make_renderer, stage) -> None:
    """Wherever it lies among the pixels' rows: a rod of two pixels' radius turns by half a circle within four rows."""
    studio = _Studio(make_renderer, stage, "balanced", grey=0)
    sun = stage.light(90, 60, (0.3, 0.3, 0.3))
    black = Material(base_colour=(0.0, 0.0, 0.0, 1.0), roughness=0.25)
    picture = linear_from_srgb(studio.picture(_rod(black, 0.001, 4.0), sun)[..., 1] / 255)
    line = picture[:, 190:290].sum(axis=0)  # of each column across the rod
    assert line.mean() > 0.1
    assert line.std() < 0.5 * line.mean()


@pytest.mark.parametrize("turned_deg", [9.0, 14.0])
def test_a_thin_rod_that_is_lit_from_behind_is_as_bright_all_along(make_renderer, stage, turned_deg: float) -> None:
    """The light ends within a pixel: where the pixels' middles alone were asked, lit and unlit ones took turns."""
    studio = _Studio(make_renderer, stage, "balanced", grey=0)
    matt = Material(base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0)
    low_sun = stage.light(90, 10, (0.3, 0.3, 0.3))
    picture = linear_from_srgb(studio.picture(_rod(matt, 0.001, turned_deg), low_sun)[..., 1] / 255)
    line = picture[:, 190:290].sum(axis=0)  # of each column across the rod
    assert line.mean() > 0.5
    assert line.std() < 0.1 * line.mean()


def test_clear_coat_puts_the_highlight_of_glass_on_what_is_matt(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage, "accurate", 20, elevation_deg=45)
    light = stage.light(-60, 50, (0.5, 0.5, 0.5))
    red = Material(base_colour=(0.5, 0.0, 0.0, 1.0))
    coated = replace(red, coat=1.0, coat_roughness=0.3)
    materials = red, coated, replace(red, roughness=0.3)
    bare, seen, glass = (linear_from_srgb(studio.picture(_ball(each), light) / 255) for each in materials)
    brightest = [np.unravel_index(picture[..., 2].argmax(), picture.shape[:2]) for picture in (seen, glass)]
    assert math.dist(*brightest) < 2
    added = (seen - bare)[brightest[0]]
    np.testing.assert_allclose(added / added.mean(), 1, atol=0.2)  # as white as the sun
    np.testing.assert_allclose(added, (glass - bare)[brightest[1]], rtol=0.15)
    np.testing.assert_array_equal(
        studio.picture(_ball(replace(red, coat_roughness=0.3)), light), studio.picture(_ball(red), light)
    )


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_no_material_sends_back_more_than_it_gets(make_renderer, stage, metallic: float, roughness: float) -> None:
    """White, level, under an even light from everywhere: never above the white of fully lit paper by more than the
    sky's pattern, never dark."""
    studio = _Studio(make_renderer, stage, grey=round(255 * float(srgb_from_linear(ASSUMED_WHITE))))
    plain = Material(metallic=metallic, roughness=roughness)
    for material in (plain, replace(plain, coat=1.0, coat_roughness=roughness)):
        seen = studio.middle(_sheet(material)) / ASSUMED_WHITE
        assert (seen < 1.25).all()
        assert (seen > 0.7).all()


def test_roughness_and_metal_come_from_the_maps_green_and_blue(studio, stage) -> None:
    light = stage.light(-90, 60, (0.3, 0.3, 0.3))
    for metallic, roughness in ((0.0, 0.5), (1.0, 0.3), (0.4, 0.8)):
        texels = _texels(77, round(255 * roughness), round(255 * metallic), 255)
        mapped = Material((0.6, 0.3, 0.1, 1.0), metallic=1.0, roughness=1.0, metallic_roughness_map=texels)
        plain = replace(mapped, metallic=metallic, roughness=roughness, metallic_roughness_map=None)
        np.testing.assert_allclose(studio.middle(_sheet(mapped), light), studio.middle(_sheet(plain), light), atol=0.03)


def test_cut_out_has_holes_in_the_model_and_in_its_shadow(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage, elevation_deg=70)
    texels = np.full((8, 8, 4), 255, dtype=np.uint8)
    texels[:, 4:, 3] = 100  # the half at +x
    light = stage.light(90, 45, (0.2, 0.2, 0.2))  # shadows fall 0.03 towards -y
    for cutoff, half_is_open in ((0.5, True), (0.3, False)):
        sheet = _sheet(Material(base_map=texels, alpha=Alpha.CUT_OUT, alpha_cutoff=cutoff))
        picture = studio.picture(sheet.moved(1.0, LIFT), light)
        ground = float(linear_from_srgb(100 / 255))
        for x, is_open in ((-0.015, False), (0.015, half_is_open)):
            np.testing.assert_allclose(
                studio.at(picture, (x, -0.045, 0.0)), ground if is_open else 0.2 * ground, rtol=0.1
            )
            seen = studio.at(picture, (x, 0.01, 0.03))
            assert (np.abs(seen - ASSUMED_WHITE) < 0.02).all() != is_open


@pytest.mark.parametrize(("alpha", "is_kept"), [(1.0, True), (0.5, True), (0.5 - 1 / 255, False), (0.0, True)])
def test_what_has_the_alpha_of_the_cut_off_is_kept_whole(make_renderer, stage, alpha: float, is_kept: bool) -> None:
    """glTF 2.0, 3.9.4: with an alpha of at least the cut-off it is fully opaque, and else nothing."""
    studio = _Studio(make_renderer, stage)
    cutoff = alpha if is_kept else 0.5
    red = Material(base_colour=(1.0, 0.0, 0.0, alpha), alpha=Alpha.CUT_OUT, alpha_cutoff=cutoff)
    studio.picture(_sheet(red))
    covered = _layer(studio)[..., 3][np.abs(np.stack(_on_sheet(studio, 1))).max(axis=0) < 0.9]
    np.testing.assert_allclose(covered, float(is_kept), atol=1e-3)


def _layer(studio: _Studio) -> np.ndarray:
    """(h, w, 4) the light that the model added to the last picture, and what it covers of each pixel."""
    width, height = studio.tracked.frame.size
    return np.frombuffer(studio.renderer._surface.layers[0].read(), np.float16).reshape(height, width, 4)[::-1]


def _on_sheet(studio: _Studio, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Where places in the picture, `samples` squared a pixel, lie on `_sheet`, whose corners are at -1 and 1."""
    outline = project(studio.tracked.camera, studio.tracked.marker.T_cam_marker, CORNERS).astype(np.float32)
    to_sheet = cv2.getPerspectiveTransform(outline, np.float32([(-1, -1), (1, -1), (1, 1), (-1, 1)]))
    columns, rows = np.meshgrid(*((np.arange(n * samples) + 0.5) / samples - 0.5 for n in studio.tracked.frame.size))
    u, v, w = np.einsum("ij,j...->i...", to_sheet, np.stack([columns, rows, np.ones_like(rows)]))
    return u / w, v / w


def _share(inside: np.ndarray, samples: int) -> np.ndarray:
    rows, columns = inside.shape
    return inside.reshape(rows // samples, samples, columns // samples, samples).mean(axis=(1, 3))


def test_pixels_on_the_rim_of_a_cut_out_are_covered_as_far_as_it_reaches_in_every_quality(make_renderer, stage) -> None:
    x, y = (np.mgrid[:128, :128] + 0.5) / 64 - 1
    texels = np.full((128, 128, 4), 255, np.uint8)
    texels[..., 3] = np.clip(127.5 + 8160 * (0.8 - np.hypot(x, y)), 0, 255)  # a disc whose rim is a texel wide
    disc = _sheet(Material(base_map=texels, alpha=Alpha.CUT_OUT))
    studios = [_Studio(make_renderer, stage, quality, elevation_deg=50) for quality in QUALITIES]
    true = _share(np.hypot(*_on_sheet(studios[0], 8)) < 0.8, 8)
    for studio in studios:
        studio.picture(disc)
        wrong = (_layer(studio)[..., 3] - true)[(true > 0) & (true < 1)]
        assert np.sqrt(np.square(wrong).mean()) < 0.1  # 0.29 where a pixel is covered or not


def test_a_part_that_lies_close_on_another_has_a_smooth_edge(make_renderer, stage) -> None:
    """Half of a white sheet is black, drawn with one sample a pixel."""
    studio = _Studio(make_renderer, stage, elevation_deg=70)
    half = CORNERS + np.float32((0, 0, 5e-5))
    half[2:, 1] = 0.004, -0.004
    black = replace(_sheet(Material(base_colour=(0.0, 0.0, 0.0, 1.0))), vertices=half)
    studio.renderer.render(Scene(studio.tracked, stage.placed(_sheet(Material()), black)))
    u, v = _on_sheet(studio, 8)
    true = _share(v > 2 / 15 * u, 8)
    seen = _layer(studio)[..., 1] / np.percentile(_layer(studio)[..., 1], 99)
    on_edge = (true > 0) & (true < 1) & (np.abs(_on_sheet(studio, 1)[0]) < 0.8)
    assert np.sqrt(np.square((seen - true)[on_edge]).mean()) < 0.18  # 0.29 where a pixel has one of the two


def test_light_comes_through_a_hull_where_it_is_not_seen(make_renderer, stage) -> None:
    """As black hulls outline figures: single-sided, a little larger, and facing inwards. The shadow is the hull's."""
    studio = _Studio(make_renderer, stage)
    light = stage.light(-90, 50, (0.2, 0.2, 0.2))
    ball, larger = _ball(Material(roughness=1.0)), _ball(Material(double_sided=False, roughness=1.0), 0.033)
    hull = replace(larger, triangles=larger.triangles[:, ::-1], normals=-larger.normals, faces_inwards=True)
    pictures = []
    for parts in ((ball,), (ball, hull)):
        placed = stage.placed(*parts)
        studio.renderer.render(Scene(studio.tracked, placed, Illumination((light,), seen_in=studio.tracked)))
        pictures.append(studio.renderer.read_bgr()[..., ::-1])
    for place in ((0, -0.02, 0.052), (0, 0, 0.06)):
        bare, within = (studio.at(picture, place) for picture in pictures)
        np.testing.assert_allclose(within, bare, rtol=0.1)


def test_alpha_is_ignored_by_what_is_opaque(studio) -> None:
    see_through = _texels(255, 255, 255, 0)
    np.testing.assert_allclose(studio.middle(_sheet(Material(base_map=see_through))) / ASSUMED_WHITE, 1.0, atol=0.01)


def test_blended_surface_shows_what_is_behind_it_and_its_shadow_is_as_light(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage, "accurate", elevation_deg=70)
    light = stage.light(90, 45, (0.2, 0.2, 0.2))
    ground = float(linear_from_srgb(100 / 255))
    reds, shadows = [], []
    for alpha in (0.0, 0.25, 0.5, 0.75, 1.0):
        material = Material(base_colour=(1.0, 0.0, 0.0, alpha), alpha=Alpha.BLEND)
        picture = studio.picture(_sheet(material).moved(1.0, LIFT), light)
        reds.append(studio.at(picture, (0.0, 0.015, 0.03))[1])
        patch = [studio.at(picture, (x, -0.045 + y, 0)).mean() for x in (-2e-3, 0, 2e-3) for y in (-2e-3, 0, 2e-3)]
        shadows.append((1 - np.mean(patch) / ground) / 0.8)
    np.testing.assert_allclose(reds[0], ground, rtol=0.1)  # nothing but the ground's green
    np.testing.assert_allclose(reds[-1], 0.0, atol=0.005)
    assert (np.diff(reds) < -0.005).all()
    np.testing.assert_allclose(shadows, (0.0, 0.25, 0.5, 0.75, 1.0), atol=0.08)


@pytest.mark.parametrize("alpha", [Alpha.BLEND, Alpha.CUT_OUT])
def test_the_shadow_is_as_light_as_the_alpha_of_vertices_makes_the_surface(make_renderer, stage, alpha: Alpha) -> None:
    """From nothing at -x to all at +x: a blended shadow fades likewise, that of a cut-out ends in the middle."""
    studio = _Studio(make_renderer, stage, "accurate", elevation_deg=70)
    colours = np.float32([(1, 1, 1, x > 0) for x, *_ in CORNERS])
    sheet = replace(_sheet(Material(alpha=alpha), colours=colours), uvs=None)
    picture = studio.picture(
        sheet.moved(1.0, LIFT), stage.light(90, 45, (0.2, 0.2, 0.2))
    )  # shadows fall 0.03 towards -y
    ground = float(linear_from_srgb(100 / 255))
    for x in (-0.025, -0.015, 0.015, 0.025):
        patch = [studio.at(picture, (x + dx, -0.045 + dy, 0)).mean() for dx in (-2e-3, 0, 2e-3) for dy in (-2e-3, 2e-3)]
        share = x / 0.06 + 0.5 if alpha is Alpha.BLEND else float(x > 0)
        assert (1 - np.mean(patch) / ground) / 0.8 == pytest.approx(share, abs=0.1)


def test_where_a_blended_surface_is_cut_away_it_mirrors_nothing(make_renderer, stage) -> None:
    """Pictures of leaves, hair and signs are such holes for the most part; no pane is to be seen around them."""
    studio = _Studio(make_renderer, stage, elevation_deg=20)
    ground = float(linear_from_srgb(100 / 255))
    for alpha, mirrors in ((0, False), (26, True)):
        material = Material(base_map=_texels(255, 255, 255, alpha), roughness=0.1, alpha=Alpha.BLEND)
        seen = studio.middle(_sheet(material), stage.light(90, 30, (0.3, 0.3, 0.3)))
        assert (np.abs(seen - ground) > 0.05).all() == mirrors
        assert (np.abs(seen - ground) < 0.01).all() != mirrors


def test_the_shadow_of_a_ball_of_glass_is_darkest_at_its_rim(make_renderer, stage) -> None:
    """Glass mirrors 0.04 of the light that falls straight on it, and all that grazes it (Fresnel)."""
    studio = _Studio(make_renderer, stage, "accurate", elevation_deg=70)
    light = stage.light(90, 45, (0.2, 0.2, 0.2))
    glass = _ball(Material(base_colour=(1.0, 1.0, 1.0, 0.1), alpha=Alpha.BLEND), radius_m=0.015)
    picture = studio.picture(glass.moved(1.0, np.array((0, 0, 0.03))), light)
    ground = float(linear_from_srgb(100 / 255))
    middle, rim = (
        (1 - np.mean([studio.at(picture, (side * x, -0.045, 0)) for x in places for side in (-1, 1)]) / ground) / 0.8
        for places in ((0.0, 0.002, 0.004), (0.0143, 0.0145, 0.0147))
    )
    assert middle == pytest.approx(2 * (0.1 + 0.9 * 0.04), abs=0.08)  # both sides of the ball
    assert rim > middle + 0.2


@pytest.mark.parametrize(("quality", "alpha"), in_turns([(0.1,), (0.3,), (0.6,), (0.6,), (0.1,), (0.3,)]))
def test_the_shadow_of_a_clear_sheet_is_even(make_renderer, stage, quality: str, alpha: float) -> None:
    """On what lies below it, and on the ground: of the texels that stop the light none is seen."""
    studio = _Studio(make_renderer, stage, quality, grey=160, elevation_deg=70)
    below = _sheet(Material(base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0))
    clear = _sheet(Material(base_colour=(1.0, 1.0, 1.0, alpha), alpha=Alpha.BLEND))
    both = stage.placed(below, clear.moved(1.0, LIFT))
    light = stage.light(-90, 55, (0.2, 0.2, 0.2))  # casts both shadows away from the camera
    studio.renderer.render(Scene(studio.tracked, both, Illumination((light,), seen_in=studio.tracked)))
    picture = studio.renderer.read_bgr()[..., ::-1]
    xs = np.linspace(-0.02, 0.02, 60)
    for height, ys in ((HEIGHT_M, (0.0, 0.01)), (0.0, (0.046, 0.048))):
        seen = np.array([[studio.at(picture, (x, y, height))[1] for x in xs] for y in ys])
        assert (seen.std(axis=1) < 0.005 * seen.mean(axis=1)).all()


@pytest.fixture
def error_of_ball(make_renderer, stage):
    """How far a small ball's picture is from one that is eight times as fine: RMS over the ball, linear."""
    preset = replace(FAST.render, matches_blur=False)
    renderers = [make_renderer(preset, (480 * finer, 360 * finer)) for finer in (1, 8)]

    def error(tracked, material: Material, shift_m: float, *lights) -> float:
        ball = _ball(material, radius_m=0.012).moved(1.0, np.array((shift_m, 0.5 * shift_m, 0)))
        outline = project(tracked.camera, tracked.marker.T_cam_marker, ball.vertices).astype(int)
        (left, top), (right, bottom) = outline.min(axis=0) - 3, outline.max(axis=0) + 3
        seen = []
        for renderer in renderers:
            renderer.render(Scene(tracked, stage.placed(ball), Illumination(lights, seen_in=tracked)))
            light = linear_from_srgb(renderer.read_bgr()[..., 1] / 255)
            seen.append(cv2.resize(light, (480, 360), interpolation=cv2.INTER_AREA)[top:bottom, left:right])
        return float(np.sqrt(np.square(seen[0] - seen[1]).mean()))

    return error


@pytest.mark.parametrize("shift_m", [0.0, 2e-4, 5e-4])
def test_the_outline_of_a_polished_ball_mirrors_the_ground_behind_it(error_of_ball, stage, shift_m: float) -> None:
    """And no mean of all ground: bright ground lies beyond the dark one."""
    T = stage.pose(-90, 35, 0.35)
    picture = np.full((360, 480, 3), 200, np.uint8)
    dark = np.array([(-0.08, -0.08, 0), (0.08, -0.08, 0), (0.08, 0.08, 0), (-0.08, 0.08, 0)])
    cv2.fillPoly(picture, [np.round(project(stage.camera(), T, dark)).astype(np.int32)], (25, 25, 25))
    metal = Material(base_colour=(0.5, 0.5, 0.5, 1.0), metallic=1.0, roughness=0.15)
    assert error_of_ball(stage.tracked(picture, T), metal, shift_m) < 0.014


def test_the_outline_of_a_polished_ball_does_not_sparkle_in_the_sun(error_of_ball, stage) -> None:
    metal = Material(base_colour=(0.5, 0.5, 0.5, 1.0), metallic=1.0, roughness=0.3)
    tracked, sun = stage.tracked(40, stage.pose(-90, 35, 0.35)), stage.light(60, 30, (0.3, 0.3, 0.3))
    assert error_of_ball(tracked, metal, 5e-4, sun) < 0.042


def test_the_order_of_triangles_in_a_glass_does_not_matter(make_renderer, stage) -> None:
    """Its near wall does not hide the far one."""
    studio = _Studio(make_renderer, stage, elevation_deg=30)
    wall = Material(base_colour=(0.8, 0.2, 0.1, 0.4), alpha=Alpha.BLEND, roughness=0.5)
    cup = replace(_ball(wall), triangles=_ball(wall).triangles[256:])  # open at the top
    inner = replace(cup, vertices=(cup.vertices - (0, 0, 0.03)) * np.float32(0.93) + np.float32((0, 0, 0.03)))
    both = Mesh(
        np.concatenate([cup.vertices, inner.vertices]).astype(np.float32),
        np.concatenate([cup.normals, -inner.normals]),
        np.concatenate([cup.triangles, inner.triangles[:, ::-1] + len(cup.vertices)]),
        material=wall,
    )
    light = stage.light(-60, 40, (0.3, 0.3, 0.3))
    pictures = [
        studio.picture(replace(both, triangles=np.ascontiguousarray(both.triangles[::step])), light).astype(int)
        for step in (1, -1)
    ]
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 6).mean() < 1e-3


def test_near_blended_surface_covers_a_far_one_whatever_their_order(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage, elevation_deg=80)
    red = _sheet(Material(base_colour=(1.0, 0.0, 0.0, 0.9), alpha=Alpha.BLEND))
    blue = _sheet(Material(base_colour=(0.0, 0.0, 1.0, 0.9), alpha=Alpha.BLEND)).moved(1.0, LIFT)
    for parts in ((red, blue), (blue, red)):
        studio.renderer.render(Scene(studio.tracked, stage.placed(*parts)))
        seen = studio.at(studio.renderer.read_bgr()[..., ::-1], (0, 0, 0.03))
        assert seen[2] > 5 * seen[0]


@pytest.mark.parametrize("by_vertices", [False, True])
def test_what_is_behind_the_holes_of_a_near_card_is_seen(make_renderer, stage, by_vertices: bool) -> None:
    """Of a clear card, by its picture or by its vertices, above a red one in one mesh, whichever comes first."""
    studio = _Studio(make_renderer, stage, elevation_deg=80)
    picture = np.zeros((4, 8, 4), np.uint8)
    picture[...] = (0, 0, 255, 0)
    picture[:, 4:] = (255, 0, 0, 255)
    halves = np.float32([(0.25, v) for _, v in UVS]), np.float32([(0.75, v) for _, v in UVS])
    colours = np.float32([(0, 0, 1, 0)] * 4), np.float32([(1, 0, 0, 1)] * 4)
    near, far = CORNERS + np.float32((0, 0, 0.02)), CORNERS
    up = np.float32([(0, 0, 1)] * 8)
    for order in (1, -1):
        cards = list(zip((near, far), halves, colours, strict=True))[::order]
        both = Mesh(
            np.concatenate([places for places, _, _ in cards]),
            up,
            np.concatenate([TRIANGLES, TRIANGLES + 4]),
            uvs=None if by_vertices else np.concatenate([uvs for _, uvs, _ in cards]),
            colours=np.concatenate([each for _, _, each in cards]) if by_vertices else None,
            material=Material(base_map=None if by_vertices else picture, alpha=Alpha.BLEND),
        )
        red, green, _ = studio.middle(both)
        assert red > 5 * green


@pytest.mark.parametrize("has_holes", [False, True])
@pytest.mark.parametrize("order", [1, -1])
def test_what_is_solid_of_a_blended_surface_hides_what_is_behind_it(
    make_renderer, stage, has_holes: bool, order: int
) -> None:
    """Whatever the middles of the parts: many files blend all parts of a figure, for the sake of its lashes."""
    studio = _Studio(make_renderer, stage, elevation_deg=80)

    def blended(rgb: tuple[int, ...]) -> Material:
        picture = np.full((8, 8, 4), (*rgb, 255), np.uint8)
        picture[:1, :1, 3] = 0 if has_holes else 255
        return Material(base_map=picture, alpha=Alpha.BLEND)

    below = _sheet(blended((255, 0, 0)))
    above, aside = (_sheet(blended((0, 0, 255))).moved(1.0, np.array(at)) for at in ((0, 0, 0.02), (0, 0.5, 0.0)))
    far_middle = replace(
        above,
        vertices=np.concatenate([above.vertices, aside.vertices]),
        normals=np.concatenate([above.normals, aside.normals]),
        triangles=np.concatenate([TRIANGLES, TRIANGLES + 4]),
        uvs=np.concatenate([UVS, UVS]),
    )
    parts = (below, far_middle)[::order]
    studio.renderer.render(Scene(studio.tracked, stage.placed(*parts)))
    red, _, blue = studio.at(studio.renderer.read_bgr()[..., ::-1], (0.0, 0.0, 0.03))
    assert blue > 5 * red


def test_unlit_surfaces_have_the_colours_of_their_vertices_whatever_light_there_is(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage)
    shines = Material(base_colour=(0.0, 0.0, 0.0, 1.0), emissive=(0.5, 0.5, 0.5), is_unlit=True)
    sheet = _sheet(shines, colours=np.float32([(0.2, 1.0, 0.5, 1.0)] * 4))
    seen = [studio.middle(sheet, stage.light(90, 45, (ratio,) * 3)) for ratio in (0.2, 0.9)]
    assert seen[0] == pytest.approx(seen[1], rel=0.02)
    assert seen[0] / seen[0][1] == pytest.approx([0.2, 1.0, 0.5], abs=0.03)


def test_what_a_clear_surface_emits_counts_by_its_opacity(make_renderer, stage) -> None:
    studio = _Studio(make_renderer, stage)
    ground, opaque, clear = (
        studio.middle(_sheet(Material(base_colour=(0.0, 0.0, 0.0, alpha), emissive=(0.8,) * 3, alpha=Alpha.BLEND)))
        for alpha in (0.0, 1.0, 0.3)
    )
    assert clear == pytest.approx(0.3 * opaque + 0.7 * ground, rel=0.15)  # less what it shades below it


def test_glass_goes_on_behind_the_rim_of_what_is_cut_out_before_it(make_renderer, stage) -> None:
    """Along a slanting cut, whose rim covers a part of many pixels, no ground shines through."""
    studio = _Studio(make_renderer, stage, grey=255, elevation_deg=80)
    rows, columns = np.indices((64, 64))
    cut = np.zeros((64, 64, 4), np.uint8)
    cut[..., 3] = np.clip(128 + 12 * (columns - 32) + 3 * (rows - 32), 0, 255)
    black = _sheet(Material(base_map=cut, alpha=Alpha.CUT_OUT)).moved(1.0, LIFT)
    green = _sheet(Material(base_colour=(0.0, 0.5, 0.0, 0.94), alpha=Alpha.BLEND))
    picture = stage.picture(studio.renderer, Scene(studio.tracked, stage.placed(green, black)))[..., ::-1].astype(float)
    xs, ys = np.linspace(-0.012, 0.012, 61), np.linspace(-0.01, 0.01, 41)
    red = np.array([studio.at(picture, (x, y, 0.03))[0] for x in xs for y in ys])
    assert red.max() < 0.05


@pytest.mark.parametrize("scale", [0.0625, 25.0])
def test_markers_of_5_mm_and_2_m_look_alike_from_alike_distances(make_renderer, stage, scale: float) -> None:
    """The usual marker has 80 mm; everything else in proportion."""
    pictures = []
    for factor in (1.0, scale):
        pose = stage.pose(-60, 40, 0.25)
        pose[:3, 3] *= factor
        tracked = stage.tracked(stage.noise(4) // 4 + 90, pose)
        tracked = replace(tracked, marker=replace(tracked.marker, side_m=0.08 * factor))
        ball = _ball(Material(base_colour=(0.8, 0.7, 0.3, 1.0), metallic=1.0, roughness=0.3))
        mesh = replace(ball, vertices=ball.vertices * np.float32(factor))
        renderer = make_renderer(FAST.render)
        renderer.render(Scene(tracked, stage.placed(mesh), Illumination((stage.light(20, 40, (0.3, 0.3, 0.3)),))))
        pictures.append(renderer.read_bgr().astype(int))
    differs = np.abs(pictures[0] - pictures[1]).max(axis=2) > 4
    assert differs.mean() < 0.002


def test_colours_of_slivers_are_never_beyond_those_of_their_corners(make_renderer, stage) -> None:
    """Samples of a pixel that such a triangle covers lie beside the pixel's middle, where its colours grow on."""
    around = np.linspace(0, 2 * math.pi, 1000, endpoint=False)
    corners = np.stack([0.03 * np.cos(around), 0.03 * np.sin(around), np.full(1000, HEIGHT_M)], axis=1)
    wires = np.concatenate([corners, 0.99 * corners]).astype(np.float32)
    first = np.arange(0, 999)
    triangles = np.stack([first, first + 1, first + 1000], 1)
    normals = np.tile(np.float32((0, 0, 1)), (2000, 1))
    colours = np.ones((2000, 4), np.float32)
    colours[::2, :3] = 0.5
    coloured = Mesh(wires, normals, triangles, colours=colours, material=Material())
    studio = _Studio(make_renderer, stage, "balanced", elevation_deg=35)
    brightest = studio.picture(replace(coloured, colours=np.ones_like(colours))).astype(int)
    darkest = studio.picture(replace(coloured, colours=np.where(colours < 2, np.float32(0.5), 1))).astype(int)
    seen = studio.picture(coloured)
    assert np.any(brightest > darkest + 20)
    assert (np.minimum(brightest, darkest) - 1 <= seen).all()
    assert (seen <= np.maximum(brightest, darkest) + 1).all()
