"""A light that was found, and how much of the table's light it gives: what its shadow lacks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.known_body.fit import FEWEST, EdgeFit
from ashe_live.light.known_body.scan import shadows_of, templates_of
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.shadow_edges import shadow_edges
from ashe_live.light.known_body.table import BRIGHTEST
from ashe_live.light.shape.predicted import predicted

# From a shadow's edge to where it is dark, or lit: pixels, and of the light's angular diameter times the penumbra's
# standard deviation for a light of 1 rad.
BEYOND_PX, BEYOND_PENUMBRA = 3.0, 2.2


@dataclass(frozen=True, slots=True, eq=False)
class FoundLight:
    """A light of a known body."""

    light: Float  # (4,) homogeneous, marker frame
    covariance: Float  # (2, 2) of s = (x, y) / z
    fit: EdgeFit | None  # None where the shadow's edges are hidden: the direction is that of a template
    darkening: float  # part of the table's light that it gives
    confidence: float = 0.0  # probability that it is within NEAR_RAD of a true light; 0 as long as nobody has asked


def darkenings_rgb(seen: Seen, found: Sequence[FoundLight]) -> Float:
    """(l, 3) part of the table's light, R, G, B, that each light gives: its shadow beside the lit table, at its edges.

    Where too little of a shadow's edges is seen, by least squares over the map.
    """
    by_map = _by_map(seen, [each.light for each in found])
    several = []
    for number, one in enumerate(found):
        lit = seen.clear.copy()
        for other in [*found[:number], *found[number + 1 :]]:
            lit &= ~predicted(seen.body, other.light[None], seen.view).shadow
        step = _step_rgb(seen, one, lit)
        several.append(by_map[number] if step is None else step)
    return np.array(several)


def _step_rgb(seen: Seen, one: FoundLight, lit: Mask) -> Float | None:
    """(3,) R, G, B: the light that is lost across the shadow's edges, over that beyond them; None where few are seen.

    lit: (h, w) table that no other shadow reaches.
    """
    edges = shadow_edges(seen.body, one.light, seen.view)
    if edges is None or one.fit is None:
        return None
    away = BEYOND_PX + BEYOND_PENUMBRA * (one.fit.size_rad or 0.0) * edges.by_size
    ends = [edges.points_px + sign * away[:, None] * edges.normals_px for sign in (-1, 1)]
    height, width = lit.shape
    columns, rows = np.round(np.moveaxis(np.array(ends), 2, 0)).astype(int)
    inside = ((columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)).all(axis=0)
    columns, rows = columns[:, inside], rows[:, inside]
    kept = lit[rows, columns].all(axis=0)
    if np.count_nonzero(kept) < FEWEST:
        return None
    dark, bright = seen.picture[rows[:, kept], columns[:, kept]].astype(np.float64)[..., ::-1]
    return np.asarray(1 - np.median(dark / np.maximum(bright, 1e-4), axis=0)).clip(0.0, 1.0)


def _by_map(seen: Seen, lights: Sequence[Float]) -> Float:
    """(l, 3) R, G, B: the same by a regression of the table's map on all shadows and on the sky that the body hides."""
    templates = templates_of(seen.body)
    shadows = shadows_of(seen.body, np.array(lights))
    ones = np.ones((1, shadows.shape[1]), np.float32)
    varied = np.concatenate([ones, templates.hidden_sky[None], shadows])
    w = seen.table.seen.reshape(-1).astype(np.float32)
    normal = ((varied * w) @ varied.T).astype(np.float64) + 1e-6 * np.eye(len(varied))
    values = np.minimum(seen.relative, BRIGHTEST).reshape(-1, 3)
    level, _, *dark = np.linalg.solve(normal, (varied * w) @ values)
    return np.asarray(-np.array(dark) / np.maximum(level, 1e-3)).clip(0.0, 1.0)
