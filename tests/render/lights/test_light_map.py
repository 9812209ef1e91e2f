"""The sky as a picture: it gives the ground the light that it was made from, from where it comes."""

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import direction_from_angles
from ashe_live.errors import UserError
from ashe_live.render.lights.light_map import light_map, write_light_map
from ashe_live.render.lights.lighting import lighting_of

RATIO = np.array((0.3, 0.4, 0.5))


def directions(height_px: int) -> tuple[np.ndarray, np.ndarray]:
    """(h, 2h, 3) of texels and (h, 2h) their solid angles, by Blender's own definition.

    u = 0.5 - atan2(y, x) / 2 pi and v = 0.5 + elevation / pi, from the bottom left (Cycles, camera/projection.h).
    """
    v, u = np.mgrid[0.5:height_px, 0.5 : 2 * height_px]
    azimuth, elevation = 2 * math.pi * (0.5 - u / (2 * height_px)), math.pi * (0.5 - v / height_px)
    x, y, z = np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)
    return np.stack([x, y, z], -1), np.cos(elevation) * (math.pi / height_px) ** 2


def level_over_pi(radiance: np.ndarray) -> np.ndarray:
    """(3,) irradiance on level ground over pi."""
    towards, solid = directions(radiance.shape[0])
    return (radiance * (np.clip(towards[..., 2], 0, None) * solid)[..., None]).sum(axis=(0, 1)) / math.pi


@pytest.mark.parametrize("size_deg", [0.02, 0.53, 5.0, 30.0])
@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(30, 45), (-100, 20), (170, 70)])
def test_it_gives_level_ground_the_light_that_it_was_made_from(size_deg, azimuth_deg, elevation_deg) -> None:
    towards = direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))
    light = Light(towards, angular_size_rad=math.radians(size_deg), shadow_rgb_ratio=RATIO)
    radiance = light_map(Illumination((light,)))
    np.testing.assert_allclose(level_over_pi(radiance), 1.0, rtol=0.03)
    # Without the disc there is the shadow's share, and no more.
    (sun,) = lighting_of((light,)).lights
    around, solid = directions(radiance.shape[0])
    disc = around @ towards > math.cos(math.radians(size_deg / 2 + 1))
    np.testing.assert_allclose(level_over_pi(np.where(disc[..., None], 0, radiance)), RATIO, atol=0.06)
    centre = (around * (radiance.sum(axis=-1) * solid * disc)[..., None]).sum(axis=(0, 1))
    assert math.degrees(math.acos(min(1.0, centre @ towards / np.linalg.norm(centre)))) < 0.5
    assert sun.angular_size_rad == pytest.approx(math.radians(size_deg))


@pytest.mark.parametrize("distance_m", [0.3, 2.0])
def test_a_lamp_is_as_large_as_it_is_seen_from_the_marker(distance_m: float) -> None:
    """And gives level ground at the marker's centre what it does in the picture."""
    towards = direction_from_angles(0.5, 0.8)
    lamp = Light(towards, shadow_rgb_ratio=RATIO, inverse_distance=1 / distance_m, radius_m=0.03)
    radiance = light_map(Illumination((lamp,)))
    np.testing.assert_allclose(level_over_pi(radiance), 1.0, rtol=0.03)
    around, solid = directions(radiance.shape[0])
    disc = radiance[..., 0] > 2 * RATIO[0]
    half = math.atan(0.03 / distance_m)
    assert np.degrees(np.arccos(np.clip(around[disc] @ towards, -1, 1))).max() < math.degrees(half) + 0.4
    assert solid[disc].sum() == pytest.approx(2 * math.pi * (1 - math.cos(half)), rel=0.2)


@pytest.mark.parametrize("lean", [(0.0, 0.0), (0.2, 0.0), (-0.1, 0.25)])
def test_walls_get_as_much_of_a_sky_that_leans_as_the_models_sides_do(lean: tuple[float, float]) -> None:
    """An upright wall gets half of an even sky, and what the slope gives to its normal; level ground gets no more."""
    slope = np.outer(lean, (1.0, 0.8, 0.6))
    radiance = light_map(Illumination((), sky_slope_rgb=slope))
    towards, solid = directions(radiance.shape[0])
    for normal in ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)):
        facing = np.clip(towards @ normal, 0, None) * solid
        on_wall = (radiance * facing[..., None]).sum(axis=(0, 1)) / math.pi
        np.testing.assert_allclose(on_wall, 0.5 + np.array(normal[:2]) @ slope, atol=0.01)
    np.testing.assert_allclose(level_over_pi(radiance), 1.0, rtol=0.01)


def test_the_steepest_sky_is_nowhere_black_beyond_black() -> None:
    radiance = light_map(Illumination((), sky_slope_rgb=np.full((2, 3), 3.0)))
    assert radiance.min() >= 0
    np.testing.assert_allclose(level_over_pi(radiance), 1.0, rtol=0.01)


def test_without_a_light_the_sky_gives_all() -> None:
    radiance = light_map(Illumination())
    np.testing.assert_allclose(level_over_pi(radiance), 1.0, rtol=0.01)
    assert not radiance[radiance.shape[0] // 2 :].any()  # the ground is another program's


def test_it_is_written_as_others_read_it(tmp_path: Path) -> None:
    light = Light((1.0, 1.0, 1.0), shadow_rgb_ratio=RATIO)
    path = write_light_map(tmp_path / "sky.hdr", Illumination((light,)))
    read = cv2.imread(str(path), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR)[..., ::-1]
    assert path.read_bytes().startswith(b"#?RADIANCE")
    np.testing.assert_allclose(read, light_map(Illumination((light,))), rtol=0.02, atol=0.01)
    with pytest.raises(UserError, match="exists"):
        write_light_map(path, Illumination())
    with pytest.raises(ValueError, match=r"name it \.hdr"):
        write_light_map(tmp_path / "sky.exr", Illumination((light,)))
    assert list(tmp_path.iterdir()) == [path]
