"""Where a model first stands if the marker is printed on a body: beside the body, clear of its shadow."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.types import Light, TrackedFrame
from ashe_live.models.placement import UNMOVED, Placement
from ashe_live.viewer.hands.pointing import picture_axes

# Distance between the middles of body and model: half of each, and a gap between them that lets light through.
AWAY_SIDES = 1.7
# Number of directions that are compared, and weights of a place nearer to the camera, to the side, and out of the
# shadow.
DIRECTIONS = 16
NEARER, ASIDE, OUT_OF_SHADOW = 0.25, 0.5, 1.0
TO_THE_RIGHT = 1e-3  # weight that only decides between places that are otherwise as good
# Cosine of a light's elevation below which the body's shadow counts the less the shorter it is.
STEEP_COSINE = 0.2


def first_placement(tracked: TrackedFrame, light: Light | None, in_its_place: bool = False) -> Placement:
    """Over the marker; if that is on a body, beside the body as the picture shows it, and out of its shadow in `light`.

    in_its_place: the body is covered, and the model takes its place.
    """
    if in_its_place or tracked.marker is None or tracked.marker.body is None:
        return UNMOVED
    right, away = picture_axes(tracked)
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    around: Float = np.cos(angles)[:, None] * right + np.sin(angles)[:, None] * away
    worth = ASIDE * np.abs(around @ right) - NEARER * (around @ away) + TO_THE_RIGHT * (around @ right)
    if light is not None:
        shadow = -light.to_light_marker[:2]
        cosine = float(np.linalg.norm(shadow))
        worth = worth - OUT_OF_SHADOW * np.maximum(around @ shadow, 0) / max(cosine, STEEP_COSINE)
    x, y = AWAY_SIDES * tracked.marker.side_m * around[int(worth.argmax())]
    return Placement(shift_m=(float(x), float(y)))
