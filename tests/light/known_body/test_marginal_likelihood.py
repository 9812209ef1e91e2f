"""The linear model of a table's map: what lights take from it is what is found, whatever varies slowly beside."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.observed import Lit, Observed
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.sides.shading import Sides
from ashe_live.light.known_body.table import SIDE
from ashe_live.light.known_body.templates import templates_of
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.tracking.cube.faces import CORNERS
from tests.painted_cubes import sun

NOTHING = np.empty(0)
NO_SIDES = Sides(np.empty((0, 3)), np.empty((0, 3)), np.zeros(3), *[NOTHING] * 4, np.empty(0, bool), NOTHING)
RNG_SEED = 4


def body(edge_m: float = 0.06, crooked: float = 0.0) -> Proxy:
    corners = edge_m * CORNERS + np.random.default_rng(RNG_SEED).normal(0, crooked, CORNERS.shape)
    return Proxy("box", np.column_stack([corners, np.zeros((8, 2))]))


CUBE = body()
TEMPLATES = templates_of(CUBE)
EVERYWHERE = Lit(TEMPLATES.lights, TEMPLATES.shadows)


def lit(*lights: Float) -> Lit:
    points = np.array(lights).reshape(-1, 4)
    return Lit(points, shadows_of(CUBE, points))


def map_of(darkenings: dict[tuple[float, float], float], noise: float = 0.02) -> Float32:
    """Relative light of a table with a gradient, under suns at (azimuth, elevation) of some darkening and a sky."""
    y, x = np.mgrid[:SIDE, :SIDE] / (SIDE // 2) - 1
    sky = 1 - sum(darkenings.values())
    light = 1 + 0.1 * x - 0.05 * x * y - sky * TEMPLATES.hidden_sky.reshape(SIDE, SIDE)
    for angles, darkening in darkenings.items():
        light -= darkening * shadows_of(CUBE, sun(*angles).point[None]).whole()[0]
    return (light + np.random.default_rng(RNG_SEED).normal(0, noise, light.shape)).astype(np.float32)


def likelihood(values: Float32, known: Lit) -> MarginalLikelihood:
    even = np.ones((SIDE, SIDE), np.float32)
    return MarginalLikelihood(
        Observed(values, even, TEMPLATES.hidden_sky, TEMPLATES.hidden_slope, NO_SIDES, EVERYWHERE), known
    )


@pytest.mark.parametrize("darkening", [0.15, 0.4, 0.7])
def test_one_sun_is_where_it_is_and_takes_what_it_gives(darkening: float) -> None:
    true = sun(200, 35).point
    found = likelihood(map_of({(200, 35): darkening}), lit())
    best = int(found.everywhere.log_likelihood.argmax())
    assert TEMPLATES.lights[best, :3] @ true[:3] > np.cos(np.radians(6))
    assert found.scanned(lit(true)).darkenings[0, 0] == pytest.approx(darkening, rel=0.08)


def test_two_suns_are_distinguished() -> None:
    darkenings = {(200, 35): 0.4, (80, 60): 0.25}
    known = lit(*(sun(*angles).point for angles in darkenings))
    assert likelihood(map_of(darkenings), known).darkenings == pytest.approx([0.4, 0.25], rel=0.1)
    beside = likelihood(map_of(darkenings), lit(sun(200, 35).point)).everywhere
    best = int(beside.log_likelihood.argmax())
    assert TEMPLATES.lights[best, :3] @ sun(80, 60).point[:3] > np.cos(np.radians(8))
    assert beside.log_likelihood[best] > 10


def test_where_nothing_casts_a_shadow_nothing_is_likelier_than_that() -> None:
    assert likelihood(map_of({}), lit()).everywhere.log_likelihood.max() < 1


@pytest.mark.parametrize("slope", [(0.2, 0.0), (0.0, 0.25), (-0.2, 0.15)])
def test_a_sky_that_gives_all_light_may_lean_as_much_as_skies_do(slope: tuple[float, float]) -> None:
    leaning = 1 - TEMPLATES.hidden_sky - np.array(slope) @ TEMPLATES.hidden_slope
    noise = np.random.default_rng(RNG_SEED).normal(0, 0.01, (SIDE, SIDE))
    values = (leaning.reshape(SIDE, SIDE) + noise).astype(np.float32)
    assert likelihood(values, lit()).everywhere.log_likelihood.max() < 0


def test_a_further_light_that_is_not_there_takes_nothing() -> None:
    scan = likelihood(map_of({(200, 35): 0.4}), lit(sun(200, 35).point)).scanned(lit(sun(80, 60).point))
    assert scan.darkenings[0, 1] < 0.03
    assert scan.log_likelihood[0] < 0


def test_all_cubes_share_their_templates() -> None:
    assert templates_of(body(0.05)) is TEMPLATES
    assert templates_of(body(crooked=1e-3)) is TEMPLATES
    moved = Proxy("box", CUBE.spheroids_marker + np.array([0.2, -0.1, 0, 0, 0]))
    assert templates_of(moved) is TEMPLATES


@pytest.mark.parametrize("elevation_deg", [12, 20, 30, 45, 60, 75, 88])
@pytest.mark.parametrize("azimuth_deg", [0, 33])
def test_the_hemisphere_is_covered_once_with_more_lights_behind_the_camera(
    elevation_deg: float, azimuth_deg: float
) -> None:
    """As a whole, and around the camera's direction, where the further ones are."""
    to_eye = sun(azimuth_deg, elevation_deg).point[:3]
    templates = TEMPLATES.and_behind(CUBE.foot_marker + 0.4 * to_eye, CUBE)
    assert len(templates.lights) > len(TEMPLATES.lights)
    assert templates.solid_angle.sum() == pytest.approx(1, abs=0.015)
    cap_rad = np.radians(min(elevation_deg, 35))
    is_around = templates.lights[:, :3] @ to_eye > np.cos(cap_rad)
    assert templates.solid_angle[is_around].sum() == pytest.approx(1 - np.cos(cap_rad), rel=0.2)


def test_lights_at_the_horizon_and_below_cast_no_shadow() -> None:
    low = at_infinity(np.array([(1.0, 0.0, 0.0), (1.0, 0.0, -0.5)]))
    assert not shadows_of(CUBE, low).whole().any()


def test_a_shadow_is_the_same_in_whichever_window_it_is_stored() -> None:
    lights = TEMPLATES.lights[::17]
    together, apart = shadows_of(CUBE, lights), shadows_of(CUBE, lights, np.arange(len(lights)))
    np.testing.assert_array_equal(together.whole(), apart.whole())
    values = np.random.default_rng(RNG_SEED).random((SIDE, SIDE, 2)).astype(np.float32)
    expected = np.einsum("mij,ijc->mc", together.whole(), values)
    np.testing.assert_allclose(apart.sums(values), expected, rtol=1e-4)
    squares = np.einsum("mij,ij->m", together.whole() ** 2, values[..., 0])
    np.testing.assert_allclose(apart.squares(values[..., 0]), squares, rtol=1e-4)
    joined = together.joined(apart)
    np.testing.assert_allclose(joined.sums(values), np.concatenate([expected, expected]), rtol=1e-4)
