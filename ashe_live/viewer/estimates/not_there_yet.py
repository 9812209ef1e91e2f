"""What is said where the arrow, or the steps to the answer, are to be shown and are not there: until they are."""

from ashe_live.light.estimators.estimator import WITHOUT_TRACE
from ashe_live.viewer.estimates.light_watch import LightWatch, NewAnswer
from ashe_live.viewer.notice import Notice

NO_ARROW_YET = "the arrow appears when the light is known"
NO_ANSWER_YET = "nothing has been estimated yet"
ANSWER_ALONE = "this is the answer alone: Space shows the steps to it"
NO_STEPS = "this is the answer alone: the estimator keeps no steps to it"  # and Space would not show any


class NotThereYet:
    """Says what is lacking, and withdraws that once it is there or no longer to be shown."""

    def __init__(self, notice: Notice, watch: LightWatch) -> None:
        self._notice, self._watch = notice, watch

    def show_light(self, now_s: float) -> None:
        """The arrow is to be shown, and no light is known."""
        self._notice.say(f"{NO_ARROW_YET}: {self._watch.how_it_gets_known}", now_s)

    def show_steps(self, answer: NewAnswer | None, now_s: float) -> None:
        """The steps to `answer` are to be shown, if there are any."""
        if answer is None:
            self._notice.say(f"{NO_ANSWER_YET}: {self._watch.how_it_gets_known}", now_s)
        elif answer.steps_bgr is None:
            self._say_alone(answer, now_s)

    def hide_light(self) -> None:
        self._notice.withdraw(NO_ARROW_YET)

    def hide_steps(self) -> None:
        for said in (ANSWER_ALONE, NO_STEPS, NO_ANSWER_YET):
            self._notice.withdraw(said)

    def take_light(self) -> None:
        """A light is known."""
        self._notice.withdraw(NO_ARROW_YET)

    def take_answer(self, answer: NewAnswer, shows_steps: bool, now_s: float) -> None:
        """There is an answer. `shows_steps`: whether the steps to it are to be shown."""
        self._notice.withdraw(NO_ANSWER_YET)
        if answer.estimate.light is not None:
            self.take_light()
        if answer.steps_bgr is not None:
            self._notice.withdraw(ANSWER_ALONE)
        elif shows_steps:
            self._say_alone(answer, now_s)

    def _say_alone(self, answer: NewAnswer, now_s: float) -> None:
        self._notice.say(NO_STEPS if answer.estimate.estimator in WITHOUT_TRACE else ANSWER_ALONE, now_s)
