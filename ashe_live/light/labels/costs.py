"""The unary costs of a region's pixels under the labels that a body and its shadows predict."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.materials import Materials
from ashe_live.light.pixels.areas import distance_to, grown
from ashe_live.light.shape.predicted import Predicted

BESIDE_BODY_PX = 2  # where a border of the shadow is none, as the body hides how it goes on


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """The evidence in a picture for one outline's position."""

    gain: Float32  # (h, w) cost of each pixel with the label outside of the outline, less that with the label inside
    trusted: Mask  # (h, w) where the gain is reliable
    visible: Mask  # (h, w) where a border can be observed


@dataclass(frozen=True, slots=True, eq=False)
class Costs:
    """The unary costs of a region: what each pixel costs as lit ground, shadow and object."""

    region: Region
    materials: Materials
    as_object: Float32  # (h, w) unary cost of taking a pixel for the object

    def with_pose(self, T_cam_marker: Float) -> "Costs":
        """The same pixels' costs, seen by a camera with another pose (4, 4)."""
        return replace(self, region=self.region.with_pose(T_cam_marker))

    def of(self, masks: Predicted) -> float:
        """Total unary cost of the region's ground pixels under the labels of the masks (docs/maths, (15))."""
        cost = np.where(masks.shadow, self._shaded(masks), self.materials.lit)
        np.copyto(cost, self.as_object, where=masks.body)
        return float(np.vdot(cost, self.region.is_ground))

    def sides(self, masks: Predicted, reach_px: float) -> Iterator[Side]:
        """The `Side` of the body's outline, then of each shadow's; reach_px: how far from it borders are searched."""
        lit, layers, trusted = self.materials.lit, self.materials.layers, ~self.region.unreliable
        beside_shadow = grown(masks.shadow, math.ceil(reach_px))
        outside = np.where(beside_shadow, np.minimum(lit, self.materials.contact), lit)
        yield Side(outside - self.as_object, trusted, np.ones_like(trusted))
        visible = ~grown(masks.body, BESIDE_BODY_PX)  # shadows go on behind the body
        if not layers:
            yield Side(lit - self.materials.contact, trusted, visible)
        else:
            first, second, both = layers
            for one, other, in_other in ((first, second, masks.parts[1]), (second, first, masks.parts[0])):
                yield Side(np.where(in_other, other - both, lit - one), trusted, visible)

    def _shaded(self, masks: Predicted) -> Float32:
        """(h, w) cost of shadow: with two lights, that of the first's, the second's or both, as the masks predict."""
        if not self.materials.layers:
            return self.materials.contact
        first, second, both = self.materials.layers
        one, other = masks.parts
        return np.where(one, np.where(other, both, first), second)


def cost_of_distance(mask: Mask, per_px: float, farthest_px: float, free_px: float = 0.0) -> Float32:
    """(h, w) what a label costs beside its unary cost where a fit does not predict it.

    It rises by `per_px` for each pixel of distance from the prediction `mask` (h, w): from `free_px` on, and for
    `farthest_px` more.
    """
    return np.asarray(per_px * np.clip(distance_to(mask) - free_px, 0, farthest_px), dtype=np.float32)
