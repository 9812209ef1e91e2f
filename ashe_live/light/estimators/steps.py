"""How much work the estimator `proxy` spends: its presets."""

from dataclasses import dataclass

from ashe_live.light.ground.lit_ground import GroundSteps
from ashe_live.light.outline_fit import fit
from ashe_live.light.outline_fit.fit import FitPreset

FIRST_FIT = fit.FAST  # of the splits that look best


@dataclass(frozen=True, slots=True)
class ProxySteps:
    """How much work the estimator spends: the numbers that the presets differ in."""

    coarse_width_px: int  # at which the ground is modelled and unlit regions are found
    fine_width_px: int  # no region is looked at more finely than in a frame of this width
    region_px: int  # size at which a region is looked at
    regions: int
    shifts: int  # of a shadow's colour that are tried; as many are found more finely, to be paired
    tried: int  # how many of the splits are fitted, those that look best
    refined: int  # how many of the fits are worked out, the best ones
    ground: GroundSteps
    fine_fit: FitPreset  # of those that are worked out; the first one is the same for all


FAST = ProxySteps(
    coarse_width_px=240,
    fine_width_px=480,
    region_px=90,
    regions=2,
    shifts=5,
    tried=4,
    refined=2,
    ground=GroundSteps(12, 8, 1),
    fine_fit=fit.FAST,
)
BALANCED = ProxySteps(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=3,
    shifts=8,
    tried=6,
    refined=2,
    ground=GroundSteps(),
    fine_fit=fit.BALANCED,
)
ACCURATE = ProxySteps(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=4,
    shifts=12,
    tried=16,
    refined=4,
    ground=GroundSteps(),
    fine_fit=fit.BALANCED,
)


PRESETS = {"fast": FAST, "balanced": BALANCED, "accurate": ACCURATE}
