"""How much of the sky and of a light's disc the ground sees past the bodies on it."""

import math

import numpy as np

from painted.bodies import Convex, Floats

SUN_SAMPLES, SKY_SAMPLES = 16, 24
NEAR_M = 0.3  # beyond, an object hides none of the sky that counts


def open_sky(points: Floats, bodies: tuple[Convex, ...]) -> Floats:
    """(n,) share of a cosine-weighted sky that ground points see past the bodies."""
    share = np.ones(len(points))
    count = np.arange(SKY_SAMPLES)
    radius, turn = np.sqrt((count + 0.5) / SKY_SAMPLES), count * math.pi * (3 - math.sqrt(5))
    ways = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)])
    for body in bodies:
        near = np.linalg.norm(points[:, :2] - body.middle[:2], axis=1) < NEAR_M
        for way in ways:
            share[near] -= body.blocks(points[near], np.broadcast_to(way, points[near].shape)) / SKY_SAMPLES
    return np.clip(share, 0, 1)


def open_disc(points: Floats, bodies: tuple[Convex, ...], sun: Floats, diameter_rad: float) -> Floats:
    """(n,) share of the disc of a light (4,) that ground points see past the bodies; as wide as it is at the marker."""
    towards = sun[:3]
    east = np.cross((0, 0, 1.0) if towards[2] < 0.999 else (0, 1.0, 0), towards)
    east /= np.linalg.norm(east)
    up = np.cross(towards, east)
    share = np.zeros(len(points))
    for i in range(SUN_SAMPLES):
        radius, turn = math.tan(diameter_rad / 2) * math.sqrt((i + 0.5) / SUN_SAMPLES), i * math.pi * (3 - math.sqrt(5))
        place = np.append(towards + radius * (math.cos(turn) * east + math.sin(turn) * up), sun[3])
        share += ~np.any([b.shades(points, place) for b in bodies], axis=0)
    return share / SUN_SAMPLES
