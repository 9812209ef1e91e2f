"""Steps of light beside shadows' outlines, in the map of the table."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.rims import Rims
from ashe_live.light.known_body.shadows import shadows_of
from ashe_live.light.known_body.table import SIDE
from ashe_live.light.known_body.templates import Templates, templates_of
from ashe_live.tracking.cube.faces import CORNERS

ALL: Mask = np.ones((SIDE, SIDE), bool)
DARKENING = 0.5
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
    return templates.rims.seen(values, seen, templates.hidden_sky, darkenings, skies, 0.1)


def test_the_light_whose_shadow_it_is_has_the_best_odds(body: Proxy, templates: Templates) -> None:
    shadow = shadows_of(body, LIGHT).one(0)
    visible, odds = log_odds(templates, np.asarray(1 - DARKENING * shadow, dtype=np.float32))
    assert (visible > 0.5).any()
    best = templates.lights[int(odds.argmax()), :3]
    assert best @ LIGHT[0, :3] / np.linalg.norm(LIGHT[0, :3]) > np.cos(np.radians(8))
    elsewhere = templates.lights[:, :3] @ LIGHT[0, :3] < 0.3
    assert odds[elsewhere & (visible > 0.5)].max() < 0


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


def test_unseen_ones_are_added_at_the_end(body: Proxy) -> None:
    rims = Rims.of(body, LIGHT).and_unseen(2)
    bright, sky = np.ones((SIDE, SIDE), np.float32), np.zeros(SIDE * SIDE, np.float32)
    visible, odds = rims.seen(bright, ALL, sky, np.ones(3), np.zeros(3), 0.1)
    assert visible[0] > 0.5
    assert not visible[1:].any()
    assert not odds[1:].any()
