"""Lights as homogeneous points (x, y, z, w): w = 0 for a direction, else a lamp at (x, y, z) / w.

Any light above the plane z = 0 casts shadows on it by one planar projection (Blinn, "Me and My (Fake) Shadow", IEEE
Computer Graphics and Applications 8(1), 1988). Divided by its z, a light has three parameters: the displacement
s = (x, y) / z of a shadow per unit of height, and w / z, by which shadows grow with height; it is 0 for a direction.
"""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised

NEAREST = 1e-3  # least distance of a light, over that from the reference: nearer ones are taken to be there
LOWEST_Z = 1e-6  # of the unit vector along (x, y, z): a lower light casts no finite shadow on the plane


def at_infinity(to_lights: Float) -> Float:
    """(..., 4) lights at infinity in directions (..., 3), which point from the surface towards the lights."""
    lights = np.zeros((*to_lights.shape[:-1], 4))
    lights[..., :3] = to_lights
    return lights


NO_LIGHTS = at_infinity(np.empty((0, 3)))


def shadow_projection(lights: Float) -> Float:
    """(..., 4, 4) the projections of homogeneous points onto the plane z = 0 by lights (..., 4) with positive z."""
    projection = np.zeros((*lights.shape[:-1], 4, 4))
    projection[..., 0, 0] = projection[..., 1, 1] = projection[..., 3, 3] = 1.0
    projection[..., 2] = -lights / lights[..., 2:3]
    projection[..., 2, 2] = 0.0
    return projection


def cast_on_ground(points: Float, light: Float) -> Float | None:
    """(n, 3) the shadows on the plane z = 0 of points (n, 3) in a light (4,).

    None for a light in the plane or below it, or one that is not above all of the points: the shadow is then infinite.
    """
    if light[2] <= LOWEST_Z * np.linalg.norm(light[:3]):
        return None
    height_left = 1 - points[:, 2:] * (light[3] / light[2])
    if not (height_left > 0).all():
        return None
    return np.asarray((points - points[:, 2:] * (light[:3] / light[2])) / height_left)


def held_near(lights: Float, nearness: Float, height: float) -> Float:
    """(l, 4) lights with z = 1 and the nearness w / z (l,) that cast what is `height` above the origin as `lights` do.

    Both must be above that height.
    """
    before = lights[:, 3] / lights[:, 2]
    displacements = lights[:, :2] / lights[:, 2:3] * ((1 - nearness * height) / (1 - before * height))[:, None]
    return np.column_stack([displacements, np.ones(len(lights)), nearness])


def towards(light: Float, point: Float) -> Float:
    """(3,) the unit vector from a point (3,) towards a light (4,)."""
    return normalised(light[:3] - light[3] * point)


def relative_distances(light: Float, points: Float, reference: Float) -> Float:
    """(n,) distances of a light (4,) from points (n, 3), over that from `reference` (3,): 1 for one at infinity."""
    offsets, to_reference = light[:3] - light[3] * points, light[:3] - light[3] * reference[None]
    return np.asarray(np.linalg.norm(offsets, axis=1) / np.linalg.norm(to_reference, axis=1))


def relative_irradiance(light: Float, points: Float, normals: Float, reference: Float) -> Float:
    """(n,) irradiance by a light (4,) of facets at points (n, 3), over that of a facet which faces it at `reference`.

    normals: (n, 3) unit vectors. By Lambert's cosine law and the inverse square of the distance; 0 for facets that face
    away from the light. Facets cast no shadows on each other.
    """
    # In units of the distance from `reference`; the sum's second part is exactly 0 for a light at infinity.
    distance = np.linalg.norm(light[:3] - light[3] * reference)
    aside = light[3] / distance * (reference - points)
    cosines = normals @ towards(light, reference) + (aside * normals).sum(axis=1)
    return np.asarray(np.maximum(cosines, 0) / np.maximum(relative_distances(light, points, reference), NEAREST) ** 3)
