"""Outlines of spheroids against brute force, and every derivative against finite differences."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.light.shape.families import FAMILIES
from ashe_live.light.shape.family import Family, Members, padded
from ashe_live.light.shape.layout import ParameterLayout, light_parameters, nearness_of
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.supports import outline_points, outline_reaches, outline_supports
from tests.light.synthetic_masks import camera_towards

ANGLES = np.arange(16) * (2 * math.pi / 16) + 0.1
DIRECTIONS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
# About the principal point, where the body stands: as the fit has it.
P = np.diag([500.0, 500.0, 1.0]) @ camera_towards((0.0, 0.0), 6.0, 30.0)[:3]
# A sun, and a lamp at six times the body's height.
LIGHTS = np.array([[[-0.8, 0.5, 1.0, 0.0], [1.8, 6.6, 6.0, 1.0]]])
CYLINDER = np.array([0.1, -0.1, math.log(1.2), 0.5, 0.4])


def member(name: str) -> Float:
    """(1, q) parameters of some member, away from its starts' symmetry."""
    family = FAMILIES[name]
    seed = CYLINDER if family.grows_from is None else member(family.grows_from)[0]
    theta = family.starts(seed)[:1]
    return theta + 0.05 * np.sin(1.0 + np.arange(theta.shape[1]))


def numerical(function: Callable[[Float], Float], at: Float, step: float = 1e-6) -> Float:
    """Derivatives by the last axis of `at` (1, q), stacked last."""
    columns = []
    for i in range(at.shape[1]):
        offset = np.zeros_like(at)
        offset[0, i] = step
        columns.append((function(at + offset) - function(at - offset)) / (2 * step))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("name", FAMILIES)
def test_parts_have_exact_derivatives(name: str) -> None:
    family, theta = FAMILIES[name], member(name)
    assert theta.shape[1] == len(family.spread)
    expected = numerical(lambda t: family.parts(t)[0], theta)
    assert np.allclose(family.parts(theta)[1], expected, atol=1e-8)


@pytest.mark.parametrize("name", FAMILIES)
def test_reaches_are_those_of_the_bodys_points(name: str) -> None:
    family: Family = FAMILIES[name]
    parts = family.parts(member(name))[0]
    supports = outline_supports(P[None], parts, LIGHTS, DIRECTIONS.T[None])
    # A radius has no sign.
    points = Proxy(name, np.column_stack([parts[0, :, :3], np.abs(parts[0, :, 3:])])).points_marker(400)
    outlines = [points]
    for x, y, z, w in LIGHTS[0]:
        # Where the line from the light through a point meets the plane.
        flat = np.zeros_like(points)
        flat[:, :2] = (z * points[:, :2] - points[:, 2:] * (x, y)) / (z - w * points[:, 2:])
        outlines.append(flat)
    for outline, reach_px in zip(outlines, supports.reach_px[0], strict=True):
        images = outline @ P[:, :3].T + P[:, 3]
        expected = (images[:, :2] / images[:, 2:] @ DIRECTIONS.T).max(axis=0)
        # The points lie on the body, so that they never reach further, and sampled spheroids a little less far.
        assert (reach_px > expected - 1e-6).all()
        assert np.allclose(reach_px, expected, atol=1.0 if name in ("sphere", "mug", "lump") else 0.05)


@pytest.mark.parametrize("name", FAMILIES)
def test_reaches_have_exact_derivatives(name: str) -> None:
    family, shape = FAMILIES[name], member(name)
    supports = outline_supports(P[None], family.parts(shape)[0], LIGHTS, DIRECTIONS.T[None])
    by_theta = supports.by_theta(family.parts(shape)[1])
    expected = numerical(
        lambda t: outline_supports(P[None], family.parts(t)[0], LIGHTS, DIRECTIONS.T[None]).reach_px, shape
    )
    assert np.allclose(by_theta[:, 4:], np.moveaxis(expected, 3, 1), atol=2e-2, rtol=1e-4)

    parts, layout = family.parts(shape)[0], ParameterLayout(2, with_nearness=True)
    by_lights = supports.by_theta(family.parts(shape)[1], with_nearness=True)
    assert (by_lights[:, 6:] == by_theta[:, 4:]).all()
    for light in range(2):

        def reach(numbers: Float, light: int = light) -> Float:
            lights = LIGHTS.copy()
            lights[:, light] = (*numbers[0, :2], 1.0, numbers[0, 2])
            return outline_supports(P[None], parts, lights, DIRECTIONS.T[None]).reach_px

        here = np.append(light_parameters(LIGHTS[:, light]), nearness_of(LIGHTS[:, light])[:, None], axis=1)
        expected = numerical(reach, here)
        by_light = by_lights[:, layout.light(light)]
        assert np.allclose(by_light, np.moveaxis(expected, 3, 1), atol=2e-2, rtol=1e-4)
        assert (np.delete(by_light, 1 + light, axis=2) == 0).all()
        assert (by_theta[:, ParameterLayout(2).light(light)] == by_light[:, :2]).all()


def test_a_spheres_outline_is_exact() -> None:
    """Seen centrally, a ball of radius r at distance d has the radius f tan(asin(r / d))."""
    camera = Camera.from_focal((640, 480), 500.0)
    K = camera.K.copy()
    K[:2, 2] = 0.0
    pose = np.hstack([np.diag([1.0, -1.0, -1.0]), np.array([[0.0], [0.0], [4.0]])])
    ball = np.array([[[0.0, 0.0, 1.0, 0.6, 0.6]]])
    reach_px = outline_supports((K @ pose)[None], ball, np.zeros((1, 0, 4)), DIRECTIONS.T[None]).reach_px
    assert np.allclose(reach_px, 500 * math.tan(math.asin(0.6 / 3.0)))


def test_what_lies_behind_the_camera_stays_finite() -> None:
    parts = FAMILIES["box"].parts(member("box"))[0]
    for size in (1e2, 1e4):
        lights = at_infinity(np.array([[[0.0, size, 1.0]], [[0.0, -size, 1.0]], [[size, 0.0, 1.0]]]))
        cameras, bodies, directions = (np.repeat(one[None], 3, axis=0) for one in (P, parts[0], DIRECTIONS.T))
        supports = outline_supports(cameras, bodies, lights, directions)
        for values in (supports.reach_px, supports.by_part, supports.by_light):
            assert np.isfinite(values).all()


@pytest.mark.parametrize("name", FAMILIES)
def test_outline_points_lie_on_the_outline_and_reach_as_far_as_it(name: str) -> None:
    parts = FAMILIES[name].parts(member(name))[0]
    reach_px = outline_supports(P[None], parts, LIGHTS, DIRECTIONS.T[None]).reach_px
    points = outline_points(P[None], parts, LIGHTS, 720).reshape(1, 3, -1, 2)
    assert np.allclose((points @ DIRECTIONS.T).max(axis=2), reach_px, atol=1e-2)


def test_parts_of_several_families_are_those_of_each() -> None:
    names = ["frustum", "box", "mug", "box", "pylon", "ell"]
    shapes = [member(name)[0] for name in names]
    batches = Members([FAMILIES[name] for name in names], padded(shapes)).batches()
    assert sorted(row for batch in batches for row in batch.rows.tolist()) == list(range(len(names)))
    for batch in batches:
        for i, parts, slopes in zip(batch.rows.tolist(), batch.parts, batch.by_shape, strict=True):
            (own,), (own_slopes,) = FAMILIES[names[i]].parts(shapes[i][None])
            assert np.array_equal(parts[: len(own)], own)
            assert (parts[len(own) :] == own[0]).all()
            assert np.array_equal(slopes[: len(own), :, : len(shapes[i])], own_slopes)
            assert not slopes[len(own) :].any()
            assert not slopes[:, :, len(shapes[i]) :].any()


def test_reaches_of_several_families_are_those_of_each() -> None:
    shapes, families = [member(name)[0] for name in FAMILIES], list(FAMILIES.values())
    P_of_all, lights, directions = (
        np.repeat(one, len(families), axis=0) for one in (P[None], LIGHTS, DIRECTIONS.T[None])
    )
    reach_px, by_theta = outline_reaches(Members(families, padded(shapes)), P_of_all, lights, directions)
    for i, (family, shape) in enumerate(zip(families, shapes, strict=True)):
        parts, by_shape = family.parts(shape[None])
        alone = outline_supports(P[None], parts, LIGHTS, DIRECTIONS.T[None])
        slopes = alone.by_theta(by_shape)[0]
        assert np.allclose(reach_px[i], alone.reach_px[0], rtol=1e-12)
        assert np.allclose(by_theta[i, : len(slopes)], slopes, rtol=1e-9, atol=1e-9)
        assert not by_theta[i, len(slopes) :].any()
