"""What casts a shadow is not always what is stated: what may be a lamp is stated as another sun than its shadow has."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.light.explanation.judgement.judge import logit
from ashe_live.light.known_body import candidates, lamps
from ashe_live.light.known_body.candidates import APART_RAD, Candidates
from ashe_live.light.known_body.found_light import FoundLight, images_beside
from ashe_live.light.known_body.lamps import LAMP_ODDS, _Nearness, _nearness, as_lamps
from ashe_live.light.known_body.lights import _refitted
from ashe_live.light.known_body.outline.by_edges import WIDTH_SIGMA, ByEdges, by_edges
from ashe_live.light.known_body.outline.fit import fitted, nearness_sigma
from ashe_live.light.known_body.outline.profiles import EdgeImages
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.sides.ambient import open_sky_rgb
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import NO_LIGHTS
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, frame_of, looking, sun

ON_TABLE, SKY = 0.3, 0.3


@pytest.fixture(scope="module")
def seen() -> Seen:
    """A cube in two suns, whose shadows lie apart and in view."""
    scene = CubeScene(
        CAMERA, looking(0.45, 45, 30), [sun(80, 40, ON_TABLE), sun(170, 35, ON_TABLE)], sky_rgb=np.full(3, SKY)
    )
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame_of(scene))
    assert tracked.marker is not None
    assert tracked.marker.body is not None
    prepared = Seen.of(View.of(tracked, 640), tracked.marker.body, tracked.marker.pose_shape_errors)
    assert prepared is not None
    return prepared


def on_its_edges(seen: Seen, azimuth_deg: float, elevation_deg: float) -> FoundLight:
    start, darkening = sun(azimuth_deg, elevation_deg).point, ON_TABLE / (2 * ON_TABLE + SKY)
    fit = fitted(seen.photos[0].edge_image, start, darkening)
    assert fit is not None
    return FoundLight(fit.light, fit.covariance, fit, darkening)


@pytest.fixture(scope="module")
def suns(seen: Seen) -> list[FoundLight]:
    return [on_its_edges(seen, 80, 40), on_its_edges(seen, 170, 35)]


def stated_elsewhere(one: FoundLight) -> FoundLight:
    """As what may be a lamp, several degrees lower."""
    return replace(one, light=one.light * (1.3, 1.3, 1, 0), may_be_lamp=True)


def test_it_is_fitted_again_from_where_its_shadow_lies(seen: Seen, suns: list[FoundLight]) -> None:
    one, _ = _refitted(seen, [stated_elsewhere(suns[0]), suns[1]])
    assert one.light[:2] == pytest.approx(suns[0].light[:2], abs=0.02)


def test_a_lamp_is_found_beside_the_other_shadow(seen: Seen, suns: list[FoundLight]) -> None:
    first, second = suns
    beside_it, beside_what_is_stated = (
        as_lamps(seen, [first, other], decided=1)[0] for other in (second, stated_elsewhere(second))
    )
    assert beside_what_is_stated.light == pytest.approx(beside_it.light, abs=1e-9)
    assert beside_what_is_stated.covariance == pytest.approx(beside_it.covariance, abs=1e-12)


def test_the_open_sky_is_measured_in_the_shadow_that_is_seen(seen: Seen, suns: list[FoundLight]) -> None:
    dark = np.full((1, 3), suns[0].darkening)
    by_shadow, by_what_is_stated = (open_sky_rgb(seen, [one], dark) for one in (suns[0], stated_elsewhere(suns[0])))
    assert by_what_is_stated == pytest.approx(by_shadow, abs=1e-12)


def test_edges_that_no_lamp_throws_are_a_suns(seen: Seen, suns: list[FoundLight]) -> None:
    """A shadow that grows narrower with height, by eight standard deviations."""
    edges = ByEdges(np.append(suns[0].light[:3], -8.0), np.diag([1e-4, 1e-4, 1.0]), has_folds=False)
    nearness = _nearness(seen, edges, suns[1:])
    assert nearness.sun == 1
    assert nearness.mean == 0
    assert nearness.variance > 0


@pytest.mark.parametrize(("sigma", "is_light"), [(2.0, False), (4.0, True)])
def test_edges_that_surely_draw_together_are_no_lights(
    seen: Seen, suns: list[FoundLight], sigma: float, is_light: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert suns[0].fit is not None
    beyond = np.append(suns[0].light[:3], -8.0)
    fit = replace(suns[0].fit, light=beyond)
    monkeypatch.setattr(candidates, "_moved_onto_edges", lambda *_: fit)
    monkeypatch.setattr(candidates, "by_edges", lambda *_: ByEdges(beyond, np.diag([1e-4, 1e-4, sigma**2]), True))
    alone = seen.beside(NO_LIGHTS)
    found, ruled_out = Candidates(
        seen, alone, images_beside(seen, ()), alone.everywhere.log_likelihood, seen.rims(NO_LIGHTS).cautious
    ).refined()
    assert any(one.fit is fit for one in found) == is_light
    near = [each for each in ruled_out if normalised(each[:3]) @ normalised(suns[0].light[:3]) > np.cos(APART_RAD)]
    assert bool(near) != is_light


def test_a_sun_that_may_be_a_lamp_is_as_unsure_as_a_lamp_would_be_far_from_it(
    seen: Seen, suns: list[FoundLight], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same mean square of the nearness that is not stated, as a spread around 0 and beside it."""

    def covariance(mean: float, variance: float) -> Float:
        monkeypatch.setattr(lamps, "_nearness", lambda *_: _Nearness(0.6, mean, variance))
        first, _ = as_lamps(seen, suns)
        assert not first.is_lamp
        assert not first.may_be_lamp
        return first.covariance

    np.testing.assert_allclose(covariance(0.5, 0.25), covariance(0.0, 0.5))
    assert np.trace(covariance(0.5, 0.25)) > np.trace(covariance(0.0, 0.25))


def test_a_lamps_shadow_stays_on_its_edges_whatever_map_and_sides_say_of_its_distance(
    seen: Seen, suns: list[FoundLight], monkeypatch: pytest.MonkeyPatch
) -> None:
    def lamp_at(nearness: float) -> FoundLight:
        monkeypatch.setattr(lamps, "_nearness", lambda *_: _Nearness(0.0, nearness, 0.01))
        first, _ = as_lamps(seen, suns)
        assert first.is_lamp
        return first

    near, far = lamp_at(4.0), lamp_at(1.5)
    assert near.light[3] == 4.0
    assert far.light[3] == 1.5
    assert near.fit is not None
    profiles = near.fit.profiles_in(images_beside(seen, suns[1:]).several[0])
    assert profiles is not None
    are_edges = profiles.are_steps(near.darkening)
    assert np.median(np.abs(profiles.offset_px[are_edges])) < 0.5
    np.testing.assert_array_equal(near.casting, far.casting)


@pytest.mark.parametrize("found_as", ["what may be a lamp", "a lamp"])
def test_what_is_likelier_a_sun_after_all_is_the_sun_that_its_edges_show(
    seen: Seen, suns: list[FoundLight], found_as: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lamps, "_nearness", lambda *_: _Nearness(0.9, 0.05, 0.1))
    one = stated_elsewhere(suns[0])
    if found_as == "a lamp":
        start = suns[0].sun_alike(seen.body.height_m)
        near = np.append(start[:2] / start[2] * (1 - 3 * seen.body.height_m), (1.0, 3.0))
        fit = fitted(seen.photos[0].edge_image, near, suns[0].darkening, with_nearness=True)
        assert fit is not None
        assert abs(fit.light[3]) > 0.1
        one = FoundLight(fit.light, fit.covariance, fit, suns[0].darkening)
    sun_after_all, _ = as_lamps(seen, [one, suns[1]], decided=1)
    assert not sun_after_all.is_lamp
    assert not sun_after_all.may_be_lamp
    assert sun_after_all.light == pytest.approx(suns[0].light, abs=0.01)


def test_a_body_that_may_be_wider_leaves_open_a_nearer_lamp_whose_shadow_ends_at_the_same_place(
    seen: Seen, suns: list[FoundLight]
) -> None:
    image, height, one = replace(seen.photos[0].edge_image, pose_shape_errors=None), seen.body.height_m, suns[0]
    fit = fitted(image, one.light, one.darkening, with_nearness=True)
    assert fit is not None
    edges = by_edges(EdgeImages((image,)), fit, one.darkening)
    assert edges is not None
    assert not edges.has_folds
    spread, axes = np.linalg.eigh(edges.covariance - fit.covariance)
    assert spread[:2] == pytest.approx(0, abs=1e-9 * spread[2])
    assert np.sqrt(spread[2]) * abs(axes[2, 2]) == pytest.approx(WIDTH_SIGMA / height)
    by_width = ByEdges(fit.light, np.outer(axes[:, 2], axes[:, 2]), has_folds=False)
    (wider,), _ = by_width.lights_at(np.array([fit.light[3] + WIDTH_SIGMA / height]))

    def end(light: Float) -> Float:
        return light[:2] / (1 - height * light[3])

    assert end(wider) == pytest.approx(end(fit.light))
    assert wider[2:] == pytest.approx((1.0, fit.light[3] + WIDTH_SIGMA / height))
    assert by_edges(EdgeImages((image,)), one.fit, one.darkening) is None  # no edges tell how near it is


@pytest.mark.parametrize("sigmas_away", [0.0, 1.0, 2.0, 3.0, 5.0])
def test_where_the_fall_of_light_says_nothing_a_lamp_is_as_likely_as_by_its_edges_over_their_prior(
    seen: Seen, suns: list[FoundLight], sigmas_away: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lamps, "FALL_SHARE", 0.0)
    sigma = 0.5
    light = np.append(suns[0].fit.light[:3], sigmas_away * sigma)
    found = _nearness(seen, ByEdges(light, np.diag([1e-4, 1e-4, sigma**2]), has_folds=False), suns[1:])
    near = np.linspace(0, sigmas_away * sigma + 6 * sigma, 20_000)
    by_edges = np.exp(-0.5 * (near / sigma - sigmas_away) ** 2)
    # Edges' likelihood is their posterior over the prior that their fit had, by which lamps are spread as well.
    prior = np.exp(-0.5 * (near / nearness_sigma(light)) ** 2)
    spread = 2 * prior / (nearness_sigma(light) * np.sqrt(2 * np.pi))
    lamp = LAMP_ODDS * np.trapezoid(by_edges / prior * spread, near)
    sun = by_edges[0] / (by_edges[0] + lamp)
    # As far as a grid of so few values tells.
    assert logit(found.sun) == pytest.approx(logit(sun), abs=0.15)
    sun = found.sun
    mean = np.average(near, weights=by_edges)
    square = np.average(near**2, weights=by_edges)
    assert found.mean == pytest.approx((1 - sun) * mean, abs=0.05 * sigma)
    assert found.variance == pytest.approx((1 - sun) * square - ((1 - sun) * mean) ** 2, rel=0.15)


def test_a_lamp_is_stated_at_its_nearness_and_as_unsure_as_that_is(
    seen: Seen, suns: list[FoundLight], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lamps, "_nearness", lambda *_: _Nearness(0.0, 3.0, 0.04))
    lamp, _ = as_lamps(seen, suns)
    assert lamp.is_lamp
    assert lamp.light[3] == pytest.approx(3.0)
    assert lamp.covariance[2, 2] == pytest.approx(0.04)
    assert np.linalg.eigvalsh(lamp.covariance).min() > 0
    # Four standard errors tell a lamp from a sun: two may be either.
    monkeypatch.setattr(lamps, "_nearness", lambda *_: _Nearness(0.4, 3.0, 1.5**2))
    either, _ = as_lamps(seen, suns)
    assert not either.is_lamp
    assert either.may_be_lamp
    assert np.trace(either.covariance) > np.trace(lamp.covariance[:2, :2])
