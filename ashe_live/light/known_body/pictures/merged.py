"""One map of the table and one set of facets out of several pictures of a known body, which show different parts."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float, upper_median
from ashe_live.light.known_body.sides.facets import Facets
from ashe_live.light.known_body.table import LEAST_CELLS, TableMap

# Of the cells that two maps share: by which a cell differs that shows another scene, relative to its light, and the
# share of such cells from which on the maps do.
OTHER_LIGHT, MOST_OTHER = 0.25, 0.15


def gain_between(first: TableMap, other: TableMap) -> Float | None:
    """(3,) light R, G, B in the exposure of the first map over that in the other's.

    None where too little of the table is in both, and where they show different scenes: the body was moved, or another
    light is on.
    """
    both = first.seen & other.seen
    if np.count_nonzero(both) < LEAST_CELLS:
        return None
    ratios = np.maximum(first.light_rgb[both], 1e-4) / np.maximum(other.light_rgb[both], 1e-4)
    gain = np.array([upper_median(channel) for channel in ratios.T])
    differs = np.abs(np.log((ratios / gain).mean(axis=1))) > OTHER_LIGHT
    return gain if differs.mean() < MOST_OTHER else None


def merged_tables(tables: Sequence[TableMap], gains: Sequence[Float]) -> TableMap:
    """The mean of maps in which a cell is seen, each brought to the first one's exposure by its gain (3,)."""
    seen = np.array([each.seen for each in tables])
    light = sum(each.light_rgb * (gain * each.seen[..., None]) for each, gain in zip(tables, gains, strict=True))
    return TableMap(
        (light / np.maximum(seen.sum(axis=0), 1)[..., None]).astype(np.float32), np.asarray(seen.any(axis=0))
    )


def merged_facets(several: Sequence[Facets], gains: Sequence[Float]) -> Facets:
    """Each facet as it is seen best: not overexposed, where that can be, and as broad as can be.

    Of a level one how well its light is known comes first.
    """
    chosen: dict[bytes, tuple[tuple[float, bool, float], int, int]] = {}
    for picture, facets in enumerate(several):
        for number, normal in enumerate(facets.normals):
            sigma = facets.level_sigma if normal[2] > 0 else 0.0
            rank = sigma, bool(facets.is_clipped[number]), -float(facets.width_px[number])
            key = np.round(normal).tobytes()
            if key not in chosen or rank < chosen[key][0]:
                chosen[key] = rank, picture, number
    if not chosen:
        return several[0]
    best = [(several[picture], gains[picture], number) for _, picture, number in chosen.values()]
    level = [rank[0] for rank, picture, number in chosen.values() if several[picture].normals[number, 2] > 0]
    return Facets(
        normals=np.array([facets.normals[number] for facets, _, number in best]),
        light_rgb=np.array([gain * facets.light_rgb[number] for facets, gain, number in best]),
        centres=np.array([facets.centres[number] for facets, _, number in best]),
        is_clipped=np.array([facets.is_clipped[number] for facets, _, number in best]),
        width_px=np.array([facets.width_px[number] for facets, _, number in best]),
        level_sigma=level[0] if level else np.inf,
    )
