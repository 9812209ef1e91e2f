"""What is said of an arrow or of steps that are not there yet stays until they are."""

from dataclasses import replace

import pytest

from ashe_live.light.estimators.estimator import ESTIMATORS, WITHOUT_TRACE, TracingEstimator, make_estimator
from ashe_live.viewer.estimates.light_watch import LightWatch, NewAnswer
from ashe_live.viewer.estimates.not_there_yet import (
    ANSWER_ALONE,
    NO_ANSWER_YET,
    NO_ARROW_YET,
    NO_STEPS,
    NotThereYet,
)
from ashe_live.viewer.notice import Notice


@pytest.fixture
def stage(fakes):
    """The notice, what is said in it, and an answer with or without a light and a picture of the steps."""
    notice = Notice()

    def answer(with_light: bool, with_steps: bool) -> NewAnswer:
        steps = fakes.tracked().frame.image_bgr if with_steps else None
        return NewAnswer(fakes.estimate(with_light=with_light), fakes.tracked(), 0.0, steps, is_news=True)

    return notice, NotThereYet(notice, LightWatch(fakes.Worker())), answer


@pytest.mark.parametrize("with_light", [True, False])
def test_that_there_is_no_arrow_is_said_until_a_light_is_known(stage, with_light) -> None:
    notice, there, answer = stage
    there.show_light(0.0)
    assert NO_ARROW_YET in notice.shown(0.1)
    there.take_answer(answer(with_light, with_steps=True), False, 0.1)
    assert (notice.shown(0.2) is None) is with_light


@pytest.mark.parametrize("shows_steps", [True, False])
@pytest.mark.parametrize("with_steps", [True, False])
def test_that_there_are_no_steps_is_said_while_they_are_to_be_shown(stage, with_steps, shows_steps) -> None:
    notice, there, answer = stage
    there.show_steps(None, 0.0)
    assert NO_ANSWER_YET in notice.shown(0.1)
    there.take_answer(answer(True, with_steps), shows_steps, 0.1)
    assert notice.shown(0.2) == (ANSWER_ALONE if shows_steps and not with_steps else None)
    there.hide_steps()
    assert notice.shown(0.2) is None
    there.show_steps(answer(True, with_steps), 0.3)
    assert notice.shown(0.4) == (None if with_steps else ANSWER_ALONE)
    there.take_answer(answer(True, with_steps=True), True, 0.5)
    assert notice.shown(0.6) is None


@pytest.mark.parametrize("name", ESTIMATORS)
def test_space_is_said_to_show_the_steps_only_where_the_estimator_keeps_them(stage, name) -> None:
    assert isinstance(make_estimator(name), TracingEstimator) is (name not in WITHOUT_TRACE)
    notice, there, answer = stage
    alone = answer(True, with_steps=False)
    alone = replace(alone, estimate=replace(alone.estimate, estimator=name))
    there.show_steps(alone, 0.0)
    assert notice.shown(0.1) == (NO_STEPS if name == "paper" else ANSWER_ALONE)
    there.hide_steps()
    assert notice.shown(0.2) is None
    there.take_answer(alone, True, 0.3)
    assert notice.shown(0.4) == (NO_STEPS if name == "paper" else ANSWER_ALONE)
