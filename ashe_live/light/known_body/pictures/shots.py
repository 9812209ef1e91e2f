"""Views of a known body, each with its map of the table, and how their exposures differ."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32, upper_median
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.light.known_body.table import LEAST_CELLS, TableMap, linear_picture, table_around
from ashe_live.light.pixels.view import View

BLACK = 1e-4  # linear light: what is darker is black in the picture


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """A view of a known body."""

    view: View
    errors: PoseShapeErrors | None  # how the body and its frame may be off
    picture: Float32  # (h, w, 3) linear light, B, G, R
    table: TableMap
    gain: Float  # (3,) light R, G, B in the exposure of the first picture over that in its own


def shots_of(several: Sequence[tuple[View, PoseShapeErrors | None]], body: Proxy) -> list[Shot]:
    """The first of several views of one scene, with the errors of each, and those others that show the same table.

    Empty where next to nothing of the table is in the first; another is left out where that is so, or where both have
    too little of it in common.
    """
    shots: list[Shot] = []
    for view, errors in several:
        picture = linear_picture(view)
        table = table_around(view, body, picture)
        gain = None if table is None else _gain(shots[0].table if shots else table, table)
        if table is not None and gain is not None:
            shots.append(Shot(view, errors, picture, table, gain))
        elif not shots:
            break
    return shots


def _gain(first: TableMap, table: TableMap) -> Float | None:
    """(3,) light R, G, B in the exposure of the first map over that in another's; None where both have too little of
    the table in common.
    """
    both = first.seen & table.seen
    if np.count_nonzero(both) < LEAST_CELLS:
        return None
    ratios = np.maximum(first.light_rgb[both], BLACK) / np.maximum(table.light_rgb[both], BLACK)
    return np.array([upper_median(channel) for channel in ratios.T], dtype=np.float64)
