"""Probabilities after a look at a shadow's edges stay probabilities, however sure and however wrong a direction is."""

import numpy as np
import pytest

from ashe_live.light.known_body.outline.fit import ShadowFit
from ashe_live.light.known_body.outline.odds import with_edges
from tests.light.known_body.test_shadow_edges import view


def fit(clear: float) -> ShadowFit:
    return ShadowFit(np.array((0.0, 0.0, 1.0, 0.0)), np.eye(2), None, 0.3, 0.05, clear, 1.0, view())


@pytest.mark.parametrize("confidence", [0.0, 1e-12, 0.5, 0.99, 1 - 1e-9, 1.0])
@pytest.mark.parametrize("clear", np.linspace(0, 1, 41))
def test_it_stays_a_probability(confidence: float, clear: float) -> None:
    assert 0 <= with_edges(confidence, fit(clear), depth=0.5) <= 1


def test_edges_that_are_seen_speak_for_a_light_and_missing_ones_against_it() -> None:
    assert with_edges(0.5, fit(0.1), depth=0.5) < 0.1 < 0.9 < with_edges(0.5, fit(1.0), depth=0.5)
    assert with_edges(0.9, fit(1.0), depth=0.05) == 0  # no light casts so pale a shadow
