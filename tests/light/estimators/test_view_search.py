"""What a view's search counts as found already, in a world of any size."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.caster import Caster as Known
from ashe_live.core.light import StageClock
from ashe_live.light.estimators import view_search
from ashe_live.light.estimators.looking import looked
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.estimators.proposals import proposals_of
from ashe_live.light.estimators.view_search import _is_same
from ashe_live.light.explanation.explain import Proposal
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.searches.known_place import explanations_by_place
from ashe_live.light.ground.regions import Region
from ashe_live.light.shape.body import BodyFrame
from tests.light.painted_bodies import explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, paint


def test_a_view_is_split_once_whatever_object_is_looked_for_in_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the known object is not found, and places are sought in the lights that any object may show."""
    split, by_place = [], []

    def counted(region: Region, *how) -> Iterator[Proposal]:
        split.append(region)
        return proposals_of(region, *how)

    def placed(*what):
        by_place.append(what)
        return explanations_by_place(*what)

    monkeypatch.setattr(view_search, "proposals_of", counted)
    monkeypatch.setattr(view_search, "explanations_by_place", placed)
    wrong = FAST.assuming(caster=Known.sphere(0.09))
    trace = looked(paint(BOX).tracked, (), wrong, fitted_judge(), StageClock()).trace
    assert by_place
    assert split == trace.regions


@pytest.mark.parametrize("times", [0.1, 1.0, 10.0])
def test_a_known_object_is_at_another_place_where_that_is_apart_for_its_size(times: float) -> None:
    truth = explanation_of(painted_region(BOX))
    lit = truth.lit

    def standing(moved: float) -> Explanation:
        """In a world so many times as large, moved by so many of the object's sizes."""
        frame = lit.body.frame
        origin = times * (frame.origin_marker + moved * frame.unit_m * np.array([0.6, 0.8]))
        body = replace(lit.body, frame=BodyFrame(origin, times * frame.unit_m))
        placed = replace(truth.alignment.placed, lit=replace(lit, body=body))
        return replace(truth, alignment=replace(truth.alignment, placed=placed))

    assert _is_same(standing(0.0), standing(0.01))
    assert not _is_same(standing(0.0), standing(0.08))
