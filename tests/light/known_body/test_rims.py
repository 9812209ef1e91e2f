"""Steps of light beside shadows' outlines, in a picture of the table."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.rims import Rims, steps_in
from ashe_live.light.known_body.shadows import cells_of, shadows_of
from ashe_live.light.known_body.table import SIDE
from ashe_live.light.known_body.templates import Templates, templates_of
from ashe_live.tracking.cube.faces import CORNERS

FROM_ABOVE = np.eye(3)  # the map as picture
ALL: Mask = np.ones((SIDE, SIDE), bool)
DARKENING = 0.5
FINER = 10  # pixels to a cell
LIGHT = np.array([[0.4, -0.5, 0.6, 0.0]])


@pytest.fixture(scope="module")
def body() -> Proxy:
    return Proxy("box", np.column_stack([0.06 * CORNERS, np.zeros((8, 2))]))


@pytest.fixture(scope="module")
def templates(body: Proxy) -> Templates:
    return templates_of(body)


def log_odds(
    templates: Templates, values: Float32, seen: Mask = ALL, sky: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    count = len(templates.lights)
    darkenings, skies = np.full(count, DARKENING), np.full(count, sky)
    return steps_in([(templates.rims.beside(values, FROM_ABOVE), seen)], darkenings, skies, 0.1)[:2]


def test_the_light_whose_shadow_it_is_has_the_best_odds(body: Proxy, templates: Templates) -> None:
    shadow = shadows_of(body, LIGHT).one(0)
    visible, odds = log_odds(templates, np.asarray(1 - DARKENING * shadow, dtype=np.float32))
    assert (visible > 0.5).any()
    best = templates.lights[int(odds.argmax()), :3]
    assert best @ LIGHT[0, :3] / np.linalg.norm(LIGHT[0, :3]) > np.cos(np.radians(8))
    elsewhere = templates.lights[:, :3] @ LIGHT[0, :3] < 0.3
    assert odds[elsewhere & (visible > 0.5)].max() < 0


@pytest.mark.parametrize("rough", [0.01, 0.12])
def test_on_a_rough_table_a_shadow_has_deeper_steps_than_stains(
    body: Proxy, templates: Templates, rough: float
) -> None:
    """Whatever the map takes the light for: there it says next to nothing."""
    rng, own = np.random.default_rng(3), LIGHT[0, :3] / np.linalg.norm(LIGHT)
    for _ in range(4):
        stained = 1 - DARKENING / 2 * shadows_of(body, LIGHT).one(0) + rng.normal(0, rough, (SIDE, SIDE))
        nothing = np.zeros(len(templates.lights))
        beside = templates.rims.beside(stained.astype(np.float32), FROM_ABOVE)
        steps = steps_in([(beside, ALL)], nothing, nothing, 0.1)
        by_depth = steps.by_depth()
        assert templates.lights[int(by_depth.argmax()), :3] @ own > np.cos(np.radians(12))
        elsewhere = (templates.lights[:, :3] @ own < 0.3) & (steps.in_view > 0.5)
        assert by_depth[elsewhere].max() < by_depth.max() - 3


def test_an_open_table_speaks_against_all_whose_shadow_would_be_seen(templates: Templates) -> None:
    visible, odds = log_odds(templates, np.ones((SIDE, SIDE), np.float32))
    assert (odds[visible > 0] < 0).all()


def test_what_is_not_seen_says_nothing(templates: Templates) -> None:
    visible, odds = log_odds(templates, np.ones((SIDE, SIDE), np.float32), seen=~ALL)
    assert not visible.any()
    assert not odds.any()


def test_the_sky_that_the_body_hides_is_no_shadow(templates: Templates) -> None:
    """Around its foot an even sky is as dark as a pale shadow."""
    values = np.asarray(1 - templates.hidden_sky.reshape(SIDE, SIDE), dtype=np.float32)
    assert log_odds(templates, values, sky=1.0)[1].max() < 0
    assert log_odds(templates, values, sky=0.0)[1].max() > log_odds(templates, values, sky=1.0)[1].max()


def test_of_further_lights_nothing_is_seen(body: Proxy) -> None:
    beside = Rims.of(body, LIGHT, np.zeros(SIDE * SIDE, np.float32)).beside(
        np.ones((SIDE, SIDE), np.float32), FROM_ABOVE
    )
    visible, odds, *_ = steps = steps_in([(beside, ALL)], np.ones(3), np.zeros(3), 0.1)
    assert visible[0] > 0.5
    assert not visible[1:].any()
    assert not odds[1:].any()
    assert not steps.by_depth()[1:].any()


def test_a_shadow_narrower_than_two_cells_is_seen_in_a_finer_picture(body: Proxy, templates: Templates) -> None:
    """That of a sun 75 degrees high, of which the map has two cells beside the cube's own."""
    light = templates.lights[int((templates.lights[:, :3] @ (0.26, 0.0, 0.966)).argmax())]
    cells, _ = cells_of(body, light[None])
    finer = np.full((FINER * SIDE, FINER * SIDE), 1.0, np.float32)
    cv2.fillConvexPoly(finer, cv2.convexHull(np.round(FINER * cells[0]).astype(np.int32)), 1 - DARKENING)
    seen = np.ones(finer.shape, np.uint8)
    on_table, _ = cells_of(body, np.array([[0.0, 0.0, 1.0, 0.0]]))
    cv2.fillConvexPoly(seen, cv2.convexHull(np.round(FINER * on_table[0]).astype(np.int32)), 0)
    beside, count = templates.rims.beside(finer, np.diag([FINER, FINER, 1.0])), len(templates.lights)
    visible, odds, *_ = steps_in([(beside, seen.view(bool))], np.full(count, DARKENING), np.zeros(count), 0.1)
    own = (templates.lights[:, :3] @ light[:3]).argmax()
    assert visible[own] > 0.2
    assert odds[own] > 4
    high_elsewhere = (templates.lights[:, 2] > 0.9) & (templates.lights[:, 0] < -0.2)
    assert (odds[high_elsewhere] < -4).all()
