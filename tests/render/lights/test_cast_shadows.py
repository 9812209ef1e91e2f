"""Where shadows lie on the ground, by the projection of points from a light, and from all of its disc."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, normalised
from ashe_live.render.lights.cast_shadows import (
    MAX_SHADOW_HEIGHTS,
    cast_by_point,
    is_inside,
    lit_past,
    shadow_hull,
    shadow_hull_of_point,
)
from ashe_live.render.lights.lighting import ShadingLight

POST = Proxy("box", np.array([(x, y, z, 0, 0) for x in (0.08, 0.12) for y in (-0.02, 0.02) for z in (0.0, 0.1)]))
TOWARDS = direction_from_angles(2.5, 0.7)


def light(size_rad: float = 0.2, inverse_distance: float = 0.0) -> ShadingLight:
    return ShadingLight(TOWARDS, (0.5,) * 3, (1.0,) * 3, size_rad, inverse_distance)


def on_disc(of: ShadingLight, count: int = 200) -> Float:
    """(n, 4) points of the light, homogeneous."""
    random = np.random.default_rng(4)
    across = normalised(np.cross(of.to_light, (0.0, 0.0, 1.0)))
    turn, radius = random.uniform(0, 2 * np.pi, count), of.tan_half_size * np.sqrt(random.uniform(0, 1, count))
    offsets = np.outer(radius * np.cos(turn), across) + np.outer(radius * np.sin(turn), np.cross(of.to_light, across))
    return np.column_stack([of.to_light + offsets, np.full(count, of.inverse_distance)])


@pytest.mark.parametrize("inverse_distance", [0.0, 2.0])
def test_a_point_casts_its_shadow_along_the_ray_from_the_light(inverse_distance: float) -> None:
    points = np.random.default_rng(1).uniform((-0.2, -0.2, 0.0), (0.2, 0.2, 0.2), (30, 3))
    cast = cast_by_point(points, np.append(TOWARDS, inverse_distance))
    to_light = TOWARDS - inverse_distance * points
    expected = points - to_light * (points[:, 2:] / to_light[:, 2:])
    np.testing.assert_allclose(cast, expected[:, :2], atol=1e-12)


def test_a_shadow_is_as_long_as_it_is_drawn_at_most_also_of_what_is_above_the_light() -> None:
    low, lamp = direction_from_angles(0.3, 0.001), np.array([0.6, 0.0, 0.8, 4.0])  # 0.15 m beside and 0.2 m above
    for source, point in ((np.append(low, 0.0), (0.1, 0.0, 0.1)), (lamp, (0.4, 0.0, 0.3))):
        cast = cast_by_point(np.array([point]), source)[0] - point[:2]
        away = source[3] * np.array(point[:2]) - source[:2]
        np.testing.assert_allclose(cast, MAX_SHADOW_HEIGHTS * point[2] * away / np.linalg.norm(away))


@pytest.mark.parametrize("inverse_distance", [0.0, 2.0])
def test_the_shadow_with_its_penumbra_holds_those_of_all_points_of_the_light_and_little_more(
    inverse_distance: float,
) -> None:
    of, points = light(inverse_distance=inverse_distance), POST.points_marker()
    hull = shadow_hull(points, of)
    casts = np.concatenate([cast_by_point(points, each) for each in on_disc(of)])
    middle = hull.mean(axis=0)
    assert is_inside(middle + 1.001 * (hull - middle), casts).all()
    assert not is_inside(middle + 0.8 * (hull - middle), casts).all()
    own = shadow_hull_of_point(points, of.homogeneous)
    assert is_inside(hull, own).all()


@pytest.mark.parametrize("turn", [1, -1])
def test_inside_is_within_all_edges_either_way_round(turn: int) -> None:
    square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])[::turn]
    points = np.array([(1.0, 0.5), (2.5, 0.5), (-0.5, 0.5), (1.0, 1.5), (1.0, -0.5)])
    assert is_inside(square, points).tolist() == [True, False, False, False, False]


@pytest.mark.parametrize("inverse_distance", [0.0, 2.0])
def test_ground_is_lit_where_all_of_the_light_reaches_it_and_shaded_where_none_does(inverse_distance: float) -> None:
    of, points = light(inverse_distance=inverse_distance), POST.points_marker()
    ground = np.random.default_rng(2).uniform((0.0, -0.2), (0.35, 0.1), (400, 2))
    hidden = np.mean([is_inside(shadow_hull_of_point(points, each), ground) for each in on_disc(of)], axis=0)
    lit = lit_past(POST, of, ground)
    assert (hidden[lit == 1] == 0).all()
    assert (hidden[lit == 0] == 1).all()
    assert np.isnan(lit[(hidden > 0.02) & (hidden < 0.98)]).all()
    assert min(np.count_nonzero(lit == 0), np.count_nonzero(lit == 1), np.count_nonzero(np.isnan(lit))) > 5
