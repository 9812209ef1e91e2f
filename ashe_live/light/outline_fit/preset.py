"""The presets of the fit: how much work it spends."""

from dataclasses import dataclass

from ashe_live.core.caster import Caster
from ashe_live.light.shape.families import FAMILIES


@dataclass(frozen=True, slots=True)
class FitPreset:
    """How much work the fit spends."""

    directions: int  # in which outlines are compared
    families: tuple[str, ...]  # tried in this order, each after the one that it grows from
    iterations: int
    sufficient_rms: float  # residual, in sigmas of the masks' edges, below which no further families are tried
    caster: Caster | None = None  # the body, where its shape and size are known: in the place of the families
    resizes: bool = False  # whether the caster's sizes are fitted as well, as if they had been measured wrong


FAST = FitPreset(32, ("frustum", "box", "sphere", "vase", "lump"), 8, 1.5)
BALANCED = FitPreset(40, tuple(FAMILIES), 10, 1.25)
