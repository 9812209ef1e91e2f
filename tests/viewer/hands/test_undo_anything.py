"""Whatever is done by hand, undoing leads back through the same states, one after the other, to the first."""

import random
from itertools import groupby

import pytest

from ashe_live.models.placement import UNMOVED, Placement
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.hands.requests import Command, Drag, Request
from ashe_live.viewer.session import Session
from ashe_live.viewer.table.shelf import UPS

DRAG = Drag((30.0, 20.0), (40.0, 22.0), is_first=True)
REQUESTS = (
    *(Request(command, (1, 0)) for command in (Command.MOVE_LIGHT, Command.MOVE_MODEL)),
    *(Request(command, (0, -1)) for command in (Command.MOVE_LIGHT, Command.MOVE_MODEL)),
    *(Request(command, DRAG) for command in (Command.MOVE_LIGHT, Command.MOVE_MODEL)),
    *(Request(command, 1) for command in (Command.SCALE_MODEL, Command.TURN_MODEL, Command.LIGHT_DISTANCE)),
    *(Request(command, -1) for command in (Command.LIGHT_STRENGTH, Command.LIGHT_COLOUR, Command.LIGHT_DISTANCE)),
    *(Request(command) for command in (Command.ADD_MODEL, Command.REMOVE_MODEL, Command.NEXT_IN_HAND)),
    *(Request(command) for command in (Command.TURN_UP, Command.RESET)),
)
SEQUENCES, LONGEST = 40, 12
SLOWLY_S = 1.0  # between two requests, so that each is a gesture of its own


@pytest.fixture
def session(fakes) -> Session:
    class Shelf(fakes.Shelf):
        """Remembers, as the real one does, how models were left and which side of theirs is up."""

        def __init__(self) -> None:
            super().__init__()
            self.left: dict[tuple[str, str], Placement] = {}

        def turn_up(self, by: int = 1) -> str:
            self.turned = (self.turned + by) % len(UPS)
            return UPS[self.turned]

        def placement(self, name: str, where: str) -> Placement:
            return self.left.get((name, where), UNMOVED)

        def keep_placement(self, name: str, where: str, placement: Placement) -> None:
            self.left[name, where] = placement

    return Session(Shelf(), fakes.Worker(), FirstEstimate(Steadiness(3)))


def state(session: Session) -> str:
    """All that can be undone; not which model is in the hand, as a drag may take up one and move it."""
    stands = [(stand.name, stand.placement, stand.seat) for stand in session.arrangement.stands]
    by_hand = session.hand.light
    lights = None if by_hand is None else by_hand.lights
    return repr((stands, lights, session.table.shelf.turned))


@pytest.mark.parametrize("seed", range(SEQUENCES))
def test_undoing_leads_back_through_the_same_states_to_the_first(session, fakes, seed):
    rng, now_s = random.Random(seed), 0.0

    def obey(request: Request) -> str:
        nonlocal now_s
        now_s += SLOWLY_S
        session.take(fakes.tracked(int(now_s)), now_s)
        session.handle(request, now_s)
        session.poll(now_s)
        return state(session)

    session.take(fakes.tracked(), now_s)
    session.poll(now_s)
    states = [state(session)]
    states += [obey(rng.choice(REQUESTS)) for _ in range(rng.randint(1, LONGEST))]
    before = [each for each, _ in groupby(states)]
    for _ in range(2 * LONGEST):
        now = obey(Request(Command.UNDO))
        if session.notice.text.startswith("nothing was done by hand"):
            break
        if now != before[-1]:  # else another model was taken up, which changes nothing that is compared
            before.pop()
        assert now == before[-1]
    assert before == [now]
