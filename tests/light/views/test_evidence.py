"""What several views say for an explanation."""

import numpy as np
import pytest

from ashe_live.light.explanation.judgement.judge import best_direction, probabilities_of
from ashe_live.light.views.evidence import no_less_sure
from tests.light.synthetic_masks import direction

HERE, NEARBY, ELSEWHERE = direction(200, 40), direction(203, 41), direction(80, 50)


def share(directions: list[np.ndarray], log_odds: list[float]) -> float:
    return best_direction(probabilities_of(log_odds), directions)[1]


def test_a_direction_that_all_views_confirm_is_as_likely_as_by_the_first() -> None:
    directions, alone = [HERE, NEARBY, ELSEWHERE], [NEARBY, ELSEWHERE]
    raised = no_less_sure(directions, [0.5, -1.0, -0.5], alone, [3.0, -2.0])
    assert share(directions, raised) == pytest.approx(share(alone, [3.0, -2.0]))
    # What explains the same direction keeps its share of it, and what explains another its odds against none.
    assert raised[0] - raised[1] == pytest.approx(1.5)
    assert raised[2] == -0.5


def test_views_that_are_surer_than_the_first_stay_so() -> None:
    assert no_less_sure([HERE, ELSEWHERE], [4.0, -1.0], [HERE], [1.0]) == [4.0, -1.0]


def test_views_that_contradict_the_first_are_right() -> None:
    assert no_less_sure([HERE], [0.5], [ELSEWHERE], [5.0]) == [0.5]


def test_the_surest_view_leaves_odds_finite() -> None:
    assert np.isfinite(no_less_sure([HERE], [-50.0], [HERE], [50.0])).all()


@pytest.mark.parametrize(("all_views", "first"), [([], [1.0]), ([1.0], [])])
def test_without_explanations_nothing_changes(all_views: list[float], first: list[float]) -> None:
    assert no_less_sure([HERE] * len(all_views), all_views, [HERE] * len(first), first) == all_views
