"""A trace: what an estimator found on its way to an answer."""

import math
from dataclasses import dataclass, field

from ashe_live.core.arrays import Mask
from ashe_live.light.explanation.evidence import Explanation
from ashe_live.light.explanation.explain import Proposal
from ashe_live.light.explanation.judge import log_odds
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.pixels.view import View


@dataclass(slots=True, eq=False)
class Trace:
    """Filled in on the way, in this order; what was not come to is None or empty."""

    view: View  # at the size at which the ground is modelled
    ground: LitGround | None = None
    unlit: Mask | None = None  # (h, w) of `view`: what the lit ground does not explain
    regions: list[Region] = field(default_factory=list)
    proposals: list[Proposal] = field(default_factory=list)  # those that were worth a fit
    rough: list[Explanation] = field(default_factory=list)  # fitted and aligned
    refined: list[Explanation] = field(default_factory=list)  # and worked out: the likeliest of them that differ

    def probabilities(self) -> list[float]:
        """That each of `refined` is right and its direction a good one, by its own evidence."""
        return [1 / (1 + math.exp(-log_odds(explanation))) for explanation in self.refined]
