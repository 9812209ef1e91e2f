"""Surroundings: a wall behind the table, or the floor beyond its edge, which an object in front of it is joined to.

They stand out from the ground as objects do, and no colour of theirs is the ground's. But they reach the picture's
border, and people aim the camera so that object and shadow lie well inside.
"""

import numpy as np

from ashe_live.core.arrays import Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.pixels.areas import areas_by_size, grown, majority
from ashe_live.light.pixels.mixtures import clusters

BORDER_PX = 2  # beside which pixels lie on the picture's border
LEAST_BORDER = 0.03  # share of the picture's border that what holds surroundings lies on
COLOURS = 5  # that they and what stands before them are parted into
LEAST_AREA_PX, LEAST_CONTACT = 30, 0.0075  # pixels of an area of one colour; share of the border that it reaches
LEAST_INSIDE_PX, MOST_CONTACT_PX = 40, 3  # of what stands before them; how much of that may lie on the border


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
            if np.count_nonzero(area & border) >= LEAST_CONTACT * length:
                found |= area
    # The rim of mixed colours between them and what stands before them is as much theirs.
    return grown(found, 1) & group if found.any() else None


def stands_inside(area: Mask) -> bool:
    """Whether what is left beside surroundings, (h, w), is enough and lies within the picture."""
    on_border = np.count_nonzero(area & _border(area))
    return bool(np.count_nonzero(area) >= LEAST_INSIDE_PX and on_border <= MOST_CONTACT_PX)


def _border(picture: Mask) -> Mask:
    border = np.ones_like(picture)
    border[BORDER_PX:-BORDER_PX, BORDER_PX:-BORDER_PX] = False
    return border
