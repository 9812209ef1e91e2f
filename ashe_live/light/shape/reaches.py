"""How far the outlines of bodies of any families, and of their shadows, reach in the image, and how that varies."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.shape.family import Family, batches_of
from ashe_live.light.shape.layout import Layout
from ashe_live.light.shape.supports import outline_supports


def outline_reaches(
    families: Sequence[Family],
    shapes: Float,
    P: Float,
    lights: Float,
    directions: Float,
    touching: Float | None = None,
    with_nearness: bool = False,
) -> tuple[Float, Float]:
    """(n, 1 + l, d) support functions of n bodies and their shadows; (n, split + q, 1 + l, d) derivatives by theta.

    shapes: (n, q) parameters of the members of `families` (n,). with_nearness: as in the Layout of theta. All else as
    in `outline_supports`.
    """
    (n, q), (_, count, _), d = shapes.shape, lights.shape, directions.shape[-1]
    split = Layout(count, with_nearness).split
    reach_px, by_theta = np.empty((n, 1 + count, d)), np.zeros((n, split + q, 1 + count, d))
    for batch in batches_of(families, shapes):
        rows = batch.rows
        turned = None if touching is None else touching[rows]
        supports = outline_supports(P[rows], batch.parts, lights[rows], directions[rows], turned)
        reach_px[rows] = supports.reach_px
        by_theta[rows, : split + batch.by_shape.shape[3]] = supports.by_theta(batch.by_shape, with_nearness)
    return reach_px, by_theta
