"""How finely the lit ground is modelled: the part of the estimator's presets that concerns it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GroundPreset:
    """How finely the ground is modelled."""

    spread_colours: int = 20  # clusters whose spread over the frame is measured
    palette_colours: int = 10  # clusters of the lit ground
    field_rounds: int = 2


COARSE = GroundPreset(12, 8, 1)  # for the preset `fast`, and for small or averaged pictures, which have few colours
