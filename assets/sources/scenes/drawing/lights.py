"""Lights: suns of four kinds, and small lamps near by."""

import math
from collections.abc import Sequence

from scenes.drawing.families import Params, Rng, between, log_between

LIGHT_KINDS = {"plain": 70, "soft": 10, "low": 8, "high": 14}


def sun(rng: Rng, kind: str, avoid_deg: Sequence[float] = ()) -> Params:
    """A light far away: `plain`, `soft`, `low` or `high`; 35 degrees or more from other azimuths."""
    elevation = {"low": (8, 20), "high": (75, 89), "soft": (25, 70)}.get(kind, (20, 75))
    while True:
        azimuth = between(rng, 0, 360)
        if all(abs((azimuth - other + 180) % 360 - 180) > 35 for other in avoid_deg):
            break
    warm = rng.uniform(0, 1) * (1.6 if kind == "low" else 1.0)
    return {
        "kind": kind,
        "azimuth_deg": azimuth,
        "elevation_deg": between(rng, *elevation),
        "angular_diameter_deg": between(rng, 3, 8)
        if kind == "soft"
        else (0.53 if rng.random() < 0.7 else between(rng, 0.5, 2.0)),
        "colour": [1.0, round(1 - 0.14 * warm, 4), round(1 - 0.34 * warm, 4)],
        "strength": log_between(rng, 0.6, 2.5) if kind == "low" else _strength(rng),
    }


def _strength(rng: Rng) -> float:
    """A light's share of the open ground's light over the surroundings': a clear sun, or haze, lamps, bright rooms."""
    return log_between(rng, 3.0, 8.0) if rng.random() < 0.6 else log_between(rng, 0.7, 3.0)


def lamp(rng: Rng, highest_m: float) -> Params:
    """A small spherical lamp 0.2 to 3 m from the marker, well above what stands there."""
    while True:
        distance, azimuth = log_between(rng, 0.2, 3.0), between(rng, 0, 360)
        elevation = between(rng, 22, 80)
        a, e = math.radians(azimuth), math.radians(elevation)
        at = [distance * math.cos(e) * math.cos(a), distance * math.cos(e) * math.sin(a), distance * math.sin(e)]
        if at[2] > 1.25 * highest_m + 0.06:
            break
    warm = rng.uniform(0, 1)
    return {
        "kind": "lamp",
        "position_m": [round(v, 5) for v in at],
        "radius_m": log_between(rng, 0.005, 0.06),
        "azimuth_deg": azimuth,
        "elevation_deg": elevation,
        "colour": [1.0, round(1 - 0.3 * warm, 4), round(1 - 0.6 * warm, 4)],
        "strength": log_between(rng, 0.8, 8.0),
    }
