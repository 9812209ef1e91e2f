"""A session with stand-ins behind it, which is told in few words what happens."""

from dataclasses import replace

import numpy as np

from ashe_live.core.light import LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import rigid
from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.worker_messages import WorkerFailure
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.estimates.light_watch import NewAnswer
from ashe_live.viewer.hands.requests import Argument, Command, Request
from ashe_live.viewer.session import Session


class ScriptedSession(Session):
    """`worker` is the stand-in that it asks for estimates."""

    def __init__(self, fakes, first: FirstEstimate, **how) -> None:
        self.worker = fakes.Worker()
        super().__init__(fakes.Shelf(), self.worker, first, **how)

    def press(self, command: Command, argument: Argument = 0, now_s: float = 0.0) -> bool:
        return self.handle(Request(command, argument), now_s)

    def set_by_hand(self, now_s: float) -> None:
        """A person moves the light a step aside."""
        self.press(Command.MOVE_LIGHT, (1, 0), now_s)
        self.poll(now_s)

    def answered(self, answer: LightEstimate | WorkerFailure, now_s: float) -> NewAnswer | None:
        """The worker answers what it was asked."""
        self.worker.answer = answer
        return self.poll(now_s)

    def estimated(
        self, answer: LightEstimate, asked_s: float = 0.0, answered_s: float | None = None
    ) -> NewAnswer | None:
        """A person asks for an estimate, and gets this one, at once unless it is said when."""
        self.request_estimate(asked_s)
        return self.answered(answer, asked_s if answered_s is None else answered_s)


def on_cube(tracked: TrackedFrame) -> TrackedFrame:
    """The frame with its marker on a body."""
    body = Proxy("box", [(0.0, 0.0, 0.03, 0.03, 0.03)])
    return replace(tracked, marker=replace(tracked.marker, body=body))


def placed(turn_deg: float) -> np.ndarray:
    """T_room_marker of a sheet that is turned on its table."""
    cosine, sine = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    return rigid([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], (0, 0, 0))


def lying(tracked: TrackedFrame, turn_deg: float) -> TrackedFrame:
    """The frame with its sheet turned so on the table."""
    return replace(tracked, T_room_marker=placed(turn_deg))
