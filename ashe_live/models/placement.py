"""Where a model stands: over the marker's centre, on the ground, as large as the marker allows."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import Model

FOOTPRINT_SIDES = 1.0  # largest horizontal extent, in sides of the marker
HEIGHT_SIDES = 1.2  # largest vertical extent, in sides of the marker


@dataclass(frozen=True, slots=True, eq=False)
class PlacedModel:
    """A model in the marker frame; compared by identity, so keep it as long as the model and the marker stay."""

    model: Model  # vertices in metres, marker frame, lowest at z = 0
    bounds: Float  # (2, 3) smallest and largest coordinates, metres, marker frame


def placed_on_marker(model: Model, side_m: float) -> PlacedModel:
    """`model` scaled to a marker of `side_m`, centred over it and set on the plane z = 0."""
    if not side_m > 0:
        raise ValueError(f"a marker's side of {side_m} m is not positive")
    lower, upper = model.bounds
    width, depth, height = upper - lower
    scale = side_m / max(width / FOOTPRINT_SIDES, depth / FOOTPRINT_SIDES, height / HEIGHT_SIDES)
    offset = -scale * np.array([(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]])
    moved = Model(model.name, tuple(part.moved(scale, offset) for part in model.parts))
    return PlacedModel(moved, moved.bounds)
