"""What a model hides of the sky from the ground around it, against a ball's form factor."""

import numpy as np
import pytest

from ashe_live.models.primitives import revolved
from ashe_live.render.gl.geometry import GpuModel
from ashe_live.render.gl.programs import Programs
from ashe_live.render.occlusion.contact import PATCH_SIZE, ContactPatch
from ashe_live.render.occlusion.occlusion import Known, occlusion_steps

RADIUS = 0.03


@pytest.fixture
def around_a_ball(ctx, stage) -> tuple[np.ndarray, np.ndarray]:
    """(n, 2) places around a ball on the ground, over its radius, and (n, 4) of its contact there."""
    return _around_a_ball(ctx, stage, 1.0)


def _around_a_ball(ctx, stage, height: float) -> tuple[np.ndarray, np.ndarray]:
    """The same of one whose middle is `height` radii above the ground."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 33)
    profile = RADIUS * np.column_stack([np.cos(angles).round(9), height + np.sin(angles)])
    placed, programs, known = stage.placed(revolved(profile, segments=64)), Programs(ctx), Known()
    model = GpuModel(ctx, placed, programs)
    contact = ContactPatch(ctx, programs, model)
    for _ in (*model.upload(), *occlusion_steps(ctx, programs, model, contact, known)):
        pass
    lower, upper = contact.bounds
    places = lower + (np.indices((PATCH_SIZE, PATCH_SIZE))[::-1].reshape(2, -1).T + 0.5) / PATCH_SIZE * (upper - lower)
    for held in (contact, model, programs):
        held.release()
    return places / RADIUS, known[placed].contact.reshape(-1, 4).astype(float)


def test_a_ball_hides_its_form_factor_all_around(around_a_ball) -> None:
    """Of a ball of radius r at the height h, at a distance d: r² h / (d² + h²)^(3/2), which depends on d alone."""
    places, contact = around_a_ball
    away = np.hypot(*places.T)
    ring = (away > 1.6) & (away < 2.0)
    off = contact[ring, 0] - (away[ring] ** 2 + 1) ** -1.5
    assert abs(off.mean()) < 0.01
    assert off.std() < 0.010  # 0.012 where the samples of the sky can be told from one another


@pytest.mark.parametrize("height", [1.7, 2.5, 4.0])
def test_below_a_ball_in_the_air_the_samples_of_the_sky_cannot_be_told_from_one_another(
    ctx, stage, height: float
) -> None:
    places, contact = _around_a_ball(ctx, stage, height)
    away = np.hypot(*places.T)
    below = away < height
    expected = height * (away[below] ** 2 + height**2) ** -1.5
    assert np.sqrt(np.mean((contact[below, 0] - expected) ** 2)) < 0.01


def test_the_hidden_sky_is_where_the_ball_is(around_a_ball) -> None:
    places, contact = around_a_ball
    ring = (np.hypot(*places.T) > 1.3) & (np.hypot(*places.T) < 2.0)
    towards = contact[ring, 1:3] / np.linalg.norm(contact[ring, 1:3], axis=1)[:, None]
    cosine = -(towards * places[ring]).sum(axis=1) / np.hypot(*places[ring].T)
    assert np.degrees(np.arccos(np.minimum(cosine, 1))).max() < 15


def test_nothing_is_left_at_the_border_and_it_ends_on_a_circle(around_a_ball) -> None:
    """On lit ground one height away, which is two radii; in the ball's shadow half a height farther."""
    places, contact = around_a_ball
    beyond = np.hypot(*np.maximum(np.abs(places) - 1, 0).T)  # of the ball's bounds
    on_lit_ground = contact[:, :3] * contact[:, 3:]
    assert np.abs(on_lit_ground[beyond >= 2.0]).max() == 0
    assert np.abs(contact[beyond >= 3.0]).max() == 0
    between = (beyond > 2.0) & (beyond < 2.4)
    assert (contact[between, 0] > 0).all()


def test_in_the_shadow_it_is_the_form_factor_as_far_as_lit_ground_has_any(around_a_ball) -> None:
    places, contact = around_a_ball
    away, beyond = np.hypot(*places.T), np.hypot(*np.maximum(np.abs(places) - 1, 0).T)
    ring = (beyond > 1.1) & (beyond < 1.5)
    np.testing.assert_allclose(contact[ring, 0], (away[ring] ** 2 + 1) ** -1.5, atol=0.02)
    assert (contact[ring, 3] < 1).all()
