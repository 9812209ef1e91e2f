"""What the marker's paper mirrors of the light, and that it is no exposure."""

import math

import numpy as np
import pytest

from ashe_live.core.light import Light
from ashe_live.core.transforms import direction_from_angles
from ashe_live.render.camera.paper_gloss import MIRRORED, ROUGHNESS, mirrored_by_paper
from ashe_live.render.camera.white import INK_RATIO, PAPER_ALBEDO, light_on_print, white_of
from ashe_live.render.lights.lighting import LEAST_LAMP_DISTANCE, Lighting, ShadingLight, lighting_of
from tests.render.camera.test_video_look import _sheet

ORIGIN = np.zeros(3)
CAMERA = -80.0, 50.0  # azimuth and elevation of the painted sheet's camera
OPPOSITE, BEHIND = (100.0, 40.0), (-80.0, 45.0)  # of lights


def _direction(azimuth_deg: float, elevation_deg: float) -> np.ndarray:
    return direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))


def _sun(azimuth_deg: float, elevation_deg: float, inverse_distance: float = 0.0) -> ShadingLight:
    return ShadingLight(_direction(azimuth_deg, elevation_deg), (0.7,) * 3, (1.0,) * 3, 0.01, inverse_distance)


def _lighting(azimuth_deg: float, elevation_deg: float) -> Lighting:
    return lighting_of((Light(_direction(azimuth_deg, elevation_deg), shadow_rgb_ratio=np.full(3, 0.25)),))


def test_paper_mirrors_a_light_on_the_other_side_and_none_behind_the_camera() -> None:
    to_eye = _direction(*CAMERA)
    around = [
        float(mirrored_by_paper((_sun(CAMERA[0] + 180 + turn, 45),), to_eye, ORIGIN)[0]) for turn in range(0, 181, 30)
    ]
    assert around[0] > 0.01
    assert (np.diff(around) <= 0).all()
    assert around[-1] == 0


def test_paper_mirrors_as_much_with_eye_and_light_exchanged() -> None:
    """Helmholtz: of light that falls at one angle and is seen at another."""
    one, other = (100.0, 35.0), (-70.0, 55.0)
    there, back = (
        float(mirrored_by_paper((_sun(*light),), _direction(*eye), ORIGIN)[0]) / math.sin(math.radians(light[1]))
        for light, eye in ((one, other), (other, one))
    )
    assert there > 0
    assert there == pytest.approx(back)


@pytest.mark.parametrize("elevation_deg", [8.0, 15.0, 30.0, 89.9])
def test_the_lower_light_and_eye_the_more_is_mirrored_as_by_fresnels_equations(elevation_deg: float) -> None:
    """Opposite each other, where all facets that mirror are level; of a refractive index of 1.5."""
    light, eye = _sun(0.0, elevation_deg), _direction(180.0, elevation_deg)
    sine, cosine = math.sin(math.radians(elevation_deg)), math.cos(math.radians(elevation_deg))
    steep = math.sqrt(1 - (cosine / 1.5) ** 2)
    polarised = (sine - 1.5 * steep) / (sine + 1.5 * steep), (steep - 1.5 * sine) / (steep + 1.5 * sine)
    a2 = ROUGHNESS**4
    level_facets = 0.25 / (a2 * sine * math.sqrt(sine**2 * (1 - a2) + a2))
    radiance = float(mirrored_by_paper((light,), eye, ORIGIN)[0]) / (light.irradiance[0] * sine)
    assert (radiance + MIRRORED) / level_facets == pytest.approx(np.square(polarised).mean(), abs=0.03)


def test_a_lamp_twice_as_near_is_mirrored_four_times_as_brightly() -> None:
    """Each along the same ray: from a metre below the lamp, and from half a metre."""
    eye, lamp = _direction(*CAMERA), _sun(*OPPOSITE, inverse_distance=1.0)
    far, near = (float(mirrored_by_paper((lamp,), eye, share * lamp.to_light)[0]) for share in (0.0, 0.5))
    assert near == pytest.approx(4 * far)


@pytest.mark.parametrize("left", [0.0, 1e-9, 1e-4, 5e-3])
def test_a_lamp_at_the_paper_is_no_brighter_than_at_the_least_distance(left: float) -> None:
    """`left`: of the way from the marker's centre to the lamp."""
    eye, lamp = _direction(*CAMERA), _sun(*OPPOSITE, inverse_distance=1.0)
    there, nearest = (
        float(mirrored_by_paper((lamp,), eye, (1 - share) * lamp.to_light)[0]) for share in (left, LEAST_LAMP_DISTANCE)
    )
    assert 0 <= there <= nearest


@pytest.mark.parametrize("white", [0.7, 1.3])
def test_what_paper_and_ink_mirror_is_no_exposure(stage, white: float) -> None:
    """Painted as it mirrors a sun: white is found as of the same paper with the sun elsewhere, clipped or not."""
    opposite, behind = _lighting(*OPPOSITE), _lighting(*BEHIND)
    mirrored = float(mirrored_by_paper(opposite.lights, _direction(*CAMERA), ORIGIN)[1])
    ink = INK_RATIO * PAPER_ALBEDO * white
    glossy = _sheet(stage, (white * (1 + mirrored / PAPER_ALBEDO),) * 3, ink=ink + mirrored * white)
    matte = _sheet(stage, (white,) * 3, ink=ink)
    assert mirrored > 0.01
    taken_for_exposure = white_of(glossy)[1] / white_of(matte)[1] - 1
    seen = [
        white_of(sheet, light_on_print(sheet, sun, None))[1] for sheet, sun in ((glossy, opposite), (matte, behind))
    ]
    left = seen[0] / seen[1] - 1
    assert taken_for_exposure > 0.015
    assert abs(left) < 0.4 * taken_for_exposure
