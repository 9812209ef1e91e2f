"""How likely several explanations of all views are, by what their pixels cost ((31a) of docs/maths)."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.pixels.areas import shrunk
from ashe_live.light.shape.predicted import Predicted

# The cost per pixel of the outlines is higher in the true light than in the best one, as voxels and labels are off by
# chance: by 0.25 in the median of takes. Over 1.39, the median of a chi-squared variable of two degrees of freedom.
CHANCE = 0.18


def log_likelihoods_by_pixels(costs: Sequence[float], best: Sequence[Predicted]) -> Float:
    """(n,) log likelihoods, up to a constant, of explanations whose pixels cost `costs` in all views.

    best: what the cheapest one predicts in each view. Costs of neighbouring pixels are not independent: the sample
    size is the number of pixels on its outlines.
    """
    outline_px = sum(int(np.count_nonzero(each.whole & ~shrunk(each.whole, 1))) for each in best)
    return np.asarray(-0.5 * np.array(costs) / (CHANCE * max(outline_px, 1)))
