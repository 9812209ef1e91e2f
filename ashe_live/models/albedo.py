"""A model's mean albedo."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.models.mesh import Mesh, Model

TEXELS_A_SIDE = 64  # about so many of a map are looked at


def mean_albedo(model: Model) -> Float:
    """(3,) linear RGB: the base colour's mean over the surface, weighted by area and opacity; 0 for nothing opaque.

    What a map contributes is its mean, wherever its texels are used. A metal's base colour is what it reflects, too.
    """
    areas, colours = zip(*(_area_and_colour(part) for part in model.parts), strict=True)
    weights = np.array(areas) * np.array(colours)[:, 3]
    total = weights.sum()
    return np.asarray(weights @ np.array(colours)[:, :3] / total if total > 0 else np.zeros(3), np.float64)


def _area_and_colour(part: Mesh) -> tuple[float, Float]:
    area = part.areas
    total = float(area.sum())
    colour = np.array(part.material.base_colour, dtype=np.float64)
    if part.colours is not None and total > 0:
        colour *= area @ part.colours[part.triangles].mean(axis=1) / total
    texels = part.material.base_map
    if texels is not None:
        rows, columns = (max(1, side // TEXELS_A_SIDE) for side in texels.shape[:2])
        some = texels[::rows, ::columns].reshape(-1, 4)
        colour[:3] *= LINEAR_FROM_SRGB_8BIT[some[:, :3]].mean(axis=0)
        colour[3] *= some[:, 3].mean() / 255
    return total, np.clip(colour, 0.0, 1.0)
