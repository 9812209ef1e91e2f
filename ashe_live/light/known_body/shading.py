"""What the light on a body's white facets says of where a light is: the body's own dark and lit sides."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.facets import Facets

PAPER = 0.8  # reflectance of white paper
# Standard deviation of a facet's light over level paper's, as skies are uneven and paper lets light through; and of
# what a light adds to it. A residual counts no more than so many of them.
UNEVEN, OF_LIGHT, MOST_SIGMAS = 0.12, 0.12, 4.0
LOWEST_Z = 0.05


def shading_log_likelihood(facets: Facets, table_light: Float, to_lights: Float, sky_shares: Float) -> Float:
    """(m, k) log likelihood of the facets' light if one light stands in directions (m, 3) and the sky gives level paper
    shares (k,) of its light; zeros where the level facet is not seen, which all others are compared with.

    table_light: (3,) linear light of the lit table in the picture.
    """
    nothing = np.zeros((len(to_lights), len(sky_shares)))
    level = np.flatnonzero((facets.normals[:, 2] > 0.99) & ~facets.is_clipped.astype(bool))
    if not len(level) or len(facets.normals) < 2:
        return nothing
    white = facets.light_rgb[level[0]].mean()
    sides = np.delete(np.arange(len(facets.normals)), level[0])
    seen = facets.light_rgb[sides].mean(axis=1) / max(white, 1e-4)
    table = PAPER * float(table_light.mean()) / max(white, 1e-4)
    normals = facets.normals[sides]
    facing = np.maximum(to_lights @ normals.T, 0) / np.maximum(to_lights[:, 2:], LOWEST_Z)
    total = nothing
    for number in range(len(sides)):
        up = normals[number, 2]
        from_sky = sky_shares * (1 + up) / 2 + table * (1 - up) / 2
        from_light = (1 - sky_shares) * facing[:, number, None]
        away = seen[number] - from_sky - from_light
        if facets.is_clipped[sides[number]]:
            away = np.maximum(away, 0)  # it may be brighter than it looks
        sigmas = np.abs(away) / (UNEVEN + OF_LIGHT * from_light)
        total = total - 0.5 * np.minimum(sigmas, MOST_SIGMAS) ** 2
    return np.asarray(total)
