"""The trace of an estimate: its intermediate results."""

from dataclasses import dataclass, field

from ashe_live.core.arrays import Mask
from ashe_live.light.explanation.explain import Proposal
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.glint import Glint
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.sheet_shadow import SheetShadow
from ashe_live.light.pixels.view import View


@dataclass(slots=True, eq=False)
class Trace:
    """Filled in by the stages in this order; None or empty for stages that were not reached."""

    view: View  # at the size at which the ground is modelled
    ground: LitGround | None = None
    sheet_shadow: SheetShadow | None = None
    glint: Glint | None = None
    unlit: Mask | None = None  # (h, w) of `view`: pixels that the lit ground does not explain
    regions: list[Region] = field(default_factory=list)
    proposals: list[Proposal] = field(default_factory=list)  # those that were fitted
    rough: list[Explanation] = field(default_factory=list)  # the proposals, fitted and aligned
    # What the judge chose from: the likeliest different ones, relabelled and refitted; then the other fitted ones.
    judged: list[Explanation] = field(default_factory=list)
    probabilities: list[float] = field(default_factory=list)  # of each of `judged` to be the right one


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A look at a picture: what it may show, and the views of the scene that this rests on, its own first."""

    trace: Trace
    views: list[SceneView]  # none where too little of the ground is lit
