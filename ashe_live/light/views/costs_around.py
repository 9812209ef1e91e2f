"""What the pixels of a view cost around a body that another view shows."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import object_cost
from ashe_live.light.labels.two_lights import materials_of_each
from ashe_live.light.pixels.areas import overlapping
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.predicted import predicted_of

LEAST_PX = 60  # of a body with its shadow, in the coarse picture: a view that shows less is no evidence


def costs_around(lit: LitBody, shifts: Sequence[Float], view: SceneView, region_px: int) -> Costs | None:
    """What the pixels around a body and its shadows cost in a view; the object's colours are learned in its silhouette.

    shifts: (3,) each, of the materials in which the body was explained. None where too little of it is in view.
    """
    whole = view.ground_under(lit)
    if np.count_nonzero(whole) < LEAST_PX:
        return None
    unlit = view.unlit(LEAST_PX)
    around = overlapping(unlit, whole) if (unlit & whole).any() else whole
    region = view.region(whole | around, region_px)
    materials = materials_of_each(region, view.ground, shifts)
    if materials is None:
        return None
    body = predicted_of(lit, region.view).body
    return Costs(region, materials, object_cost(region, body & region.is_ground))
