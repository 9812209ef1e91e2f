"""What a lit side sends to the table: by rays as by Lambert's formula, and as much as the side's own light says."""

import math

import numpy as np
import pytest

from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.sides.bounce import SIDES, form_factors, sent_by_sides
from ashe_live.light.known_body.sides.facets import Facets
from ashe_live.light.known_body.table import SIDE, places
from ashe_live.tracking.cube.faces import CORNERS

EDGE_M = 0.06
CUBE = Proxy("box", np.column_stack([EDGE_M * CORNERS, np.zeros((8, 2))]))
FACTORS = form_factors(CUBE)
MIDDLE, RAYS = SIDE // 2, 200_000


@pytest.mark.parametrize("cell", [(4, 0), (5, 3), (9, -4), (6, 8)])
def test_form_factors_are_those_of_rays(cell: tuple[int, int]) -> None:
    rng = np.random.default_rng(1)
    sine, turn = np.sqrt(rng.random(RAYS)), rng.uniform(0, 2 * math.pi, RAYS)
    rays = np.column_stack([sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1 - sine**2)])
    x, y = (float(places(CUBE)[MIDDLE + each]) for each in cell)
    along = (EDGE_M / 2 - x) / rays[:, 0]  # to the plane of the side that faces x
    is_hit = (along > 0) & (np.abs(y + along * rays[:, 1]) < EDGE_M / 2) & (along * rays[:, 2] < EDGE_M)
    assert FACTORS[0, MIDDLE + cell[1], MIDDLE + cell[0]] == pytest.approx(is_hit.mean(), abs=0.004)


def test_no_side_lights_what_lies_behind_it() -> None:
    along = places(CUBE)
    for normal, factors in zip(SIDES, FACTORS, strict=True):
        behind = along[None] * normal[0] + along[:, None] * normal[1] < EDGE_M / 2
        assert not factors[behind].any()
        assert 0 < factors.max() < 0.5


def facets(side: float) -> Facets:
    light = np.array([(0.5, 0.5, 0.5), (side, side, side)])
    normals = np.array([(0.0, 0.0, 1.0), SIDES[0]])
    return Facets(normals, light, np.zeros((2, 3)), np.zeros(2, bool), np.full(2, 50.0))


def test_a_side_twice_as_bright_sends_twice_as_much_before_it_and_nothing_elsewhere() -> None:
    sent, twice = (sent_by_sides(FACTORS, facets(side)) for side in (0.4, 0.8))
    assert twice == pytest.approx(2 * sent, rel=1e-5)
    assert sent[MIDDLE, MIDDLE + 4].min() > 0.1
    assert not sent[:, : MIDDLE + 3].any()
