"""What the pixels of a region cost, taken for what a body and its shadows would make of them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ashe_live.core.arrays import Float32, Mask, set_frozen
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.materials import Materials
from ashe_live.light.pixels.areas import grown
from ashe_live.light.shape.predicted import Predicted

BESIDE_BODY_PX = 2


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """What a picture says of an outline."""

    gain: Float32  # (h, w) how much less a pixel costs inside of the outline than outside
    trusted: Mask  # (h, w) where that is known
    visible: Mask  # (h, w) where a border can be seen


@dataclass(frozen=True, slots=True, eq=False)
class Costs:
    """The unary costs of a region: what each pixel costs as lit ground, shadow and object."""

    region: Region
    materials: Materials
    as_object: Float32  # (h, w) unary cost of taking a pixel for the object
    trusted: Mask = field(init=False)  # (h, w)

    def __post_init__(self) -> None:
        set_frozen(self, trusted=~self.region.unreliable)

    def of(self, masks: Predicted) -> float:
        """Of all the ground in the region, each pixel taken for what the masks say."""
        cost = np.where(masks.shadow, self._shaded(masks), self.materials.lit)
        np.copyto(cost, self.as_object, where=masks.body)
        return float(np.vdot(cost, self.region.is_ground))

    def sides(self, masks: Predicted, reach_px: float) -> Iterator[Side]:
        """Of the body's outline, then of each shadow's."""
        lit, layers = self.materials.lit, self.materials.layers
        beside_shadow = grown(masks.shadow, math.ceil(reach_px))
        outside = np.where(beside_shadow, np.minimum(lit, self.materials.contact), lit)
        yield Side(outside - self.as_object, self.trusted, np.ones_like(self.trusted))
        visible = ~grown(masks.body, BESIDE_BODY_PX)  # shadows go on behind the body
        if not layers:
            yield Side(lit - self.materials.contact, self.trusted, visible)
        else:
            first, second, both = layers
            for own, other, elsewhere in ((first, second, masks.parts[1]), (second, first, masks.parts[0])):
                yield Side(np.where(elsewhere, other - both, lit - own), self.trusted, visible)

    def _shaded(self, masks: Predicted) -> Float32:
        if not self.materials.layers:
            return self.materials.contact
        first, second, both = self.materials.layers
        one, other = masks.parts
        return np.where(one, np.where(other, both, first), second)
