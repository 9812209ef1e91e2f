"""One map of the table and one set of facets out of several pictures of a known body, which show different parts."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.pictures.shots import Shot
from ashe_live.light.known_body.sides.facets import Facets, facets_of
from ashe_live.light.known_body.table import TableMap


def merged_table(shots: Sequence[Shot]) -> TableMap:
    """The median of all maps in which a cell is seen, in the first one's exposure.

    What stands on the table, and what shines on it, lies elsewhere from each side.
    """
    if len(shots) == 1:
        return shots[0].table
    is_seen = np.any([each.table.seen for each in shots], axis=0)
    light = np.zeros(shots[0].table.light_rgb.shape, np.float32)
    each_light = [np.where(each.table.seen[..., None], each.gain * each.table.light_rgb, np.nan) for each in shots]
    light[is_seen] = np.nanmedian(np.array(each_light)[:, is_seen], axis=0)
    return TableMap(light, is_seen)


def merged_facets(shots: Sequence[Shot], body: Proxy) -> Facets:
    """Each of the body's facets as one picture shows it best, in the first one's exposure.

    That is where it is not overexposed, and as broad as can be; but the level one where its light is known best.
    """
    several = [facets_of(each.view, body, each.picture) for each in shots]
    if len(several) == 1:
        return several[0]
    seen = [
        (facets, shot.gain, number)
        for facets, shot in zip(several, shots, strict=True)
        for number in range(len(facets.normals))
    ]
    best: dict[tuple[int, ...], tuple[Facets, Float, int]] = {}
    for one in sorted(seen, key=_rank):
        facets, _, number = one
        best.setdefault(tuple(np.round(facets.normals[number]).astype(int)), one)
    if not best:
        return several[0]
    chosen = list(best.values())
    level = [facets.level_sigma for facets, _, number in chosen if facets.is_level[number]]
    return Facets(
        normals=np.array([facets.normals[number] for facets, _, number in chosen]),
        light_rgb=np.array([gain * facets.light_rgb[number] for facets, gain, number in chosen]),
        centres=np.array([facets.centres[number] for facets, _, number in chosen]),
        is_clipped=np.array([facets.is_clipped[number] for facets, _, number in chosen]),
        width_px=np.array([facets.width_px[number] for facets, _, number in chosen]),
        level_sigma=level[0] if level else math.inf,
    )


def _rank(seen: tuple[Facets, Float, int]) -> tuple[float, bool, float]:
    """By which a facet in a picture is ranked: the least is the best."""
    facets, _, number = seen
    level_sigma = facets.level_sigma if facets.is_level[number] else 0.0
    return level_sigma, bool(facets.is_clipped[number]), -float(facets.width_px[number])
