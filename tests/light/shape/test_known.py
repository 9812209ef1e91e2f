"""The family of a known body: its points are the body's, moved and turned, and its derivatives are those of that."""

import math

import numpy as np
import pytest

from ashe_live.core.caster import Caster
from ashe_live.light.shape.known import TURNS, family_of, resized_family_of, size_ratios, unit_m

HULL = Caster.hull(np.array([(0, 0, 0), (0.06, 0, 0), (0, 0.05, 0), (0.02, 0.01, 0.1)]))
CASTERS = {
    "box": Caster.box(0.06, 0.04, 0.1),
    "cylinder": Caster.cylinder(0.03, 0.1),
    "sphere": Caster.sphere(0.04),
    "hull": HULL,
}


def theta_of(caster: Caster) -> np.ndarray:
    return np.array([0.3, -0.7, 0.4][: family_of(caster).size])


@pytest.mark.parametrize("name", CASTERS)
def test_a_member_is_the_body_moved_and_turned(name: str) -> None:
    caster = CASTERS[name]
    theta = theta_of(caster)
    ((member,), _) = family_of(caster).parts(theta[None])
    body = np.array(caster.spheroids) / unit_m(caster)
    turn = theta[2] if len(theta) > 2 else 0.0
    c, s = np.cos(turn), np.sin(turn)
    body[:, :2] = body[:, :2] @ np.array([(c, s), (-s, c)]) + theta[:2]
    np.testing.assert_allclose(member, body, atol=1e-12)


RESIZED = {
    "box": (Caster.box(0.06, 0.04, 0.1), Caster.box(0.09, 0.02, 0.11)),
    "cylinder": (Caster.cylinder(0.03, 0.1), Caster.cylinder(0.02, 0.15)),
    "sphere": (Caster.sphere(0.04), Caster.sphere(0.05)),
    "hull": (HULL, Caster.hull(1.2 * np.array(HULL.spheroids)[:, :3])),
}


@pytest.mark.parametrize("name", RESIZED)
def test_a_resized_body_is_one_of_other_sizes(name: str) -> None:
    given, other = RESIZED[name]
    family, place = resized_family_of(given), np.zeros(family_of(given).size)
    before, after = (np.array(each.spheroids) for each in (given, other))
    sizes = {"box": (1.5, 0.5, 1.1), "cylinder": (2 / 3, 1.5), "sphere": (1.25,), "hull": (1.2,)}[name]
    theta = np.append(place, np.log(sizes))
    assert family.size == len(theta)
    np.testing.assert_allclose(family.parts(theta[None])[0][0] * unit_m(given), after, atol=1e-12)
    np.testing.assert_allclose(size_ratios(given, theta), sizes)
    (start, *_) = family.starts(np.zeros(5))
    np.testing.assert_allclose(family.parts(start[None])[0][0] * unit_m(given), before, atol=1e-12)


@pytest.mark.parametrize("is_resized", [False, True])
@pytest.mark.parametrize("name", CASTERS)
def test_derivatives_are_those_of_finite_differences(name: str, is_resized: bool) -> None:
    family, theta, step = family_of(CASTERS[name]), theta_of(CASTERS[name]), 1e-6
    if is_resized:
        family = resized_family_of(CASTERS[name])
        theta = np.append(theta, np.linspace(0.1, -0.2, family.size - len(theta)))
    _, by_theta = family.parts(theta[None])
    for i in range(family.size):
        ends = [family.parts((theta + sign * step * np.eye(family.size)[i])[None])[0] for sign in (1, -1)]
        np.testing.assert_allclose(by_theta[..., i], (ends[0] - ends[1]) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("name", CASTERS)
def test_starts_are_spread_over_the_turns_that_differ(name: str) -> None:
    caster = CASTERS[name]
    starts = family_of(caster).starts(np.array([0.3, -0.7, 0.0, 1.0, 1.0]))
    np.testing.assert_array_equal(starts[:, :2], np.tile([0.3, -0.7], (len(starts), 1)))
    if not caster.period_rad:
        assert starts.shape == (1, 2)
        return
    steps = np.diff(np.append(starts[:, 2], caster.period_rad))
    np.testing.assert_allclose(steps, caster.period_rad / len(starts))
    assert len(starts) >= 2
    assert caster.period_rad / len(starts) == pytest.approx(2 * math.pi / TURNS, rel=0.3)


def test_a_known_body_has_one_family() -> None:
    assert family_of(Caster.sphere(0.04)) is family_of(Caster.sphere(0.04))
