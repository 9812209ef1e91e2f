"""How far a body's outline and its shadows' lie from the steps of light in a picture."""

from dataclasses import dataclass

from ashe_live.core.arrays import Float

FEWEST_STEPS = 6  # of an outline's 48 points: with fewer, a shadow is hidden, and goes where it likes
MISSED = 9.0  # squared sigmas that a point costs at most, and where no step is found though one should be seen


@dataclass(frozen=True, slots=True)
class StepCosts:
    """Mean squared distances of outlines from the steps of light, in sigmas, each point's MISSED at most."""

    body: float
    shadow: float  # of all lights' shadows; MISSED where one is hidden: it misses no steps, but is no evidence either

    @property
    def show_shadow(self) -> bool:
        """Whether there are steps of light beside the shadows of all lights."""
        return self.shadow < MISSED


NO_STEPS = StepCosts(MISSED, MISSED)


def mean_costs(cost: Float, count: Float, shadow_steps: int) -> StepCosts:
    """The costs on average; cost, count: (1 + l,) sums over points of the body's outline and of each shadow's.

    shadow_steps: points of a shadow's outline at which there is a step; of two shadows, of that with fewer.
    """
    shadow, points = cost[1:].sum(), count[1:].sum()
    return StepCosts(
        float(cost[0] / count[0]) if count[0] else MISSED,
        float(shadow / points) if shadow_steps >= FEWEST_STEPS else MISSED,
    )
