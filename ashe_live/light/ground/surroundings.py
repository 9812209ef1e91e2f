"""Surroundings: a wall behind the table, or the floor beyond its edge, which an object in front of it is joined to.

They stand out from the ground as objects do, and no colour of theirs is the ground's. But they reach the picture's
border, and people aim the camera so that object and shadow lie well inside.
"""

import numpy as np

from ashe_live.core.arrays import Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.pixels.areas import areas_by_size, grown, majority
from ashe_live.light.pixels.mixtures import clusters

BORDER_PX = 2  # width of the picture's border
LEAST_BORDER = 0.03  # least share of the border's pixels that are in a group with surroundings
COLOURS = 5  # clusters of the group's colours
# Least pixels of an area of one colour that belongs to the surroundings, and least share of the border that is in it.
LEAST_AREA_PX, LEAST_AREA_BORDER = 30, 0.0075
LEAST_INSIDE_PX, MOST_ON_BORDER_PX = 40, 3  # pixels of what stands before them, and of that on the border


def surroundings_in(group: Mask, ground: LitGround) -> Mask | None:
    """(h, w) the areas of one colour, by K-means, by which unlit pixels reach the border of the picture; None: none.

    group: (h, w) pixels near each other that the lit ground does not explain.
    """
    border = _border(group)
    length = np.count_nonzero(border)
    if np.count_nonzero(group & border) < LEAST_BORDER * length:
        return None
    colour = np.full(group.shape, COLOURS, np.intp)
    colour[group] = clusters(ground.colours[group], COLOURS)[0]
    found = np.zeros_like(group)
    for each in range(COLOURS):
        for area in areas_by_size(majority(colour == each), LEAST_AREA_PX):
            if np.count_nonzero(area & border) >= LEAST_AREA_BORDER * length:
                found |= area
    # The rim of mixed colours between them and what stands before them is as much theirs.
    return grown(found, 1) & group if found.any() else None


def stands_inside(area: Mask) -> bool:
    """Whether what is left beside surroundings, (h, w), is enough and lies within the picture."""
    on_border = np.count_nonzero(area & _border(area))
    return bool(np.count_nonzero(area) >= LEAST_INSIDE_PX and on_border <= MOST_ON_BORDER_PX)


def _border(picture: Mask) -> Mask:
    """(h, w) the outermost pixels of a picture of that size."""
    border = np.ones_like(picture)
    border[BORDER_PX:-BORDER_PX, BORDER_PX:-BORDER_PX] = False
    return border
