"""A view of the scene at the two sizes that the estimator works at, with its own lit ground."""

from dataclasses import dataclass

from ashe_live.core.arrays import Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region, region_of
from ashe_live.light.pixels.view import View


@dataclass(frozen=True, slots=True, eq=False)
class SceneView:
    """A view at its finest and at the ground's resolution, with the lit ground in it."""

    index: int  # of its frame
    fine: View
    coarse: View
    ground: LitGround  # fitted to `coarse`

    def region(self, area: Mask, size_px: int) -> Region:
        """The part of the view that holds `area`, (h, w) of `coarse`, scaled to `size_px`."""
        return region_of(self.fine, area, self.ground, size_px)
