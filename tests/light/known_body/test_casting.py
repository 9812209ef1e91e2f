"""What casts a shadow is not always what is stated: what may be a lamp is stated as another sun than its shadow has."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.known_body import lamps
from ashe_live.light.known_body.found_light import FoundLight, image_beside
from ashe_live.light.known_body.lamps import _ByEdges, _Nearness, _nearness, as_lamps
from ashe_live.light.known_body.lights import _refitted
from ashe_live.light.known_body.outline.fit import fitted
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.sides.ambient import open_sky_rgb
from ashe_live.light.pixels.view import View
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
    fit = fitted(image_beside(seen, ()), start, darkening)
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
    edges = _ByEdges(np.append(suns[0].light[:3], -8.0), np.diag([1e-4, 1e-4, 1.0]), has_folds=False)
    nearness = _nearness(seen, edges, suns[1:])
    assert nearness.sun == 1
    assert nearness.mean == 0
    assert nearness.variance > 0


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


@pytest.mark.parametrize("found_as", ["what may be a lamp", "a lamp"])
def test_what_is_likelier_a_sun_after_all_is_the_sun_that_its_edges_show(
    seen: Seen, suns: list[FoundLight], found_as: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lamps, "_nearness", lambda *_: _Nearness(0.9, 0.05, 0.1))
    one = stated_elsewhere(suns[0])
    if found_as == "a lamp":
        start = suns[0].sun_alike(seen.body.height_m)
        near = np.append(start[:2] / start[2] * (1 - 3 * seen.body.height_m), (1.0, 3.0))
        fit = fitted(image_beside(seen, ()), near, suns[0].darkening, with_nearness=True)
        assert fit is not None
        assert abs(fit.light[3]) > 0.1
        one = FoundLight(fit.light, fit.covariance, fit, suns[0].darkening)
    sun_after_all, _ = as_lamps(seen, [one, suns[1]], decided=1)
    assert not sun_after_all.is_lamp
    assert not sun_after_all.may_be_lamp
    assert sun_after_all.light == pytest.approx(suns[0].light, abs=0.01)
