"""Light on the model: even where it must be even, as bright as the formula says."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh
from ashe_live.models.primitives import box
from ashe_live.quality import QUALITIES
from ashe_live.render.camera.white import ASSUMED_WHITE as EXPOSURE
from ashe_live.render.camera.white import INK_RATIO, PAPER_ALBEDO
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.scene import Scene
from tests.render.in_turns import in_turns

MOST_FACETED = 0.03  # difference of a ball of few triangles from a round one, over its brightest place
SIDE = 0.06
TOP = [(-0.03, -0.03, SIDE), (0.03, -0.03, SIDE), (0.03, 0.03, SIDE), (-0.03, 0.03, SIDE)]
FRONT = [(-0.03, -0.03, 0), (0.03, -0.03, 0), (0.03, -0.03, SIDE), (-0.03, -0.03, SIDE)]


def _face(picture: np.ndarray, tracked, corners: list[tuple[float, ...]]) -> np.ndarray:
    """(n, 3) pixels of a face, two pixels away from its edges."""
    outline = project(tracked.camera, tracked.marker.T_cam_marker, corners)
    mask = np.zeros(picture.shape[:2], dtype=np.uint8)
    cv2.fillConvexPoly(mask, np.round(outline).astype(np.int32), 1)
    return picture[cv2.erode(mask, np.ones((5, 5))) > 0].astype(float)


@pytest.mark.parametrize(("quality", "elevation_deg"), in_turns((each,) for each in (2, 5, 10, 20, 35, 50, 70, 85, 90)))
def test_lit_faces_of_a_convex_box_have_one_shade(make_renderer, stage, quality: str, elevation_deg: float) -> None:
    """No acne: a convex model never shadows a face that the light sees."""
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(90, stage.pose(-80, 35, 0.25))
    light = stage.light(-105, elevation_deg, (0.3, 0.3, 0.3))
    picture = stage.picture(renderer, Scene(tracked, stage.placed(box((SIDE, SIDE, SIDE))), Illumination((light,))))
    lighting = lighting_of((light,))
    for corners, normal in ((TOP, (0.0, 0.0, 1.0)), (FRONT, (0.0, -1.0, 0.0))):
        pixels = _face(picture, tracked, corners)
        assert len(pixels) > 500
        upward = 0.5 + 0.5 * normal[2]
        sunlight = lighting.lights[0].irradiance[0] * max(0.0, float(np.dot(normal, light.to_light_marker)))
        radiance = EXPOSURE * (lighting.sky[0] * upward + lighting.bounce[0] * (1 - upward) + sunlight)
        # Rounded to half precision, to 8 bits and by the GPU's own powers; acne would be tens of levels.
        np.testing.assert_allclose(pixels, 255 * srgb_from_linear(min(radiance, 1.0)), atol=1.5)


def test_face_turned_away_gets_no_sun(make_renderer, stage) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(90, stage.pose(-80, 35, 0.25))
    shades = []
    for azimuth_deg in (-90, 90):
        renderer.render(
            Scene(tracked, stage.placed(box((SIDE, SIDE, SIDE))), Illumination((stage.light(azimuth_deg, 40),)))
        )
        shades.append(np.median(_face(renderer.read_bgr(), tracked, FRONT)))
    assert shades[0] > shades[1] + 50


def _leaning_wall(leaning_deg: float) -> Mesh:
    """FRONT alone, with normals that lean to the right by that."""
    leaning = math.radians(leaning_deg)
    normals = np.tile(np.float32((math.sin(leaning), -math.cos(leaning), 0)), (4, 1))
    return Mesh(np.float32(FRONT), normals, np.array([(0, 1, 2), (0, 2, 3)]), material=Material(roughness=1.0))


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_a_normal_that_leans_towards_the_sun_lights_no_triangle_that_is_turned_away(
    make_renderer, stage, quality
) -> None:
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(90, stage.pose(-90, 35, 0.25))
    light = Illumination((stage.light(15, 40, (0.5, 0.5, 0.5)),))  # from the right, and 15 degrees from behind the wall
    shades = []
    for leaning_deg in (-60, 60):
        renderer.render(Scene(tracked, stage.placed(_leaning_wall(leaning_deg)), light))
        shades.append(np.median(linear_from_srgb(_face(renderer.read_bgr(), tracked, FRONT) / 255)))
    assert shades[1] == pytest.approx(shades[0], rel=0.1)  # the ground to both sides differs by the wall's shadow


def _round(rows: int, columns: int) -> Mesh:
    """A ball of so many triangles, with the normals of a ball."""
    polar, around = np.meshgrid(np.linspace(0, math.pi, rows + 1), np.linspace(0, math.tau, columns + 1), indexing="ij")
    normals = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], -1)
    row, column = np.mgrid[:rows, :columns].reshape(2, -1)
    a = row * (columns + 1) + column
    below = a + columns + 1
    triangles = np.concatenate([np.stack([a, below, below + 1], 1), np.stack([a, below + 1, a + 1], 1)])
    normals = normals.reshape(-1, 3).astype(np.float32)
    grey = Material(base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0)
    return Mesh(normals * 0.03 + np.float32((0, 0, 0.03)), normals, triangles, material=grey)


@pytest.mark.parametrize("quality", list(QUALITIES))
def test_light_ends_on_a_ball_of_few_triangles_as_on_a_round_one(make_renderer, stage, quality: str) -> None:
    """And not on the edges of its triangles."""
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(90, stage.pose(-90, 30, 0.25))
    light = Illumination((stage.light(0, 30, (0.2, 0.2, 0.2)),))
    balls = []
    for rows, columns in ((10, 20), (80, 160)):
        renderer.render(Scene(tracked, stage.placed(_round(rows, columns)), light))
        balls.append(linear_from_srgb(renderer.read_bgr()[..., 1] / 255))
    (x, y), (edge, _) = project(tracked.camera, tracked.marker.T_cam_marker, [(0, 0, 0.03), (0.03, 0, 0.03)])
    columns_px, rows_px = np.meshgrid(np.arange(balls[0].shape[1]), np.arange(balls[0].shape[0]))
    inside = np.hypot(columns_px - x, rows_px - y) < 0.85 * (edge - x)
    assert np.percentile(np.abs(balls[0] - balls[1])[inside], 99.5) < MOST_FACETED * balls[1][inside].max()


def test_from_all_around_a_leaning_normal_gets_what_both_it_and_its_triangle_see(make_renderer, stage) -> None:
    """Of light from everywhere a half and half the cosine between them."""
    renderer = make_renderer()
    tracked = stage.tracked(90, stage.pose(-90, 35, 0.25))
    shades = []
    for leaning_deg in (0, 60):
        renderer.render(Scene(tracked, stage.placed(_leaning_wall(leaning_deg))))
        shades.append(np.median(linear_from_srgb(_face(renderer.read_bgr(), tracked, FRONT) / 255)))
    assert shades[1] / shades[0] == pytest.approx(0.75, abs=0.02)


def test_model_shadows_itself(make_renderer, stage) -> None:
    """A roof over a floor: the floor under it is as dark as what is left of the sky alone makes it."""
    # So dark that they throw next to nothing onto each other.
    dark = Material(base_colour=(0.1, 0.1, 0.1, 1.0), roughness=1.0)
    floor = replace(box((0.08, 0.08, 0.005)), material=dark)
    roof = replace(box((0.04, 0.08, 0.004)).moved(1.0, np.array([-0.02, 0, 0.05])), material=dark)
    tracked = stage.tracked(90, stage.pose(-90, 70, 0.3))
    light = stage.light(180, 60, (0.3, 0.3, 0.3))  # the roof's shadow falls 0.026 towards +x
    picture = stage.picture(make_renderer(), Scene(tracked, stage.placed(floor, roof), Illumination((light,))))
    shaded, lit = (
        linear_from_srgb(stage.rgb_at(picture, tracked, place) / 255) / (0.1 * EXPOSURE)
        for place in ((0.012, -0.01, 0.005), (0.034, -0.01, 0.005))
    )
    # The roof hides less than half of the sky beside it.
    assert 0.15 < shaded.min() <= shaded.max() < 0.29
    np.testing.assert_allclose(lit, 1.0, atol=0.06)


def _sheet(material: Material) -> Mesh:
    corners = np.float32([(-0.03, -0.03, 0.01), (0.03, -0.03, 0.01), (0.03, 0.03, 0.01), (-0.03, 0.03, 0.01)])
    normals = np.tile(np.float32((0, 0, 1)), (4, 1))
    uvs = np.float32([(0, 0), (1, 0), (1, 1), (0, 1)])
    return Mesh(corners, normals, np.array([(0, 1, 2), (0, 2, 3)]), uvs=uvs, material=material)


def test_texture_lies_as_its_coordinates_say_and_is_decoded_once(make_renderer, stage) -> None:
    texels = np.full((2, 2, 4), 255, dtype=np.uint8)
    texels[0, 0, :3] = (255, 0, 0)  # top left red
    texels[0, 1, :3] = (0, 255, 0)  # top right green
    texels[1, 0, :3] = (0, 0, 255)  # bottom left blue
    texels[1, 1, :3] = (188, 188, 188)  # bottom right: half of white in linear light
    texels = texels.repeat(8, axis=0).repeat(8, axis=1)
    tracked = stage.tracked(20, stage.pose(-90, 60, 0.25))
    picture = stage.picture(make_renderer(), Scene(tracked, stage.placed(_sheet(Material(base_map=texels)))))
    full = 255 * float(srgb_from_linear(EXPOSURE))
    half = 255 * float(srgb_from_linear(EXPOSURE * 0.5))
    for x, y, rgb in (
        (-0.015, 0.015, (full, 0, 0)),
        (0.015, 0.015, (0, full, 0)),
        (-0.015, -0.015, (0, 0, full)),
        (0.015, -0.015, (half, half, half)),
    ):
        np.testing.assert_allclose(stage.rgb_at(picture, tracked, (x, y, 0.01)), rgb, atol=2)


def test_transparent_texels_show_the_video(make_renderer, stage) -> None:
    texels = np.zeros((2, 2, 4), dtype=np.uint8)
    tracked = stage.tracked(20, stage.pose(-90, 60, 0.25, target=(0, 0, 0.01)))
    renderer = make_renderer()
    renderer.render(Scene(tracked, stage.placed(_sheet(Material(base_map=texels, alpha=Alpha.CUT_OUT)))))
    assert renderer.read_bgr().max() <= 20


def test_back_of_a_double_sided_sheet_is_seen_and_of_a_single_sided_one_not(make_renderer, stage) -> None:
    tracked = stage.tracked(20, stage.pose(-90, -60, 0.25))
    renderer = make_renderer()
    for double_sided in (True, False):
        renderer.render(Scene(tracked, stage.placed(_sheet(Material(double_sided=double_sided)))))
        assert (renderer.read_bgr().max() > 60) == double_sided


BACK_LIT = np.array([(0.0, 0.0, 0.0), (-0.1, -0.15, -0.2)])  # more light from -y, red the least


def test_a_sky_that_leans_lights_the_faces_that_it_leans_to(make_renderer, stage) -> None:
    renderer = make_renderer()
    tracked = stage.tracked(90, stage.pose(-80, 35, 0.25))
    light = stage.light(90, 40, (0.5, 0.5, 0.5))  # behind the front face
    seen = {}
    for name, slope in (("even", None), ("brighter", BACK_LIT), ("darker", -BACK_LIT)):
        illumination = Illumination((light,), sky_slope_rgb=slope)
        picture = stage.picture(renderer, Scene(tracked, stage.placed(box((SIDE, SIDE, SIDE))), illumination))
        faces = (np.median(_face(picture, tracked, corners), axis=0)[::-1] for corners in (FRONT, TOP))
        seen[name] = [linear_from_srgb(face / 255) / EXPOSURE for face in faces]
    (front, top), (brighter, top_then), (darker, _) = seen.values()
    np.testing.assert_allclose(brighter - front, -BACK_LIT[1], atol=0.012)
    np.testing.assert_allclose(darker - front, BACK_LIT[1], atol=0.012)
    # Level ground and what faces up get as much as before.
    np.testing.assert_allclose(top_then, top, atol=0.012)


def test_wall_is_lit_by_the_ground_before_it_as_the_picture_shows_it(make_renderer, stage) -> None:
    """A pale sheet under the model and a dark one: half of what is near the foot comes from there."""
    pose = stage.pose(-90, 35, 0.3)
    shades = []
    for sheet in (20, 240):
        image = np.full((360, 480, 3), 120, np.uint8)
        tracked = stage.tracked(image, pose)
        outline = project(
            tracked.camera, pose, [(x, y, 0) for x, y in ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))]
        )
        cv2.fillConvexPoly(image, np.round(outline).astype(np.int32), (sheet,) * 3)
        tracked = stage.tracked(image, pose)
        lit = Illumination(seen_in=tracked, ground_rgb=np.full(3, float(linear_from_srgb(120 / 255))))
        renderer = make_renderer()
        renderer.render(Scene(tracked, stage.placed(box((SIDE, SIDE, SIDE))), lit))
        shades.append(linear_from_srgb(np.median(_face(renderer.read_bgr(), tracked, FRONT)) / 255) / EXPOSURE)
    dark, pale = (float(linear_from_srgb(each / 255)) / EXPOSURE for each in (20, 240))
    # Two thirds of the ground's half, and that from within a few heights of a face.
    assert 0.6 * (pale - dark) / 3 < shades[1] - shades[0] < 1.05 * (pale - dark) / 3


def _exposed(stage, white: float) -> TrackedFrame:
    """Ground with a printed sheet on it, in which white has this linear level."""
    linear, pose = np.full((360, 480, 3), 0.3 * white), stage.pose(-90, 35, 0.3)
    for half, albedo in ((0.055, PAPER_ALBEDO), (0.04, INK_RATIO * PAPER_ALBEDO)):
        square = half * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
        cv2.fillConvexPoly(
            linear, np.round(project(stage.camera(), pose, square)).astype(np.int32), (albedo * white,) * 3
        )
    return stage.tracked(np.round(srgb_from_linear(linear) * 255).astype(np.uint8), pose)


# Matt, which the ground lights from below, and polished, which mirrors it.
@pytest.mark.parametrize("material", [Material(), Material(metallic=1.0, roughness=0.2)])
def test_ground_that_it_gets_light_from_follows_the_exposure_since_it_was_seen(
    make_renderer, stage, material: Material
) -> None:
    frames = [_exposed(stage, white) for white in (0.9, 0.3)]
    lit = Illumination((stage.light(90, 50, (0.3,) * 3),), ground_rgb=np.full(3, 0.27), seen_in=frames[0])
    model = stage.placed(replace(box((SIDE / 2,) * 3), material=material))
    corners = [tuple(np.array(corner) / 2) for corner in FRONT]
    shades = []
    for tracked in frames:
        renderer = make_renderer()
        renderer.render(Scene(tracked, model, lit))
        shades.append(linear_from_srgb(np.median(_face(renderer.read_bgr(), tracked, corners)) / 255))
    assert shades[1] / shades[0] == pytest.approx(1 / 3, rel=0.05)


def test_it_does_not_matter_which_of_four_lights_comes_first(make_renderer, stage) -> None:
    """Four points of four numbers each are as many as a matrix has, and are not turned as one."""
    renderer = make_renderer()
    tracked = stage.tracked(150, stage.pose(-90, 45, 0.4))
    lights = [stage.light(azimuth, 40) for azimuth in (20, 110, 200, 290)]
    pictures = []
    for first in range(4):
        illumination = Illumination((*lights[first:], *lights[:first]))
        renderer.render(Scene(tracked, stage.placed(box((SIDE, SIDE, SIDE))), illumination))
        pictures.append(renderer.read_bgr().astype(int))
    for picture in pictures[1:]:
        assert np.abs(picture - pictures[0]).max() <= 2
