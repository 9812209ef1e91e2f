"""The presets of the estimator `proxy`: how much work it spends."""

from dataclasses import dataclass, replace

from ashe_live.core.caster import Caster
from ashe_live.light.ground.preset import COARSE, GroundPreset
from ashe_live.light.lamps.kinds import AUTO, KINDS
from ashe_live.light.outline_fit import preset as fitting
from ashe_live.light.outline_fit.preset import FitPreset

FIRST_FIT = fitting.FAST  # of splits, where nothing is known of the object


@dataclass(frozen=True, slots=True)
class ProxyPreset:
    """How much work the estimator spends: the counts and sizes that the presets differ in."""

    coarse_width_px: int  # at which the ground is modelled and unlit regions are found
    fine_width_px: int  # width of the frame at the finest resolution used
    region_px: int  # size to which a region is scaled
    regions: int
    shifts: int  # colour shifts of a shadow that are tried; as many narrower modes are found for pairs
    tried: int  # number of splits that are fitted, the best-looking
    refined: int  # number of fits that are relabelled and refitted, the likeliest
    ground: GroundPreset
    fine_fit: FitPreset  # for refitting those; the first fit is the same in all presets, except for the caster
    views: int  # number of views that are used together, the frame's own included
    companions: int  # number of the other views that explanations are looked for in at most, as in the frame itself
    joint: int  # number of explanations that are aligned in all views, the likeliest
    light: str = AUTO  # one of KINDS: what kind of light is assumed
    second_look: "ProxyPreset | None" = None  # at the same picture at another scale, where it is the only view

    def __post_init__(self) -> None:
        if self.light not in KINDS:
            raise ValueError(f"light {self.light!r} is not one of {', '.join(KINDS)}")

    def assuming(self, light: str = AUTO, caster: Caster | None = None) -> "ProxyPreset":
        """The same for one kind of light, of KINDS, and an object whose shape and size are known; None: any object."""
        second_look = self.second_look and self.second_look.assuming(light, caster)
        fine_fit = replace(self.fine_fit, caster=caster)
        return replace(self, light=light, fine_fit=fine_fit, second_look=second_look)

    @property
    def caster(self) -> Caster | None:
        """The object that casts the shadow, where its shape and size are known."""
        return self.fine_fit.caster

    @property
    def first_fit(self) -> FitPreset:
        """That of the selected splits."""
        return replace(FIRST_FIT, caster=self.caster)

    @property
    def looks(self) -> tuple["ProxyPreset", ...]:
        """The looks at a single picture, each with a preset of its own, whose probabilities are averaged."""
        further = self.second_look.looks if self.second_look else ()
        return replace(self, second_look=None), *further


FAST = ProxyPreset(
    coarse_width_px=240,
    fine_width_px=480,
    region_px=90,
    regions=2,
    shifts=5,
    tried=6,
    refined=2,
    ground=COARSE,
    fine_fit=fitting.FAST,
    views=4,
    companions=0,
    joint=2,
)
BALANCED = ProxyPreset(
    coarse_width_px=320,
    fine_width_px=640,
    region_px=100,
    regions=3,
    shifts=8,
    tried=10,
    refined=2,
    ground=GroundPreset(),
    fine_fit=fitting.BALANCED,
    views=8,
    companions=3,
    joint=3,
)
# Two looks find the right explanation in the same place, but wrong ones in different places: a second opinion is worth
# more than a longer search, which finds more wrong explanations too. It sees all edges between other pixels.
ACCURATE = replace(
    BALANCED, views=12, companions=4, joint=4, second_look=replace(BALANCED, coarse_width_px=280, fine_width_px=560)
)
