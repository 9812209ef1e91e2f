"""Relabelling after a fit: near the predicted outlines colours decide, elsewhere the prediction does."""

import math

import numpy as np

from ashe_live.core.arrays import Float32
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import LEAST_SHADOW_PX, Split
from ashe_live.light.labels.costs import cost_of_distance
from ashe_live.light.labels.materials import Materials
from ashe_live.light.labels.two_lights import separated_shadows
from ashe_live.light.pixels.areas import cleaned, filled, large_areas, majority, overlapping, thick
from ashe_live.light.shape.predicted import Predicted

# Distance from a predicted outline within which colours alone decide, in pixels and as a fraction of the object's size.
# Beyond it, a label outside of its prediction costs more per pixel of distance, for FARTHEST_PX.
FREE_PX, FREE_SHARE = 2.0, 0.06
COST_PER_PX, FARTHEST_PX = 4.0, 8.0
# Difference in cost below which a pixel is undecided between object and shadow, if such pixels form more than a seam.
UNDECIDED = 4.0
SEAM_PX = 5  # least width of what is undecided; what is narrower gets the cheaper of both labels
LEAST_DOUBT = 0.02  # share of object and shadow that must be undecided for it to count


def relabelled(region: Region, materials: Materials, object_cost: Float32, fitted: Predicted) -> Split:
    """The region's pixels labelled as object, shadow, undecided between these, or neither.

    object_cost: (h, w) the object's unary cost. fitted: the silhouettes that the last fit predicts.
    """
    free_px = max(FREE_PX, FREE_SHARE * math.sqrt(max(int(np.count_nonzero(fitted.body)), 1)))
    as_object = object_cost + cost_of_distance(fitted.body, COST_PER_PX, FARTHEST_PX, free_px)
    as_shadow = materials.contact + cost_of_distance(fitted.shadow, COST_PER_PX, FARTHEST_PX, free_px)
    unlit = (np.minimum(as_object, as_shadow) < materials.lit) & region.is_ground
    whole = overlapping(cleaned(unlit), fitted.whole)
    body = overlapping(majority(unlit & (as_object < as_shadow - UNDECIDED) & whole), fitted.body)
    shadow = overlapping(majority(unlit & (as_shadow < as_object - UNDECIDED) & whole), fitted.shadow)
    doubtful = whole & ~body & ~shadow
    broad = thick(doubtful, SEAM_PX)
    narrow = doubtful & ~broad
    body = filled(overlapping(cleaned(body | (narrow & (as_object < as_shadow))), fitted.body))
    shadow = large_areas(cleaned((shadow | (narrow & (as_shadow <= as_object))) & ~body), LEAST_SHADOW_PX)
    undecided = broad & ~body & ~shadow
    doubt = undecided if np.count_nonzero(undecided) > LEAST_DOUBT * np.count_nonzero(whole) else None
    return Split(body, shadow, doubt, separated_shadows(materials, shadow, fitted))
