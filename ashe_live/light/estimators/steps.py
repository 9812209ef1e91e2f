"""How much work the estimator `proxy` spends: its presets."""

from dataclasses import dataclass

from ashe_live.light.ground.lit_ground import GroundSteps
from ashe_live.light.outline_fit import fit as fitting


@dataclass(frozen=True, slots=True)
class ProxySteps:
    """How much work the estimator spends: the numbers that the presets differ in."""

    coarse_width_px: int  # at which the ground is modelled and unlit regions are found
    fine_width_px: int  # no region is looked at more finely than in a frame of this width
    region_px: int  # size at which a region is looked at
    regions: int
    shifts: int  # of a shadow's colour that are tried; as many are found more finely, to be paired
    pairs: int  # of those that are tried, one for each of two lights
    shadows_per_shift: int
    tried: int  # how many of the splits are fitted, those that look best
    pairs_tried: int  # and how many of those into two lights' shadows
    refined: int  # how many of the fits are worked out, the best ones
    rounds: int  # of relabelling by the fit and fitting to the labels
    ground: GroundSteps
    first_fit: fitting.FitPreset
    fine_fit: fitting.FitPreset


FAST = ProxySteps(
    coarse_width_px=240,
    fine_width_px=480,
    region_px=90,
    regions=2,
    shifts=5,
    pairs=1,
    shadows_per_shift=2,
    tried=4,
    pairs_tried=1,
    refined=2,
    rounds=1,
    ground=GroundSteps(12, 8, 1),
    first_fit=fitting.FAST,
    fine_fit=fitting.FAST,
)
BALANCED = ProxySteps(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=3,
    shifts=8,
    pairs=1,
    shadows_per_shift=2,
    tried=6,
    pairs_tried=1,
    refined=2,
    rounds=1,
    ground=GroundSteps(),
    first_fit=fitting.FAST,
    fine_fit=fitting.BALANCED,
)
ACCURATE = ProxySteps(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=4,
    shifts=12,
    pairs=1,
    shadows_per_shift=2,
    tried=16,
    pairs_tried=1,
    refined=4,
    rounds=1,
    ground=GroundSteps(),
    first_fit=fitting.FAST,
    fine_fit=fitting.BALANCED,
)


PRESETS = {"fast": FAST, "balanced": BALANCED, "accurate": ACCURATE}
