"""Unlit areas that lie on the plane: paint, paper, or shadow, and no part of an object.

Only the border of an area tells whether it moves between views, its inside looks the same wherever it is; so areas of
one colour are judged whole.
"""

import numpy as np

from ashe_live.core.arrays import Float32, Mask
from ashe_live.light.pixels.areas import areas_by_size, grown, majority
from ashe_live.light.pixels.mixtures import clusters
from ashe_live.light.pixels.quantised import Quantised

COLOURS = 6
LEAST_PX = 30  # of an area
# An area is flat by log odds of FLAT_ODDS, of pixels of which so many count as one sample, where hardly any pixel has
# log odds below ABOVE.
FLAT_ODDS, PIXELS_PER_SAMPLE, ABOVE, FLAT_ABOVE = 1.5, 40.0, -0.7, 0.03


def flat_areas(quantised: Quantised, unlit: Mask, on_plane: Float32) -> Mask:
    """(h, w) the areas of one colour of `unlit` (h, w) that other views confirm to lie on the plane.

    quantised: the picture's colours. on_plane: (h, w) log odds by other views that a pixel lies on the plane.
    """
    labels = clusters(quantised.colours, COLOURS)[0].astype(np.uint8)[quantised.cell]
    flat = np.zeros_like(unlit)
    for colour in range(COLOURS):
        for area in areas_by_size(majority((labels == colour) & unlit), LEAST_PX):
            odds = on_plane[grown(area, 1)]
            if odds.sum() > FLAT_ODDS * PIXELS_PER_SAMPLE and (odds < ABOVE).mean() < FLAT_ABOVE:
                flat |= area
    return flat
