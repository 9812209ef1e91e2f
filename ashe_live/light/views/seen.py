"""What other views tell of a view's pixels, and what these cost around a body that another view shows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.ground.lit_ground import LitGround, unlit_mask, with_on_plane
from ashe_live.light.ground.regions import Region, region_of
from ashe_live.light.ground.scene_view import SceneView
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import Materials, materials_of, object_cost
from ashe_live.light.labels.two_lights import materials_of_two
from ashe_live.light.pixels.areas import overlapping
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.predicted import predicted
from ashe_live.light.views.plane import log_likelihood_ratio, on_plane

# Number of views that the plane is compared with, for the first view and for another: more repeat what these tell.
COMPARED_WITH_FIRST, COMPARED_WITH_ANOTHER = 4, 1
LEAST_PX = 60  # of a body with its shadow, in the coarse picture: a view that shows less tells nothing


def with_plane(views: Sequence[SceneView]) -> list[SceneView]:
    """The views with what others tell about which of their pixels lie on the plane."""
    found, colours = [], [log_opponent(view.coarse.image_bgr) for view in views]
    for number, view in enumerate(views):
        others = [i for i in range(len(views)) if i != number]
        others = others[: COMPARED_WITH_ANOTHER if number else COMPARED_WITH_FIRST]
        seen = [on_plane(view.coarse, colours[number], views[i].coarse, colours[i]) for i in others]
        ratio = log_likelihood_ratio([each for each in seen if each is not None], view.coarse.is_ground.shape)
        found.append(replace(view, ground=with_on_plane(view.ground, ratio)))
    return found


def without_plane(view: SceneView) -> SceneView:
    """The view by itself, without what others tell about which of its pixels lie on the plane."""
    return replace(view, ground=replace(view.ground, on_plane=None))


def costs_around(lit: LitBody, shifts: Sequence[Float], view: SceneView, region_px: int) -> Costs | None:
    """What the pixels around a body and its shadows cost in a view; the object's colours are learned in its silhouette.

    shifts: (3,) each, of the materials in which the body was explained. None where too little of it is in view.
    """
    whole = predicted(lit.body.proxy, lit.lights, view.coarse).whole & view.coarse.is_ground
    if np.count_nonzero(whole) < LEAST_PX:
        return None
    unlit = unlit_mask(view.ground, view.coarse.is_ground, LEAST_PX)
    around = overlapping(unlit, whole) if (unlit & whole).any() else whole
    region = region_of(view.fine, whole | around, view.ground, region_px)
    materials = _materials(region, view.ground, shifts)
    if materials is None:
        return None
    body = predicted(lit.body.proxy, lit.lights, region.view).body
    return Costs(region, materials, object_cost(region, body & region.is_ground))


def _materials(region: Region, ground: LitGround, shifts: Sequence[Float]) -> Materials | None:
    first = materials_of(region, ground, shifts[0])
    return (
        first if len(shifts) == 1 else materials_of_two(region, ground, first, materials_of(region, ground, shifts[1]))
    )
