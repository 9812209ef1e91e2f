"""Where the tiles of depth maps and of shadows on the ground lie, by points of casters and of lights' discs."""

from dataclasses import dataclass

import numpy as np
import pytest

from ashe_live.core.arrays import Float, box_corners
from ashe_live.core.light import Light
from ashe_live.core.transforms import direction_from_angles, normalised
from ashe_live.render.lights.cast_shadows import cast_by_point
from ashe_live.render.lights.ground_shadows import (
    RIM_TEXELS,
    _ground_from_tile,
    _penumbra_shares,
    _tile_from_marker,
)
from ashe_live.render.lights.light_view import sees, view_of
from ashe_live.render.lights.lighting import ShadingLight, lighting_of
from ashe_live.render.lights.shadow_maps import LightBox, _fitted, _is_seen_soft, _overlaps, _plane_transform

SIZE, MARGIN = 512, 5
BOX, STEM = ((-0.03, -0.02, 0.0), (0.03, 0.02, 0.09)), ((0.05, 0.05, 0.0), (0.054, 0.054, 0.12))


@dataclass(frozen=True)
class Caster:
    points: Float
    is_clear = False

    def render_depth(self, clip_from_marker: Float) -> None: ...


def light(
    size_rad: float, inverse_distance: float = 0.0, elevation_rad: float = 0.8, azimuth_rad: float = 2.5
) -> ShadingLight:
    towards = direction_from_angles(azimuth_rad, elevation_rad)
    return ShadingLight(towards, (0.5,) * 3, (1.0,) * 3, size_rad, inverse_distance)


LIGHTS = {
    "sun": light(0.009),
    "wide": light(0.1),
    "low": light(0.009, 0.0, 0.3),
    "along x": light(0.15, 0.0, 0.8, 0.0),  # in whose light the stem is as narrow as can be
    "lamp": light(0.05, 2.0),
}


def fitted(by: ShadingLight, points: Float) -> LightBox:
    return _fitted(view_of(by, points), points, SIZE, MARGIN)


def around(by: ShadingLight) -> Float:
    """(72, 4) homogeneous points of the rim of a light's disc."""
    across = normalised(np.cross(by.to_light, (0.0, 0.0, 1.0)))
    angles = np.linspace(0, 2 * np.pi, 72)
    rim = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(by.to_light, across))
    return np.column_stack([by.to_light + by.tan_half_size * rim, np.full(72, by.inverse_distance)])


def through(projective: Float, points: Float) -> Float:
    homogeneous = points @ projective[:, :3].T + projective[:, 3]
    return np.asarray(homogeneous[:, :3] / homogeneous[:, 3:])


@pytest.mark.parametrize("by", LIGHTS.values(), ids=LIGHTS.keys())
@pytest.mark.parametrize("bounds", [BOX, STEM], ids=["box", "stem"])
def test_a_depth_map_shows_its_caster_with_empty_texels_around_it_and_hardly_more(by, bounds) -> None:
    points = box_corners(np.array(bounds))
    seen = through(fitted(by, points).unit_from_marker, points)
    texels = SIZE * seen[:, :2]
    assert texels.min() >= MARGIN
    assert texels.max() <= SIZE - MARGIN
    assert (np.ptp(texels, axis=0) > 0.9 * (SIZE - 2 * MARGIN)).all()
    assert 0 < seen[:, 2].min() < 0.01
    assert 0.99 < seen[:, 2].max() < 1


@pytest.mark.parametrize("by", LIGHTS.values(), ids=LIGHTS.keys())
@pytest.mark.parametrize("above_m", [0.0, 0.1])
def test_the_widest_penumbra_is_as_wide_as_the_lights_disc_casts_it(by, above_m) -> None:
    points = box_corners(np.array(BOX)) + np.array((0, 0, above_m))
    view = view_of(by, points)
    cast = np.array([cast_by_point(points, point) for point in around(by)])
    on_ground = np.dstack([cast, np.zeros(cast.shape[:2])])
    aside = [view.seen(each)[:, :2] - view.seen(points)[:, :2] for each in on_ground]
    # A lamp is seen a little aslant from beside the view's axis, where its disc looks narrower.
    assert view.penumbra_m(points) == pytest.approx(np.linalg.norm(aside, axis=2).max(), rel=0.04)


@pytest.mark.parametrize("by", LIGHTS.values(), ids=LIGHTS.keys())
@pytest.mark.parametrize("bounds", [BOX, STEM], ids=["box", "stem"])
def test_a_tile_of_the_ground_has_room_for_all_of_the_penumbra_and_hardly_more(by, bounds) -> None:
    points = box_corners(np.array(bounds))
    cast = np.concatenate([cast_by_point(points, point) for point in around(by)])
    tile_from_marker = _tile_from_marker(fitted(by, points), SIZE)
    texels = SIZE * through(tile_from_marker, np.column_stack([cast, np.zeros(len(cast))]))[:, :2]
    assert texels.min() >= RIM_TEXELS
    assert texels.max() <= SIZE - RIM_TEXELS
    assert np.ptp(texels, axis=0).max() > 0.75 * SIZE
    back = np.column_stack([texels / SIZE, np.zeros(len(texels)), np.ones(len(texels))])
    ground = back @ _ground_from_tile(tile_from_marker).T
    np.testing.assert_allclose(ground[:, :2] / ground[:, 3:], cast, atol=1e-9)


@pytest.mark.parametrize("bounds", [BOX, STEM], ids=["box", "stem"])
def test_of_a_very_wide_penumbra_a_tile_shows_three_lengths_of_the_caster_both_ways(bounds) -> None:
    box = fitted(light(1.2, azimuth_rad=0.0), box_corners(np.array(bounds)))
    sides = box.extent[:2] * (1 + 2 * _penumbra_shares(box))
    np.testing.assert_allclose(sides, 3 * box.extent[:2].max())


def test_beside_a_hard_shadow_a_tile_of_the_ground_has_its_rim_of_lit_texels_alone() -> None:
    box = fitted(light(0.0), box_corners(np.array(BOX)))
    tile_from_unit = _tile_from_marker(box, SIZE) @ np.linalg.inv(box.unit_from_marker)
    corners = SIZE * through(tile_from_unit, np.array([(0.0, 0, 0), (1, 1, 1)]))[:, :2]
    np.testing.assert_allclose(corners, [(RIM_TEXELS,) * 2, (SIZE - RIM_TEXELS,) * 2])


def test_a_card_that_the_light_sees_edge_on_has_a_depth_map_all_the_same() -> None:
    card = np.array([(x, 0.0, z) for x in (0.0, 0.05) for z in (0.0, 0.08)])
    box = fitted(light(0.009, azimuth_rad=0.0), card)
    assert np.isfinite(np.linalg.inv(box.unit_from_marker)).all()
    seen = through(box.unit_from_marker, card)
    assert ((seen > 0) & (seen < 1)).all()


@pytest.mark.parametrize(
    ("size_rad", "above_m", "is_soft"), [(0.0, 0.6, False), (0.009, 0.0, False), (0.1, 0.0, True), (0.009, 0.6, True)]
)
def test_on_a_model_a_penumbra_is_seen_where_it_is_wide_for_the_model(size_rad, above_m, is_soft) -> None:
    """A box 6 cm wide; of a sun half a degree wide, 1 mm within itself, and 5 mm below another 60 cm above it."""
    by = light(size_rad)
    for away_m in (-0.3, 0.0, 0.3):
        receiver = Caster(box_corners(np.array(BOX)) + away_m * by.to_light)
        assert _is_seen_soft(Caster(receiver.points + np.array((0, 0, above_m))), receiver, by) is is_soft


@pytest.mark.parametrize("by", LIGHTS.values(), ids=LIGHTS.keys())
def test_planes_are_those_of_the_map(by) -> None:
    box = fitted(by, box_corners(np.array(BOX)))
    plane = np.array((0.3, -0.2, 0.9, -0.05))
    on_plane = np.array([(0.01, 0.02), (-0.02, 0.0), (0.02, -0.03)])
    heights = -(on_plane @ plane[:2] + plane[3]) / plane[2]
    seen = through(box.unit_from_marker, np.column_stack([on_plane, heights]))
    np.testing.assert_allclose(
        np.column_stack([seen, np.ones(3)]) @ (_plane_transform(box.unit_from_marker) @ plane), 0, atol=1e-9
    )


@pytest.mark.parametrize(
    ("aside_m", "along_m", "size_rad", "meet", "shades"),
    [
        (0.0, 0.1, 0.009, True, True),
        (0.15, 0.1, 0.009, False, False),
        (0.08, 0.1, 0.009, False, False),
        (-0.08, 0.1, 0.009, False, False),
        (0.08, 0.1, 0.4, True, True),  # by its penumbra
        (-0.08, 0.1, 0.4, True, True),
        (0.0, 0.6, 0.009, False, False),  # beyond the end of the shadow
    ],
)
def test_shadows_that_may_meet_and_what_they_may_fall_on_are_found(aside_m, along_m, size_rad, meet, shades) -> None:
    """A box 6 cm wide and 10 cm high, and another beside it or along its shadow, which is 10 cm long."""
    by = ShadingLight(direction_from_angles(np.pi, np.pi / 4), (0.5,) * 3, (1.0,) * 3, size_rad)
    here = np.array([(-0.03, -0.03, 0.0), (0.03, 0.03, 0.1)])
    casting, other = (Caster(box_corners(here + np.array((x, y, 0)))) for x, y in ((0, 0), (along_m, aside_m)))
    assert _overlaps(casting, other, by) == (meet, shades)


def test_what_stands_higher_than_all_of_a_caster_is_not_shaded_by_it() -> None:
    by = ShadingLight(direction_from_angles(np.pi, np.pi / 4), (0.5,) * 3, (1.0,) * 3, 0.009)
    low = Caster(box_corners(np.array([(0.0, -0.03, 0.0), (0.06, 0.03, 0.01)])))
    nearer_the_light = Caster(box_corners(np.array([(-0.3, -0.03, 0.2), (-0.24, 0.03, 0.3)])))
    assert _overlaps(nearer_the_light, low, by)[1]
    assert not _overlaps(low, nearer_the_light, by)[1]


def test_where_a_lamp_stands_between_two_bodies_their_shadows_may_meet() -> None:
    by = light(0.05, 1 / 0.05)
    bodies = [Caster(box_corners(np.array(BOX)) + np.array((x, 0, 0))) for x in (-0.05, 0.04)]
    assert view_of(by, np.concatenate([body.points for body in bodies])) is None, "no view of it shows both"
    assert _overlaps(bodies[0], bodies[1], by) == (True, True)


def test_a_lamp_sees_a_body_wherever_a_view_of_it_shows_that() -> None:
    random = np.random.default_rng(5)
    told = []
    for _ in range(300):
        body = box_corners(np.array(BOX)) * random.uniform(0.3, 3) + np.array((*random.uniform(-0.1, 0.1, 2), 0))
        towards = direction_from_angles(random.uniform(0, 6), random.uniform(0.1, 1.5))
        lamp = Light(towards, inverse_distance=1 / random.uniform(0.03, 0.2))
        shown = all(view_of(each, body) is not None for each in lighting_of((lamp,)).lights)
        told.append(sees(lamp, body))
        assert told[-1] == shown
    assert 30 < told.count(False) < 270
    assert not sees(Light((1.0, 0.0, -0.1)), box_corners(np.array(BOX)))
