"""What a view's search counts as found already, in a world of any size."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.light.estimators.view_search import _is_same
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.shape.body import BodyFrame
from tests.light.painted_bodies import explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX


@pytest.mark.parametrize("times", [0.1, 1.0, 10.0])
def test_a_known_object_is_at_another_place_where_that_is_apart_for_its_size(times: float) -> None:
    truth = explanation_of(painted_region(BOX))
    lit = truth.alignment.placed.lit

    def standing(moved: float) -> Explanation:
        """In a world so many times as large, moved by so many of the object's sizes."""
        frame = lit.body.frame
        origin = times * (frame.origin_marker + moved * frame.unit_m * np.array([0.6, 0.8]))
        body = replace(lit.body, frame=BodyFrame(origin, times * frame.unit_m))
        placed = replace(truth.alignment.placed, lit=replace(lit, body=body))
        return replace(truth, alignment=replace(truth.alignment, placed=placed))

    assert _is_same(standing(0.0), standing(0.01))
    assert not _is_same(standing(0.0), standing(0.08))
