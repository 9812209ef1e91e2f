"""An explanation: what a region of the picture may show, and the light that follows from that."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between
from ashe_live.light.edges.nearness import NearnessBySteps
from ashe_live.light.edges.step_costs import NO_STEPS, StepCosts
from ashe_live.light.explanation.alignment import Alignment
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import Materials
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.light_points import towards
from ashe_live.light.shape.predicted import Predicted

LIKELY_FAMILIES = 4  # number of families, the likeliest by the labels' outlines, that finer evidence decides between


@dataclass(frozen=True, eq=False)
class Explanation:
    """A region explained as an object and its shadow, and the light that follows from that."""

    region: Region
    materials: Materials
    split: Split
    alignment: Alignment
    lights: tuple[FittedLight, ...]
    as_object: Float32  # (h, w) unary cost of the object's colours
    bodies: tuple[LitBody, ...] = ()  # the best of each family by the labels' outlines, the likeliest first
    steps: StepCosts = NO_STEPS  # of light at full resolution, if they were measured
    # Information criterion of the outlines by steps of light and unary costs, in penalties of one parameter; inf where
    # no body was moved onto steps.
    criterion: float = math.inf
    nearness: NearnessBySteps | None = None  # of the first light, where that was free in the fit to steps of light
    # Deviance of a sun by the outlines, beside a lamp that was tried: negative where these show the shadow of a sun; 0
    # where none was tried.
    sun_by_outlines: float = 0.0
    hull: Proxy | None = None  # of the object's silhouettes in several views, where no family explains these

    @property
    def costs(self) -> Costs:
        """What the region's pixels cost."""
        return Costs(self.region, self.materials, self.as_object)

    @property
    def shifts(self) -> tuple[Float, ...]:
        """(3,) each light's shift of the ground's colours in its shadow."""
        return self.materials.shifts[: len(self.lights)]

    @property
    def lit(self) -> LitBody:
        """The fitted body with its lights."""
        return self.alignment.placed.lit

    @property
    def predicted(self) -> Predicted:
        return self.alignment.placed.predicted

    @property
    def proxy(self) -> Proxy:
        """The fitted member of a family."""
        return self.lit.body.proxy

    @property
    def to_light_from_body(self) -> Float:
        """(3,) the unit vector from the middle of the body towards the first light.

        A shadow determines it best: for the same labels, the fits of a sun and of a lamp agree there, if nowhere else.
        """
        body = self.lit.body
        return towards(self.lights[0].light, np.array([*body.frame.origin_marker, body.middle_m]))

    @property
    def real_object(self) -> Proxy:
        """What stands in the place of the real object: the hull where there is one, else the fitted body."""
        return self.hull or self.proxy

    def stands_as(self, other: "Explanation", apart_share: float) -> bool:
        """Whether both bodies stand within a share of the smaller one's size of each other.

        By where the bodies stand, and not by their frames' origins, from which a fit moves them.
        """
        apart_m = np.linalg.norm(self.proxy.foot_marker - other.proxy.foot_marker)
        return bool(apart_m <= apart_share * min(self.lit.body.frame.unit_m, other.lit.body.frame.unit_m))

    def is_like(self, other: "Explanation", apart_share: float, turned_rad: float) -> bool:
        """Whether both have as many lights, each within an angle, and their bodies stand within a share of a size."""
        if len(self.lights) != len(other.lights) or not self.stands_as(other, apart_share):
            return False
        pairs = zip(self.lights, other.lights, strict=True)
        return all(angle_between(a.to_light_marker, b.to_light_marker) < turned_rad for a, b in pairs)
