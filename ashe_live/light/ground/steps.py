"""How finely the lit ground is modelled: what the estimator's presets set, without what it takes to do it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GroundSteps:
    """How finely the ground is modelled."""

    spread_colours: int = 20  # clusters whose spread over the frame is measured
    palette_colours: int = 10  # clusters of the lit ground
    field_rounds: int = 2
