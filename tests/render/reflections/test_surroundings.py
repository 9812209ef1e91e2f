"""What polished surfaces mirror: the ground where it is, a sky of the measured strength."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, linear_from_srgb
from ashe_live.core.light import Illumination
from ashe_live.core.transforms import project
from ashe_live.render.lights.lighting import GROUND_ALBEDO
from ashe_live.render.reflections import environment
from ashe_live.render.reflections.surroundings import (
    HALF_RADIUS_SIDES,
    NOWHERE,
    blurred_levels,
    even_surroundings,
    level_count,
    surroundings_of,
)

SIZE = 64
SIDE_M = 0.08


def _texel(point: tuple[float, float]) -> tuple[int, int]:
    """Row and column of a point of the plane, metres."""
    share = 0.5 + 0.5 * np.array(point) / (np.hypot(*point) + HALF_RADIUS_SIDES * SIDE_M)
    column, row = (share * SIZE).astype(int)
    return row, column


def test_ground_is_where_the_picture_shows_it(stage) -> None:
    """A red left half and a blue right half of the view stay on their sides, seen from any azimuth."""
    for azimuth_deg in (-90, 20, 140):
        T_cam_marker = stage.pose(azimuth_deg, 50)
        image = np.zeros((360, 480, 3), np.uint8)
        image[:, :240, 2] = image[:, 240:, 0] = 255
        surroundings = surroundings_of(stage.tracked(image, T_cam_marker), SIZE)
        for point in ((0.03, 0.0), (-0.03, 0.0), (0.0, 0.03), (0.0, -0.03)):
            u = project(stage.camera(), T_cam_marker, [(*point, 0.0)])[0, 0]
            if abs(u - 239.5) < 20:
                continue
            red, _, blue = surroundings.ground[_texel(point)]
            assert (red > 0.9) == (u < 239.5)
            assert (blue > 0.9) == (u > 239.5)


def test_ground_beyond_the_picture_has_the_given_colour_or_its_mean(stage) -> None:
    tracked = stage.tracked(128, stage.pose(-90, 60))
    given = np.array([0.3, 0.2, 0.1])
    for aside in ((5.0, 5.0), (1.0, 0.0)):
        np.testing.assert_allclose(surroundings_of(tracked, SIZE, given).ground[_texel(aside)], given, atol=1e-5)
    mean = surroundings_of(tracked, SIZE).ground
    np.testing.assert_allclose(mean, float(linear_from_srgb(128 / 255)), atol=1e-5)


def test_a_pattern_too_fine_to_be_seen_throws_its_mean_light(stage) -> None:
    image = np.zeros((720, 1280, 3), np.uint8)
    image[:, ::2] = 255
    tracked = stage.tracked(image, stage.pose(-90, 60))
    np.testing.assert_allclose(surroundings_of(tracked, SIZE).ground, 0.5, atol=0.01)


def test_sky_lights_level_ground_as_measured(stage) -> None:
    """Its cosine-weighted mean over the hemisphere is one, whatever the picture."""
    sky = surroundings_of(stage.tracked(stage.noise(), stage.pose(10, 40)), SIZE).sky
    random = np.random.default_rng(3)
    x, y = (random.uniform(-1, 1, 200_000) for _ in range(2))
    x, y = x[x**2 + y**2 < 1], y[x**2 + y**2 < 1]  # by Malley's method: cosine-weighted directions
    z = np.sqrt(1 - x**2 - y**2)
    rows, columns = (((0.5 + 0.5 * value / (1 + z)) * SIZE).astype(int) for value in (y, x))
    np.testing.assert_allclose(sky[rows, columns].mean(axis=0), 1.0, atol=0.01)
    assert (sky > 0).all()


def test_the_sky_has_the_colours_of_the_sides_of_the_picture_and_behind_the_camera_those_of_its_middle(stage) -> None:
    image = np.zeros((360, 480, 3), np.uint8)
    image[:, :240, 2] = image[:180, :, 1] = 255  # red on the left, green above
    image[90:270, 120:360, 0] = 255
    for azimuth_deg in (-90, 20, 140):
        T_cam_marker = stage.pose(azimuth_deg, 30)
        sky = surroundings_of(stage.tracked(image, T_cam_marker), SIZE).sky

        def colour(right: float, down: float, forward: float, R=T_cam_marker[:3, :3], sky=sky) -> np.ndarray:
            """(3,) RGB relative to their mean, from a direction of the camera."""
            x, y, z = np.array((right, down, forward)) @ R / np.linalg.norm((right, down, forward))
            column, row = ((0.5 + 0.5 * np.array((x, y)) / (1 + z)) * SIZE).astype(int)
            return sky[row, column] / sky[row, column].sum()

        left, right, above = colour(-1, -0.2, -0.2), colour(1, -0.2, -0.2), colour(0, -1, -0.2)
        behind_below = colour(0, 0.4, -1)
        assert left[0] > 1.5 * right[0]
        assert above[1] > 1.5 * behind_below[1]
        assert colour(0, 0, -1)[2] > 1.5 * max(left[2], right[2], above[2])


def test_an_overcast_sky_is_three_times_as_bright_in_the_zenith_as_at_the_horizon() -> None:
    """The CIE's; light comes through its rim's texels from up to 3 degrees above the horizon."""
    sky = even_surroundings(SIZE, np.ones(3)).sky[..., 0]
    assert sky[SIZE // 2, SIZE // 2] / sky[SIZE // 2, 0] == pytest.approx(3, rel=0.05)


def test_each_level_is_half_of_the_one_before() -> None:
    levels = blurred_levels(np.ones((64, 64, 3), np.float32))
    assert [level.shape[0] for level in levels] == [64, 32, 16, 8, 4]
    assert len(levels) == level_count(64)
    assert all(np.allclose(level, 1.0) for level in levels)


def test_without_a_marker_there_is_no_ground(stage) -> None:
    with pytest.raises(ValueError, match="marker"):
        surroundings_of(stage.tracked(90, None), SIZE)


def test_covered_ground_has_the_colour_of_what_lies_around_it(stage) -> None:
    given = np.array([0.3, 0.2, 0.1])
    sheet = np.array([(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)])
    ground = surroundings_of(stage.tracked(220, stage.pose(-90, 60)), SIZE, given, sheet).ground
    np.testing.assert_allclose(ground[_texel((0.0, 0.0))], given, atol=1e-5)
    np.testing.assert_allclose(ground[_texel((0.08, 0.0))], float(linear_from_srgb(220 / 255)), atol=1e-4)


def test_while_the_marker_is_moved_the_maps_wait_until_it_rests(ctx, stage, monkeypatch) -> None:
    """To fill them takes as long as to draw a picture."""
    filled = []

    def counted(tracked, *asked):
        filled.append(tracked)
        return surroundings_of(tracked, *asked)

    monkeypatch.setattr(environment, "surroundings_of", counted)
    seen = stage.tracked(stage.noise(), stage.pose(10, 40))
    moved = [replace(seen, marker=replace(seen.marker, T_cam_marker=stage.pose(10 + k, 40))) for k in range(5)]
    maps = environment.Environment(ctx, SIZE)
    for each in (seen, seen, *moved, moved[-1], moved[-1]):
        maps.show(Illumination(seen_in=each), (1.0, 1.0, 1.0), np.zeros((0, 2)))
    assert [id(each) for each in filled] == [id(seen), id(moved[-1])]
    maps.release()


def test_another_picture_and_the_ground_over_a_covered_sheet_are_mirrored_at_once(ctx, stage) -> None:
    maps, given = environment.Environment(ctx, SIZE), np.array([0.3, 0.2, 0.1])
    sheet = np.array([(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)])
    bright, dark = (
        Illumination(seen_in=stage.tracked(grey, stage.pose(-90, 60)), ground_rgb=given) for grey in (220, 60)
    )
    for lit, covered in ((bright, NOWHERE), (bright, sheet), (bright, NOWHERE), (dark, NOWHERE)):
        maps.show(lit, (1.0, 1.0, 1.0), covered)
        shown = LINEAR_FROM_SRGB_8BIT[lit.seen_in.frame.image_bgr[0, 0]]
        expected = given if covered is sheet else shown
        np.testing.assert_allclose(_mirrored_ground(maps)[_texel((0.0, 0.0))], expected, rtol=2e-3)
    maps.release()


def test_ground_that_nobody_saw_is_as_bright_as_the_video(ctx, monkeypatch) -> None:
    bound: dict = {}
    monkeypatch.setattr(environment, "set_uniforms", lambda _, **uniforms: bound.update(uniforms))
    maps, given = environment.Environment(ctx, SIZE), np.array([0.3, 0.2, 0.1])
    for white in (np.array([1.0, 0.9, 0.8]), np.array([0.5, 0.5, 0.4])):
        maps.show(Illumination(), tuple(white), NOWHERE)
        np.testing.assert_allclose(_mirrored_ground(maps), np.full((SIZE, SIZE, 3), GROUND_ALBEDO * white), rtol=2e-3)
        maps.bind(None)
        assert bound["ground_white"] == tuple(white)
    maps.show(Illumination(ground_rgb=given), (1.0, 1.0, 1.0), NOWHERE)
    np.testing.assert_allclose(_mirrored_ground(maps), np.full((SIZE, SIZE, 3), given), rtol=2e-3)
    maps.release()


def test_by_another_light_the_ground_is_the_same_picture_of_another_white(ctx, stage, monkeypatch) -> None:
    bound: dict = {}
    monkeypatch.setattr(environment, "set_uniforms", lambda _, **uniforms: bound.update(uniforms))
    maps, seen = environment.Environment(ctx, SIZE), stage.tracked(220, stage.pose(-90, 60))
    for white in (0.8, 1.2):
        maps.show(Illumination(seen_in=seen), (white, white, white), NOWHERE)
        maps.bind(None)
        assert bound["ground_white"] == (white, white, white)
    maps.release()


def _mirrored_ground(maps: environment.Environment) -> np.ndarray:
    return np.frombuffer(maps._ground.read(), np.float16).reshape(SIZE, SIZE, 4)[..., :3]
