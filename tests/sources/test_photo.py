"""A camera that develops radiance: light stays in order, noise is as stated, truth lies where it is projected."""

from functools import partial
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes.compare import masks_differ, numbers_differ, pictures_differ
from scenes.develop import mixed
from scenes.drawing.families import CAMERAS
from scenes.geometry import surroundings
from scenes.geometry.index import GROUND
from scenes.geometry.parts import box
from scenes.geometry.poses import cast, direction, intrinsics, look_at, projected
from scenes.photo.camera import camera_settings, finished, photographed, sensed, streak, through_lens, toned
from scenes.photo.masks import mask_of_triangles, masks
from scenes.photo.renditions import renditions
from scenes.photo.truth import corners_m, light_entry, scene_entry, still_entry
from scenes.specify import specification

from ashe_live.core.colour import REC709_LUMINANCE, srgb_from_linear

WHITE = np.ones(3)
QUIET = {"shot_noise": 0.0, "read_noise": 0.0, "row_noise": 0.0}


def ramp(width: int = 256, height: int = 60) -> NDArray[np.float32]:
    return np.repeat(np.linspace(0, 1, width, dtype=np.float32)[None, :, None], height, 0).repeat(3, 2)


@pytest.mark.parametrize("family", CAMERAS)
@pytest.mark.parametrize("seed", range(4))
def test_more_light_is_never_darker_but_for_local_tone_mapping(family: str, seed: int) -> None:
    settings = camera_settings(np.random.default_rng(seed), family) | {"local_tone": 0.0}
    grey = toned(ramp(), settings)[30, :, 1]
    assert (np.diff(grey) >= -1e-6).all()
    assert grey[0] == pytest.approx(0, abs=1e-3)
    assert grey[-1] > 0.85


def test_local_tone_mapping_brightens_dark_regions_and_keeps_edges() -> None:
    settings = camera_settings(np.random.default_rng(0), "phone_hdr")
    scene = np.full((120, 160, 3), 0.03, np.float32)
    scene[:, 80:] = 0.5
    flat = toned(scene, settings | {"local_tone": 0.0})
    mapped = toned(scene, settings)
    assert mapped[60, 10, 1] > 1.1 * flat[60, 10, 1]
    assert mapped[60, 82, 1] > 2 * mapped[60, 77, 1]


@pytest.mark.parametrize("level", [0.05, 0.3, 0.7])
def test_noise_is_as_strong_as_stated(level: float) -> None:
    settings = {"shot_noise": 3e-4, "read_noise": 0.002, "row_noise": 0.003}
    signal = np.full((300, 400, 3), level, np.float32)
    noisy = sensed(signal, settings, np.random.default_rng(1))
    rows = noisy.mean(axis=(1, 2))
    assert rows.std() == pytest.approx(0.003, rel=0.2)
    within = (noisy - noisy.mean(axis=(1, 2), keepdims=True)).std()
    assert within == pytest.approx(np.sqrt(0.002**2 + 3e-4 * level), rel=0.05)


def test_the_lens_keeps_the_amount_of_light_in_the_middle() -> None:
    scene = np.zeros((90, 120, 3), np.float32)
    scene[40:50, 55:65] = 1.0
    settings = {"glare": 0.0, "blur_px": 1.0, "motion_px": 2.0, "motion_deg": 30.0, "vignetting": 0.0}
    assert through_lens(scene, settings).sum() == pytest.approx(scene.sum(), rel=1e-3)
    assert streak(2.0, 30.0).sum() == pytest.approx(1)


def test_veiling_glare_lifts_black_and_vignetting_darkens_corners() -> None:
    settings = {"glare": 0.05, "blur_px": 0.5, "motion_px": 0.0, "motion_deg": 0.0, "vignetting": 0.3}
    scene = np.ones((90, 120, 3), np.float32)
    scene[30:60, 40:80] = 0.0
    seen = through_lens(scene, settings)
    assert seen[45, 60, 1] > 0.02
    assert seen[0, 0, 1] == pytest.approx(0.7, abs=0.02)


def test_sharpening_leaves_halos_on_both_sides_of_an_edge() -> None:
    settings = camera_settings(np.random.default_rng(3), "phone") | {"sharpening": 1.0}
    edge = np.full((40, 60, 3), 0.3, np.float32)
    edge[:, 30:] = 0.6
    seen = finished(cv2.GaussianBlur(edge, (0, 0), 1.0), settings)[20, :, 1]
    assert seen.max() > 0.6 + 0.01
    assert seen.min() < 0.3 - 0.01


def test_white_balance_takes_the_lights_colour_away_as_far_as_it_adapts() -> None:
    lamp = np.array([1.0, 0.8, 0.5])
    grey = np.ones((40, 60, 3), np.float32) * (0.4 * lamp)
    settings = camera_settings(np.random.default_rng(2), "plain") | QUIET | {"white_balance": [1.0, 1.0, 1.0]}
    full = photographed(grey, lamp, settings | {"adaptation": 1.0})[0][20, 30].astype(int)
    none = photographed(grey, lamp, settings | {"adaptation": 0.0})[0][20, 30].astype(int)
    assert np.ptp(full) <= 2
    assert none[2] > none[0] + 20  # BGR: still warm


@pytest.mark.parametrize("family", CAMERAS)
def test_a_picture_is_well_exposed_and_the_same_from_the_same_seed(family: str) -> None:
    scene = np.random.default_rng(0).uniform(0.1, 3.0, (60, 80, 3)).astype(np.float32)
    settings = camera_settings(np.random.default_rng(5), family)
    one, gains = photographed(scene, WHITE, settings)
    assert np.array_equal(one, photographed(scene, WHITE, settings)[0])
    assert 40 < one.mean() < 220
    assert np.array_equal(one, photographed(scene, WHITE, settings, gains)[0])


@pytest.mark.parametrize("family", surroundings.BUILDERS)
def test_surroundings_give_the_open_ground_one_unit_of_light(family: str) -> None:
    for seed in range(3):
        spec = {"family": family, "azimuth_deg": 70.0 * seed, "lopsided": 0.4 * seed, "warmth": 0.3, "seed": seed}
        light = surroundings.radiance(spec)
        assert light.min() >= 0
        assert surroundings.irradiance(light) @ REC709_LUMINANCE == pytest.approx(1)
        assert surroundings.mean_direction(light)[2] > 0.3


def test_an_even_sky_lights_the_ground_by_pi_times_its_radiance() -> None:
    even = np.ones((surroundings.ROWS, surroundings.COLUMNS, 3))
    np.testing.assert_allclose(surroundings.irradiance(even), np.pi, rtol=1e-3)
    np.testing.assert_allclose(surroundings.mean_direction(even), [0, 0, 1], atol=1e-2)


def camera_above() -> dict[str, Any]:
    R, t = look_at([0, 0, 0], -90.0, 50.0, 0.5, 0.0)
    return {"K": intrinsics([320, 240], 60.0), "R": R, "t": t}


def test_the_mask_of_a_triangle_has_its_area_also_where_it_leaves_the_camera_behind() -> None:
    camera = camera_above()
    points = np.array([(-0.1, -0.05, 0.0), (0.1, -0.05, 0.0), (0.0, 0.12, 0.0)])
    mask = mask_of_triangles(camera, [320, 240], points, np.array([(0, 1, 2)]))
    area = cv2.contourArea(np.float32(projected(camera, points)[0]))
    assert mask.sum() == pytest.approx(area, rel=0.06)
    behind = np.array([(-3.0, -6.0, 0.0), (3.0, -6.0, 0.0), (0.0, 0.05, 0.0)])
    mask = mask_of_triangles(camera, [320, 240], behind, np.array([(0, 1, 2)]))
    rays = np.linalg.inv(camera["K"]) @ np.array([160, 235, 1.0])  # the ground just before the camera
    at = camera["R"].T @ (rays * (camera["R"].T @ camera["t"])[2] / (camera["R"].T @ rays)[2] - camera["t"])
    assert at[2] == pytest.approx(0, abs=1e-9)
    assert at[1] < 0.05
    assert mask[235, 160]
    assert not mask[5, 160]


def test_triangles_that_end_at_the_camera_leave_no_trace_and_do_no_harm() -> None:
    camera = camera_above()
    eye = -camera["R"].T @ camera["t"]
    forward, right = camera["R"][2], camera["R"][0]
    for reach in (0.0, 0.02, 0.039, 0.041, 0.0405):
        triangle = np.array([eye - forward, eye + right - forward, eye + reach * forward])
        mask = mask_of_triangles(camera, [320, 240], triangle, np.array([(0, 1, 2)]))
        assert mask.mean() < 0.6


def test_masks_of_a_cube_by_rays() -> None:
    """Against a ray cast through every tenth pixel: ground whose ray to the light meets the cube is shadow."""
    spec = specification("training", 2)
    spec |= {"size": [320, 240], "camera": camera_above(), "patches": []}
    spec["ground"]["z_m"] = 0.0
    spec["objects"] = [{"role": "caster", "family": "carton", "xy_m": [0.0, 0.0]}]
    spec["lights"] = [{"azimuth_deg": 130.0, "elevation_deg": 40.0}]
    low, high = np.array([-0.03, -0.02, 0.0]), np.array([0.03, 0.02, 0.05])
    cube = box((0.06, 0.04, 0.05))
    index = np.full((240, 320), GROUND, np.uint8)
    found = masks(spec, [0], {"index": index, "points0": cube.points, "faces0": cube.faces})["shadow"]
    towards = direction(130.0, 40.0)
    camera = spec["camera"]
    wrong = 0
    for v in range(5, 240, 10):
        for u in range(5, 320, 10):
            ray = camera["R"].T @ (np.linalg.inv(camera["K"]) @ [u, v, 1.0])
            eye = -camera["R"].T @ camera["t"]
            at = eye - eye[2] / ray[2] * ray
            with np.errstate(divide="ignore"):
                enter = np.minimum((low - at) / towards, (high - at) / towards).max()
                leave = np.maximum((low - at) / towards, (high - at) / towards).min()
            wrong += found[v, u] != (leave > max(enter, 0))
    assert found.sum() > 500
    assert wrong <= 4  # pixels on the border


def test_truth_of_a_still_puts_corners_and_tips_where_they_are_seen() -> None:
    spec = specification("training", 5)
    picture = next(each for each in spec["pictures"] if each["lights"])
    points = [np.array([(0.1, 0.1, 0.0), (0.12, 0.1, 0.0), (0.11, 0.12, 0.07)]) for _ in spec["objects"]]
    raw: dict[str, Any] = {f"points{k}": each for k, each in enumerate(points)}
    entry = still_entry(spec, picture, raw, {}, [1.0, 1.0, 1.0])
    flat = spec["marker"] | {"curl_m": 0.0}
    np.testing.assert_allclose(corners_m(flat)[0], np.array([-1, 1, 0]) * flat["side_m"] / 2)
    camera = np.array(entry["R"]) @ corners_m(spec["marker"]).T + np.array(entry["t"])[:, None]
    pixels = (np.array(entry["K"]) @ camera)[:2] / camera[2]
    np.testing.assert_allclose(entry["marker"]["corners_px"], pixels.T, atol=1e-3)
    light, first = entry["lights"][0], spec["lights"][picture["lights"][0]]
    assert light["elevation_deg"] == pytest.approx(first["elevation_deg"], abs=1e-3)
    tip = cast(points[0], first, spec["ground"]["z_m"])
    assert any(np.allclose(entry["caster"]["shadow_tip_m"][0], each, atol=1e-5) for each in tip)
    lit = np.array(light["irradiance_ground"]) + entry["ambient"]["irradiance_ground"]
    if len(picture["lights"]) == 1:
        np.testing.assert_allclose(
            entry["shading_ratio"]["all_blocked"], entry["ambient"]["irradiance_ground"] / lit, atol=1e-3
        )


def test_comparison_allows_noise_and_finds_what_moved() -> None:
    rng = np.random.default_rng(0)
    one = rng.integers(0, 255, (60, 80, 3)).astype(np.uint8)
    assert not pictures_differ(one, one)
    assert not pictures_differ(one, np.clip(one.astype(int) + rng.integers(-2, 3, one.shape), 0, 255).astype(np.uint8))
    assert pictures_differ(one, np.roll(one, 2, axis=1))
    assert pictures_differ(one, one[:, :-1])
    mask = np.zeros((60, 80), np.uint8)
    mask[20:40, 20:40] = 255
    assert not masks_differ(mask, mask)
    assert masks_differ(mask, np.roll(mask, 2, axis=1))
    assert not numbers_differ({"a": [1.0, 2.0]}, {"a": [1.0005, 2.0]})
    assert numbers_differ({"a": [1.0, 2.0]}, {"a": [1.1, 2.0]}) == [".a[0]: 1.0 and 1.1"]
    assert numbers_differ({"a": 1}, {"b": 1})
    assert numbers_differ({"a": "cup"}, {"a": "mug"})


def test_renditions_differ_from_the_photo_in_what_they_are_called() -> None:
    settings = camera_settings(np.random.default_rng(3), "phone") | QUIET | {"blur_px": 0.3, "motion_px": 0.0}
    bare = np.full((60, 256, 3), 0.2, np.float32)
    light, gains = {"bare": bare, "model": 0.1 + 0.8 * ramp()}, [1.0, 1.0, 1.0]
    found = {name: picture.astype(float) for name, picture, _ in renditions(light, WHITE, settings, gains)}
    exact = np.round(255 * srgb_from_linear(light["model"]))
    inside = (slice(10, -10), slice(10, -10))
    assert np.abs(found["model_linear"] - exact)[inside].max() <= 1
    assert np.abs(found["bare_linear"] - np.round(255 * srgb_from_linear(bare))).max() <= 1
    assert np.abs(found["model_untoned"] - exact)[inside].mean() < np.abs(found["model_noise"] - exact)[inside].mean()
    for name, shift in (("model_moved_25", 0.25), ("model_moved_50", 0.5)):
        slope = np.gradient(found["model_noise"], axis=1)
        off = (found["model_noise"] - found[name])[inside].mean() / slope[inside].mean()
        assert off == pytest.approx(shift, abs=0.1)


def test_a_lamp_is_as_wide_as_the_marker_sees_it() -> None:
    spec = specification("near_training", 0)
    lamps = [light for light in spec["lights"] if light["kind"] == "lamp"]
    assert len(lamps) == 2
    for light in lamps:
        entry = light_entry(spec, light, 1.0)
        seen = np.tan(np.radians(entry["angular_diameter_deg"] / 2)) * np.linalg.norm(light["position_m"])
        assert seen == pytest.approx(light["radius_m"], rel=1e-3)


def test_lights_without_a_shadow_in_view_are_as_strong_as_they_shine_in_the_picture() -> None:
    spec = next(each for each in map(partial(specification, "training"), range(60)) if each["base"] == "misleading")
    picture = next(each for each in spec["pictures"] if each["unseen_lights"])
    objects = {f"points{number}": np.zeros((1, 3)) for number in range(len(spec["objects"]))}
    entry = scene_entry(spec, picture, objects)
    assert entry["lights"] == []
    shape = {"ambient": np.zeros((1, 1, 3), np.float32)}
    dark = shape | {f"light{number}": shape["ambient"] for number in range(3)}
    seen = np.array(entry["ambient"]["irradiance_ground"])
    seen += sum(np.array(each["irradiance_ground"]) for each in entry["unseen_lights"])
    np.testing.assert_allclose(mixed(spec, picture, dark)[1], seen, atol=1e-4)


def test_each_lights_shadow_of_the_main_object_is_told_from_those_of_others() -> None:
    spec = specification("training", 2) | {"size": [320, 240], "camera": camera_above(), "patches": []}
    spec["ground"]["z_m"] = 0.0
    spec["lights"] = [{"azimuth_deg": azimuth, "elevation_deg": 50.0} for azimuth in (80.0, 110.0)]
    spec["objects"] = [{"role": role, "family": "carton"} for role in ("caster", "clutter")]
    cube = box((0.03, 0.03, 0.04))
    raw = {"index": np.full((240, 320), GROUND, np.uint8)}
    for number, x in enumerate((-0.1, 0.1)):
        raw |= {f"points{number}": cube.points + np.array((x, 0, 0)), f"faces{number}": cube.faces}
    found = masks(spec, [0, 1], raw)
    for name in ("shadow", "shadow2"):
        own, every = found[f"{name}_caster"], found[name]
        assert own[:, :160].sum() == every[:, :160].sum() > 100
        assert every[:, 160:].sum() > 100
        assert not own[:, 160:].any()
