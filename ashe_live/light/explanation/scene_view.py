"""A view of the scene that explanations are looked for in: at the two sizes that this works at, with its lit ground."""

from dataclasses import dataclass

from ashe_live.core.arrays import Mask
from ashe_live.light.ground.lit_ground import LitGround, unlit_mask
from ashe_live.light.ground.regions import Region, region_of
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.predicted import predicted_of


@dataclass(frozen=True, slots=True, eq=False)
class SceneView:
    """A view at its finest and at the ground's resolution, with the lit ground in it."""

    index: int  # of its frame
    fine: View
    coarse: View
    ground: LitGround  # fitted to `coarse`

    def unlit(self, least_px: int) -> Mask:
        """(h, w) of `coarse`: areas of at least `least_px` pixels that the lit ground does not explain."""
        return unlit_mask(self.ground, self.coarse.is_ground, least_px)

    def ground_under(self, lit: LitBody) -> Mask:
        """(h, w) of `coarse`: the ground that a body and its shadows cover."""
        return predicted_of(lit, self.coarse).whole & self.coarse.is_ground

    def region(self, area: Mask, size_px: int) -> Region:
        """The part of the view that holds `area`, (h, w) of `coarse`, scaled to `size_px`."""
        return region_of(self.fine, area, self.ground, size_px)
