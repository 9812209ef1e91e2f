"""The sky beside a painted cube: how much of the light it gives, and from which side."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, frame_of, looking, sun

LOW = sun(80, 40, on_table=0.5)  # both faces that the camera sees are shaded
VIEW = looking(0.35, 50, 225)  # of the faces towards -x and -y


def seen(
    slope: tuple[float, float] = (0.0, 0.0), sky: float = 0.35, lights=(LOW,), exposure: float = 0.9
) -> tuple[Illumination, Float]:
    """What is found, and (3,) the true part of the sky in the table's light."""
    sky_slope = np.array([*slope, 0.0])
    scene = CubeScene(CAMERA, VIEW, lights, sky_rgb=np.full(3, sky), sky_slope=sky_slope, exposure=exposure)
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    found = make_estimator("proxy").estimate(tracked).illumination
    assert found.lights
    return found, sky / (sky + sum(light.irradiance_rgb * light.point[2] for light in lights))


def slope_of(found: Illumination) -> Float:
    return np.zeros((2, 3)) if found.sky_slope_rgb is None else found.sky_slope_rgb


@pytest.mark.parametrize("sky", [0.2, 0.35, 0.6])
def test_the_open_sky_is_estimated_from_what_the_cube_leaves_of_it(sky: float) -> None:
    found, true = seen(sky=sky)
    assert found.ambient_rgb_ratio == pytest.approx(true, rel=0.12)


@pytest.mark.parametrize("slope", [(0.4, 0.0), (-0.4, 0.0), (0.0, 0.4), (0.3, -0.3)])
def test_a_sky_is_brighter_where_it_is(slope: tuple[float, float]) -> None:
    """As few skies lean that much, and cameras bend tones, it is told to lean less, but to the same side."""
    even, _ = seen()
    found, sky = seen(slope)
    told = (slope_of(found) - slope_of(even)).mean(axis=1)
    true = 0.5 * np.mean(sky) * np.array(slope)  # the painter's slope is in half skies
    along = float(told @ true / (true @ true))
    assert 0.3 < along < 1
    np.testing.assert_allclose(told, along * true, atol=0.01)


def test_sides_determine_which_way_a_sky_leans_beside_an_overexposed_top() -> None:
    """By how they differ, and by what the print says of how bright the top is."""
    found, _ = seen((0.4, -0.4), exposure=1.6)
    toward_x, toward_y = slope_of(found).mean(axis=1)
    assert toward_x > 0.01
    assert toward_y < toward_x - 0.02


def test_an_even_sky_hardly_leans() -> None:
    found, sky = seen()
    assert np.abs(slope_of(found)).max() < 0.1 * sky.max()


def test_no_more_is_taken_away_than_there_is() -> None:
    found, _ = seen((-0.9, -0.9))
    assert (np.abs(slope_of(found)) <= 0.5 * found.ambient_rgb_ratio + 1e-9).all()
