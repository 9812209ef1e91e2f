"""The light from all around, as a small picture of the whole sphere, and what it gives to the ground (NumPy alone)."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
ROWS, COLUMNS = 64, 128
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def directions() -> tuple[Floats, Floats]:
    """(rows, columns, 3) unit vectors, lowest row first, and (rows, columns) solid angles.

    The columns run as in Cycles' equirectangular mapping: azimuth falls from +180 degrees to -180.
    """
    elevation = (np.arange(ROWS) + 0.5) / ROWS * math.pi - math.pi / 2
    azimuth = math.pi - (np.arange(COLUMNS) + 0.5) / COLUMNS * 2 * math.pi
    e, a = np.meshgrid(elevation, azimuth, indexing="ij")
    ways = np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], -1)
    return ways, np.cos(e) * (math.pi / ROWS) * (2 * math.pi / COLUMNS)


def radiance(spec: dict[str, Any]) -> Floats:
    """(rows, columns, 3) linear radiance, scaled so that an open ground gets a luminance of 1 from it."""
    ways, _ = directions()
    up = np.maximum(ways[..., 2], 0)
    rng = np.random.default_rng(spec["seed"])
    a = math.radians(spec["azimuth_deg"])
    side = ways[..., 0] * math.cos(a) + ways[..., 1] * math.sin(a)
    light = BUILDERS[spec["family"]](ways, up, side, spec["lopsided"], rng)
    warmth = np.array([1 + 0.25 * spec["warmth"], 1.0, 1 - 0.3 * spec["warmth"]])
    light = light * warmth
    below = ways[..., 2] < 0
    light[below] = 0.3 * (light[~below].mean(axis=0)) * (0.8 + 0.4 * side[below])[:, None]
    return light / (irradiance(light) @ LUMINANCE)


def irradiance(light: Floats) -> Floats:
    """(3,) what falls onto an open level ground."""
    ways, solid = directions()
    return np.einsum("rcx,rc->x", light, np.maximum(ways[..., 2], 0) * solid)


def mean_direction(light: Floats) -> Floats:
    """(3,) radiance-weighted mean direction over the ground's irradiance, luminance."""
    ways, solid = directions()
    above = np.where(ways[..., 2] > 0, solid, 0) * (light @ LUMINANCE)
    return np.einsum("rcx,rc->x", ways, above) / np.sum(above * np.maximum(ways[..., 2], 0))


def on_ball(light: Floats) -> Floats:
    """(9, 3) what falls onto a facet with the normal n in the shade of all else: the coefficients of `quadratic(n)`.

    Of what lies above the horizon. Irradiance is within a hundredth of a quadratic in n (Ramamoorthi, Hanrahan 2001).
    """
    ways, solid = directions()
    above = np.where(ways[..., 2] > 0, solid, 0.0)
    normals = ways[::4, ::4].reshape(-1, 3)
    facing = np.maximum(np.einsum("nx,rcx->nrc", normals, ways), 0)
    falls = np.einsum("nrc,rc,rck->nk", facing, above, light)
    share = np.sqrt(solid[::4, ::4].reshape(-1, 1))
    return np.asarray(np.linalg.lstsq(quadratic(normals) * share, falls * share, rcond=None)[0])


def slope(light: Floats) -> Floats:
    """(2, 3) what facets that face x and y get beyond the mean of all that are upright."""
    return on_ball(light)[1:3]


def quadratic(normals: Floats) -> Floats:
    """(n, 9) for normals (n, 3)."""
    x, y, z = normals.T
    return np.column_stack([np.ones_like(x), x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1])


def clouds(ways: Floats, rng: np.random.Generator, size: float) -> Floats:
    """(rows, columns) smooth random field in [0, 1] on the sphere."""
    total = np.zeros(ways.shape[:2])
    for _ in range(24):
        wave = rng.normal(size=3) * size
        total += np.sin(ways @ wave * 2 + rng.uniform(0, 2 * math.pi))
    return 1 / (1 + np.exp(-0.6 * total))


def skyline(ways: Floats, rng: np.random.Generator, highest_deg: float) -> Floats:
    """(rows, columns) whether something stands there: trees and houses up to an elevation, all around."""
    azimuth = np.arctan2(ways[..., 1], ways[..., 0])
    top = sum(rng.uniform(-1, 1) / k * np.cos(k * azimuth + rng.uniform(0, 6.3)) for k in range(1, 9))
    top = math.radians(highest_deg) * (0.5 + 0.45 * top)
    return np.arcsin(ways[..., 2]) < top


def _clear_sky(ways: Floats, up: Floats, side: Floats, lopsided: float, rng: np.random.Generator) -> Floats:
    blue = np.array([0.22, 0.38, 0.85]) * (0.5 + 0.7 * (1 - up))[..., None]
    glow = np.array([1.0, 0.95, 0.85]) * (0.9 * lopsided * np.exp(4 * (side - 1)))[..., None]
    white = clouds(ways, rng, 1.6)[..., None] ** 3 * rng.uniform(0, 0.7)
    sky = blue + glow + white * np.array([0.9, 0.92, 0.95])
    return np.where(skyline(ways, rng, 14)[..., None], [0.10, 0.12, 0.08], sky)


def _hazy_sky(_ways: Floats, up: Floats, side: Floats, lopsided: float, _rng: np.random.Generator) -> Floats:
    haze = np.array([0.75, 0.82, 0.95]) * (0.7 + 0.4 * (1 - up))[..., None]
    return haze + np.array([1.0, 0.95, 0.9]) * (2.0 * lopsided * np.exp(3 * (side - 1)))[..., None]


def _overcast(ways: Floats, up: Floats, side: Floats, lopsided: float, rng: np.random.Generator) -> Floats:
    grey = np.array([0.85, 0.9, 1.0]) * ((1 + 2 * up) / 3 * (0.75 + 0.5 * clouds(ways, rng, 1.0)))[..., None]
    return grey * (1 + 0.5 * lopsided * side)[..., None]


def _garden(ways: Floats, up: Floats, side: Floats, lopsided: float, rng: np.random.Generator) -> Floats:
    sky = _clear_sky(ways, up, side, lopsided, rng)
    trees = np.array([0.05, 0.09, 0.03]) * (0.4 + 1.5 * clouds(ways, rng, 9.0))[..., None]
    return np.where(skyline(ways, rng, rng.uniform(30, 65))[..., None], trees, sky)


def _wall_side(ways: Floats, up: Floats, side: Floats, lopsided: float, rng: np.random.Generator) -> Floats:
    """A house's wall near by hides one half of the sky up to high above."""
    sky = _clear_sky(ways, up, -side, lopsided, rng)
    wall = np.array([0.55, 0.5, 0.42]) * rng.uniform(0.2, 1.3)
    return np.where((side > 0.25 + 0.5 * up)[..., None], wall, sky)


def _window_room(ways: Floats, up: Floats, side: Floats, lopsided: float, _rng: np.random.Generator) -> Floats:
    """Bright walls, and a window so wide that what it throws are no shadows with an edge."""
    walls = np.array([0.42, 0.39, 0.34]) * (0.6 + 0.5 * up + 0.25 * side)[..., None]
    window = (side > 0.72) & (ways[..., 2] > 0.02) & (ways[..., 2] < 0.75)
    return walls + np.where(window[..., None], np.array([0.9, 1.0, 1.15]) * (0.7 + 1.6 * lopsided), 0)


def _lamp_room(_ways: Floats, up: Floats, side: Floats, lopsided: float, _rng: np.random.Generator) -> Floats:
    """A lit ceiling, warm walls, darker on one side."""
    walls = np.array([0.5, 0.42, 0.3]) * (0.5 + 0.4 * lopsided * side)[..., None]
    return walls + np.array([1.0, 0.9, 0.72]) * (1.3 * np.clip((up - 0.55) / 0.2, 0, 1))[..., None]


BUILDERS = {
    "clear_sky": _clear_sky, "hazy_sky": _hazy_sky, "overcast": _overcast, "garden": _garden, "wall_side": _wall_side,
    "window_room": _window_room, "lamp_room": _lamp_room,
}  # fmt: skip
