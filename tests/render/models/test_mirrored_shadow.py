"""A model's own shadow on the ground, as its polished surfaces mirror it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import direction_from_angles
from ashe_live.models.material import Material
from ashe_live.models.mesh import Mesh
from ashe_live.quality import BALANCED
from ashe_live.render.scene import Scene

RADIUS_M = 0.03
CENTRE = np.array((0.0, 0.0, RADIUS_M))
GREY = 140
LEFT = 0.2  # of the ground's light, in the shadow
RAYS = 20_000


def _ball(roughness: float) -> Mesh:
    """Of metal, on the marker's centre."""
    polar, around = np.meshgrid(np.linspace(0, math.pi, 33), np.linspace(0, 2 * math.pi, 65), indexing="ij")
    normals = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], -1)
    row, column = np.mgrid[:32, :64].reshape(2, -1)
    a = row * 65 + column
    triangles = np.concatenate([np.stack([a, a + 65, a + 66], 1), np.stack([a, a + 66, a + 1], 1)])
    normals = normals.reshape(-1, 3).astype(np.float32)
    metal = Material(metallic=1.0, roughness=roughness)
    return Mesh(normals * RADIUS_M + CENTRE.astype(np.float32), normals, triangles, material=metal)


def _traced(normal: Float, eye: Float, light: Light, alpha: float) -> tuple[float, float]:
    """What the ball mirrors of the ground, over lit ground, and the share of its lobe that is sky, by tracing rays.

    GGX's facets are drawn by density times cosine, and weighted by how they hide one another (Walter et al. 2007).
    """
    u, v = np.random.default_rng(1).random((2, RAYS))
    cosine = np.sqrt((1 - u) / (1 + (alpha**2 - 1) * u))
    aside = np.cross(normal, (0.0, 0.0, 1.0))
    aside /= np.linalg.norm(aside)
    turned = np.cos(2 * np.pi * v)[:, None] * aside + np.sin(2 * np.pi * v)[:, None] * np.cross(normal, aside)
    facets = cosine[:, None] * normal + np.sqrt(1 - cosine**2)[:, None] * turned
    point = CENTRE + RADIUS_M * normal
    to_eye = (eye - point) / np.linalg.norm(eye - point)
    v_h = facets @ to_eye
    rays = 2 * v_h[:, None] * facets - to_eye
    n_l = rays @ normal
    seen = 2 * n_l / (n_l + np.sqrt(alpha**2 + (1 - alpha**2) * n_l**2))
    weights = np.where((n_l > 0) & (v_h > 0), seen * v_h / cosine, 0.0)
    is_ground = rays[:, 2] < 0
    meets = point + rays * (-point[2] / np.where(is_ground, rays[:, 2], -np.inf))[:, None]
    to_centre = CENTRE - meets
    to_light = light.to_light_marker - light.inverse_distance * meets  # a sun's is the same everywhere
    to_light /= np.linalg.norm(to_light, axis=1, keepdims=True)
    misses2 = (to_centre**2).sum(axis=1) - (to_centre * to_light).sum(axis=1) ** 2
    lit = np.where(misses2 < RADIUS_M**2, LEFT, 1.0) * is_ground
    return float((weights * lit).sum() / weights.sum()), float(weights[~is_ground].sum() / weights.sum())


@pytest.mark.parametrize(
    ("roughness", "inverse_distance"), [*((each, 0.0) for each in (0.1, 0.2, 0.3, 0.4, 0.6)), (0.2, 2.0), (0.4, 2.0)]
)
def test_metal_mirrors_its_shadow_as_wide_and_as_dark_as_its_lobe_meets_it(
    make_renderer, stage, roughness: float, inverse_distance: float
) -> None:
    """The sun or lamp is behind the ball, so that the shadow lies before it and no highlight is seen."""
    tracked = stage.tracked(GREY, stage.pose(-90, 30, 0.25))
    light = replace(stage.light(70, 45, (LEFT,) * 3), inverse_distance=inverse_distance)
    T = tracked.marker.T_cam_marker
    eye = -T[:3, :3].T @ T[:3, 3]
    scene = Scene(tracked, stage.placed(_ball(roughness)), Illumination((light,), seen_in=tracked))
    picture = stage.picture(make_renderer(BALANCED.render), scene)
    errors = []
    for below_deg in range(5, 60, 5):
        for azimuth_deg in range(-120, -59, 15):
            normal = direction_from_angles(math.radians(azimuth_deg), math.radians(-below_deg))
            point = CENTRE + RADIUS_M * normal
            expected, of_sky = _traced(normal, eye, light, roughness**2)
            # Outlines are left out, and what the sky brightens.
            if normal @ (eye - point) < 0.25 * np.linalg.norm(eye - point) or of_sky > 0.1:
                continue
            seen = stage.rgb_at(picture, tracked, tuple(point)) / 255
            errors.append(linear_from_srgb(seen)[1] / linear_from_srgb(GREY / 255) - expected)
    assert len(errors) >= 15
    # Lit ground and shadow are 0.8 apart.
    assert np.sqrt(np.mean(np.square(errors))) < 0.06


@pytest.mark.parametrize("inverse_distance", [0.0, 2.5])
def test_where_satin_metal_mirrors_the_horizon_its_own_shadow_draws_no_line(
    make_renderer, stage, inverse_distance: float
) -> None:
    """What it mirrors there is wide, and all of the shadow is a small part of it; in a sun, and under a lamp."""
    tracked = stage.tracked(GREY, stage.pose(-90, 30, 0.25))
    light = replace(stage.light(70, 45, (LEFT,) * 3), inverse_distance=inverse_distance)
    scene = Scene(tracked, stage.placed(_ball(0.4)), Illumination((light,), seen_in=tracked))
    picture = stage.picture(make_renderer(BALANCED.render), scene)
    # Along the ball's middle, from where it mirrors the ground to where it mirrors the sky, in steps of half a degree.
    tilts = np.radians(np.arange(-10, 40, 0.5))
    points = [CENTRE + RADIUS_M * direction_from_angles(-math.pi / 2, tilt) for tilt in tilts]
    shades = np.array([linear_from_srgb(stage.rgb_at(picture, tracked, tuple(point))[1] / 255) for point in points])
    darker = (shades[:-8] + shades[8:]) / 2 - shades[4:-4]
    assert darker.max() < 0.1 * shades.max()  # 0.3 where a line is
