"""When a hull stands for an object in a family's place."""

from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.light.hull.explained import explains_more
from ashe_live.light.shape.predicted import Predicted

SHAPE = (20, 20)


@pytest.mark.parametrize(
    ("unexplained", "by_hull", "is_better"),
    [
        (40, 10.0, True),  # 40 of 100 pixels of the body, 10 each, and little is left
        (4, 0.0, False),  # what a family misses by a border's pixels is no other shape
        (40, 330.0, False),  # the hull leaves nearly as much: neither has the silhouettes
    ],
)
def test_it_explains_much_of_what_the_family_leaves(unexplained: int, by_hull: float, is_better: bool) -> None:
    body, dear = np.zeros(SHAPE, np.bool_), np.zeros(SHAPE, np.float32)
    body[:10, :10] = True
    dear[:10, :10].flat[:unexplained] = 10.0
    explanation = SimpleNamespace(each=[SimpleNamespace(predicted=Predicted(body, ~body & False))])
    hull = SimpleNamespace(views=[SimpleNamespace(cost=lambda body, _shadow: float(dear[body].sum()))])
    assert explains_more(explanation, hull, SimpleNamespace(cost=by_hull)) == is_better
