"""Gloss: the light that rough ground mirrors, in addition to what it scatters. It makes a sunlit ground uneven.

By the microfacets of GGX (Walter et al., 2007) with Smith's shadowing as Schlick approximates it, and a dielectric's
Fresnel reflection: a rough table is brightest where it would mirror the light, and low against the light all over.
"""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float

NORMAL_REFLECTANCE = 0.04  # of a dielectric with an index of refraction of 1.5
LEAST_COSINE = 0.02  # of the eye's ray on the plane: beyond that it grazes the horizon
MOVED = 1e-4  # of a light's displacement, metres per metre of height, by which slopes are measured


@dataclass(frozen=True, slots=True)
class Gloss:
    """How a ground mirrors."""

    roughness: float  # GGX's alpha: half of the area seen from above is in facets of smaller slopes
    albedo: float  # of what it scatters


def mirrored(places: Float, eye: Float, lights: Float, gloss: Gloss) -> Float:
    """(p, n) light that the ground at places (p, 2) mirrors towards `eye` (3,), over what it scatters of the same.

    Places and eye in metres, marker frame. lights: (n, 3) of each the displacement at the marker's centre, x / z and
    y / z of the direction towards it, and its nearness, one over its height (1/m).
    """
    to_eye = eye - np.column_stack([places, np.zeros(len(places))])
    to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
    eye_z = np.maximum(to_eye[:, 2:], LEAST_COSINE)
    aside_x, aside_y = (lights[:, i] - places[:, i : i + 1] * lights[:, 2] for i in (0, 1))
    light_z = 1 / np.sqrt(1 + aside_x**2 + aside_y**2)
    # Half way between light and eye, both unit vectors.
    cosine = light_z * (to_eye[:, :1] * aside_x + to_eye[:, 1:2] * aside_y + to_eye[:, 2:])
    length = np.sqrt(np.maximum(2 + 2 * cosine, 1e-12))
    half_z = (light_z + to_eye[:, 2:]) / length
    alpha_squared = gloss.roughness**2
    facets = alpha_squared / (half_z**2 * (alpha_squared - 1) + 1) ** 2
    grazing = 1 - 0.5 * length
    fresnel = NORMAL_REFLECTANCE + (1 - NORMAL_REFLECTANCE) * (grazing**2) ** 2 * grazing
    k = 0.5 * gloss.roughness
    seen = 1 / ((eye_z * (1 - k) + k) * (light_z * (1 - k) + k))
    return np.asarray(0.25 * facets * fresnel * seen / gloss.albedo)


def mirrored_and_slopes(places: Float, eye: Float, lights: Float, gloss: Gloss) -> tuple[Float, Float]:
    """As `mirrored`, (p, n); and (p, 3) its slopes by displacement and nearness of the first light."""
    moved = lights[0] + MOVED * np.eye(2, 3)
    found = mirrored(places, eye, np.vstack([lights, moved]), gloss)
    by_displacement = (found[:, -2:] - found[:, [0]]) / MOVED
    # At a place p the displacement is s - p w / z.
    return found[:, :-2], np.column_stack([by_displacement, -(by_displacement * places).sum(axis=1)])
