"""A shadow whose end is not seen is no shorter than its edges are."""

import numpy as np
import pytest

from ashe_live.bench.cube.scenes import lamp
from ashe_live.core.arrays import Float
from ashe_live.light.known_body.outline.by_edges import ByEdges
from ashe_live.light.known_body.outline.fit import ShadowFit, fitted
from ashe_live.light.known_body.outline.profiles import EdgeImage
from ashe_live.light.known_body.outline.reach import Reach
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.pixels.view import View
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, PaintedLight, frame_of, looking, sun

DARKENING = 0.6
TOWARDS = np.array([0.6, 0.8])
# A light by edges that leave open where the shadow ends: a lamp over one place, which may be nearer or farther.
OPEN = np.outer((0.27, 0.36, 1.5), (0.27, 0.36, 1.5)) + 0.02 * np.eye(3)


def fit_of(light: PaintedLight, tilt_deg: float, turn_deg: float) -> tuple[ShadowFit, EdgeImage]:
    frame = frame_of(CubeScene(CAMERA, looking(0.4, tilt_deg, turn_deg), [light]))
    tracked = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking).track(frame)
    assert tracked.marker is not None
    assert tracked.marker.body is not None
    seen = Seen.of(View.of(tracked, 640), tracked.marker.body, tracked.marker.pose_shape_errors)
    assert seen is not None
    image = seen.photos[0].edge_image
    fit = fitted(image, light.point / light.point[2], DARKENING, with_nearness=True)
    assert fit is not None
    return fit, image


def end(light: Float, height: float) -> float:
    """Where its shadow of something of that height ends, over the height."""
    return float(np.hypot(*light[:2]) / (light[2] - height * light[3]))


@pytest.mark.parametrize(("azimuth_deg", "tilt_deg", "turn_deg"), [(155, 60, 20), (65, 30, 300)])
def test_a_shadow_that_leaves_the_picture_reaches_as_far_as_it_is_seen(
    azimuth_deg: float, tilt_deg: float, turn_deg: float
) -> None:
    true = lamp(sun(azimuth_deg, 15, on_table=0.5, size_deg=3.0), 0.5)
    fit, image = fit_of(true, tilt_deg, turn_deg)
    reach = Reach.seen(fit, image, DARKENING)
    assert reach is not None
    edges = image.edges(true.point / true.point[2])
    assert edges is not None
    x, y = edges.points_px.T
    is_in_picture = (x > 10) & (x < CAMERA.size[0] - 11) & (y > 10) & (y < CAMERA.size[1] - 11)
    in_picture = float(np.hypot(*true.point[:2]) / true.point[2] * edges.drop[is_in_picture].max() / EDGE_M)
    assert 0.75 * in_picture < reach.least < in_picture < end(true.point, EDGE_M)
    assert reach.towards == pytest.approx(true.point[:2] / np.hypot(*true.point[:2]), abs=0.05)


def test_an_end_that_is_seen_says_more() -> None:
    fit, image = fit_of(lamp(sun(200, 45, size_deg=3.0), 0.5), 45, 30)
    assert Reach.seen(fit, image, DARKENING) is None


def by_edges(least: float) -> ByEdges:
    light = np.array([*(1.2 * TOWARDS), 1.0, 3.0])
    return ByEdges(light, OPEN, True, Reach(TOWARDS, least, EDGE_M))


def test_whatever_the_nearness_the_likeliest_light_reaches_so_far_and_no_farther() -> None:
    nearness = np.linspace(0, 8, 9)
    free, by_nearness = ByEdges(by_edges(0).light, OPEN, True).lights_at(nearness)
    lights, log_likelihood = by_edges(2.0).lights_at(nearness)
    ends = np.array([end(each, EDGE_M) for each in lights])
    are_short = np.array([end(each, EDGE_M) for each in free]) < 2.0
    assert 2 < are_short.sum() < 9
    assert ends[are_short] == pytest.approx(2.0)
    np.testing.assert_array_equal(lights[~are_short], free[~are_short])
    # By how many standard deviations they had to be moved, of the two that are free at a nearness.
    held = np.linalg.inv(np.linalg.inv(OPEN)[:2, :2])
    away = (lights - free)[:, :2]
    np.testing.assert_allclose(
        log_likelihood, by_nearness - 0.5 * (away * np.linalg.solve(held, away.T).T).sum(axis=1), atol=1e-9
    )


def test_what_is_stated_moves_with_its_nearness_as_its_covariance_says() -> None:
    edges, small = by_edges(2.0), 1e-4
    lights, _ = edges.lights_at(np.array([2.0 - small, 2.0 + small]))
    line = (lights[1] - lights[0])[[0, 1, 3]] / (2 * small)
    light, one = edges.stated(2.0, 0.0)
    assert end(light, EDGE_M) == pytest.approx(2.0)
    _, other = edges.stated(2.0, 0.3)
    np.testing.assert_allclose(other - one, 0.3 * np.outer(line, line), atol=1e-6)


def test_the_reach_is_the_surer_the_more_it_contradicts_the_edges() -> None:
    along = np.append(TOWARDS, 0.0)

    def spread(least: float) -> float:
        return float(along @ by_edges(least).stated(3.0, 0.2)[1] @ along)

    free = ByEdges(by_edges(0).light, OPEN, True).stated(3.0, 0.2)[1]
    assert spread(0.5) == pytest.approx(along @ free @ along)
    held = [float(along @ by_edges(least).stated(3.0, 0.0)[1] @ along) for least in (1.0, 1.6, 2.0, 3.0)]
    assert held == sorted(held, reverse=True)
    assert held[-1] > 0
