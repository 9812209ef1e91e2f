"""A table of how much of an even light a rough surface reflects, integrated numerically, as no fit is as exact.

The two terms of Schlick's Fresnel factor f0 (1 - c) + c, with c = (1 - cos)^5, are kept apart (the split sum of Karis,
"Real shading in Unreal Engine 4", 2013), for GGX with Smith's height-correlated shadowing. Beside them
stands the mean of their sum over all directions, for the light that goes from facet to facet (`brdf.glsl`).
"""

import functools

import moderngl
import numpy as np

from ashe_live.core.arrays import Float, frozen_view

COSINES, ROUGHNESSES = 32, 16  # knots between 0 and 1
SAMPLES = 64, 8  # samples of the visible facets, by radius and angle: the whole table takes 8 ms
LEAST = 2e-3  # of cosines and of GGX's alpha, below which the integral is 0 / 0


@functools.cache
def mirrored_shares() -> Float:
    """(ROUGHNESSES, COSINES, 3): the share that is mirrored f0 times, that at any f0, and the mean of both's sum.

    Rows by the perceptual roughness, columns by the cosine between view and normal. By visible normals (Heitz,
    "Sampling the GGX distribution of visible normals", 2018): with these a facet's light counts by its shadowing alone.
    """
    view_z = np.maximum(np.linspace(0, 1, COSINES), LEAST)[:, None]
    view_x = np.sqrt(1 - view_z**2)
    rings, spokes = np.meshgrid(*((np.arange(count) + 0.5) / count for count in SAMPLES), indexing="ij")
    radius, angle = np.sqrt(rings.ravel()), 2 * np.pi * spokes.ravel()
    table = np.empty((ROUGHNESSES, COSINES, 3))
    for row, roughness in zip(table, np.linspace(0, 1, ROUGHNESSES), strict=True):
        alpha = max(roughness**2, LEAST)
        # On the hemisphere that GGX stretches: a point of the disc perpendicular to the view, and the normal above it.
        length = np.hypot(alpha * view_x, view_z)
        along_x, along_z = alpha * view_x / length, view_z / length
        across, down = radius * np.cos(angle), radius * np.sin(angle)
        down = (1 - along_z) / 2 * np.sqrt(1 - across**2) + (1 + along_z) / 2 * down
        out = np.sqrt(np.maximum(1 - across**2 - down**2, 0))
        # Facets, before they are brought to unit length.
        x, y, z = alpha * (along_x * out - along_z * down), alpha * across, along_z * out + along_x * down
        length = np.sqrt(x**2 + y**2 + z**2)
        cosine = np.clip((view_x * x + view_z * z) / length, 0, 1)
        light_z = 2 * cosine * np.maximum(z / length, 0) - view_z
        of_view, of_light = _smith_lambda(view_z, alpha), _smith_lambda(np.maximum(light_z, LEAST), alpha)
        seen = np.where(light_z > 0, (1 + of_view) / (1 + of_view + of_light), 0.0)
        grazing = (1 - cosine) ** 5
        row[:, 0], row[:, 1] = (seen * (1 - grazing)).mean(axis=1), (seen * grazing).mean(axis=1)
        # The mean over directions, each by its cosine.
        row[:, 2] = 2 * np.trapezoid(row[:, :2].sum(axis=1) * view_z[:, 0], view_z[:, 0])
    return frozen_view(table)


def _smith_lambda(cosine: Float, alpha: float) -> Float:
    """Smith's Lambda of GGX: facets that are hidden from a direction over those that are seen."""
    return np.asarray((np.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)) - 1) / 2)


def share_texture(ctx: moderngl.Context) -> moderngl.Texture:
    """The table, its knots at the middles of texels."""
    table = np.dstack([mirrored_shares(), np.ones((ROUGHNESSES, COSINES))]).astype(np.float16)
    texture = ctx.texture((COSINES, ROUGHNESSES), 4, table, dtype="f2")
    texture.filter = moderngl.LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = False
    return texture
