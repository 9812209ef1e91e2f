"""From which families a scene's object, material, ground and surroundings are drawn, and with which parameters.

Every function takes a generator of random numbers and gives plain values that JSON can hold. Lengths are in metres,
colours linear albedo. `HELD_OUT` names the families that only the sealed set has.
"""

import colorsys
from collections.abc import Mapping
from typing import Any

import numpy as np

Rng = np.random.Generator
Params = dict[str, Any]

HELD_OUT = {
    "object": ("hand", "tape_roll", "chair", "teapot", "pyramid"),
    "ground": ("gravel", "herringbone", "leaf_print", "asphalt"),
}
OBJECTS = {
    "cup": 12, "tumbler": 11, "mug": 9, "bottle": 7, "tin": 6, "vase": 6, "ball": 5, "cone": 3, "carton": 8, "book": 4,
    "blocks": 7, "animal": 4, "figure": 3, "car": 4, "plant": 4, "heap": 2, "ell": 3, "monkey": 3,
}  # fmt: skip
GROUNDS = {
    "plain": 10, "wood": 12, "worn_wood": 7, "concrete": 10, "cracked_concrete": 7, "tiles": 12, "terracotta": 9,
    "brick": 9, "cloth": 9, "relief": 7, "print": 6, "stripes": 4, "stone": 6,
}  # fmt: skip
PLAIN_GROUNDS = ("plain", "concrete", "cloth", "wood", "stone", "tiles")
BUSY_GROUNDS = ("print", "stripes", "brick", "worn_wood", "relief", "cracked_concrete", "terracotta", "tiles", "wood")
MATERIALS = {
    "matte": 14, "plastic": 14, "porcelain": 9, "paper": 11, "thin_plastic": 10, "speckled": 9, "metal": 6,
    "fabric": 5, "printed": 11, "ground_coloured": 9, "painted_wood": 5,
}  # fmt: skip
SURROUNDINGS = {"clear_sky": 26, "hazy_sky": 14, "overcast": 10, "garden": 18, "wall_side": 12, "window_room": 12,
                "lamp_room": 8}  # fmt: skip
CAMERAS = {"phone_hdr": 25, "phone": 20, "phone_old": 15, "plain": 22, "webcam": 18}


def pick(rng: Rng, weights: Mapping[str, float], only: Any = None) -> str:
    names = [name for name in weights if only is None or name in only]
    chance = np.array([weights[name] for name in names], float)
    return str(rng.choice(names, p=chance / chance.sum()))


def between(rng: Rng, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)), 5)


def log_between(rng: Rng, low: float, high: float) -> float:
    return round(float(np.exp(rng.uniform(np.log(low), np.log(high)))), 5)


def colour(rng: Rng, value: tuple[float, float] = (0.08, 0.85), saturation: float = 0.75) -> list[float]:
    """Linear albedo; most things are less than fully saturated."""
    s = float(rng.beta(1.3, 1.7)) * saturation
    v = between(rng, *value)
    srgb = colorsys.hsv_to_rgb(float(rng.uniform()), s, v)
    return [round(max(c**2.2, 0.004), 4) for c in srgb]


def object_params(rng: Rng, family: str) -> Params:
    u = lambda low, high: between(rng, low, high)  # noqa: E731
    if family in ("cup", "tumbler", "mug"):
        above = u(0.030, 0.046)
        params: Params = {"above_m": above, "below_m": round(above * u(0.62, 0.98), 5)}
        if family == "cup":
            return params | {"height_m": u(0.07, 0.13), "lid": bool(rng.random() < 0.6),
                             "sleeve": bool(rng.random() < 0.35)}  # fmt: skip
        if family == "mug":
            return params | {"below_m": round(above * u(0.8, 1.0), 5), "height_m": u(0.075, 0.115), "wall_m": 0.0035,
                             "bulge_m": u(-0.002, 0.004), "handle": u(0.22, 0.36)}  # fmt: skip
        return params | {"height_m": u(0.05, 0.16), "wall_m": u(0.001, 0.003), "bulge_m": u(-0.003, 0.004)}
    if family == "bottle":
        return {"above_m": u(0.018, 0.038), "height_m": u(0.12, 0.21), "neck": u(0.3, 0.5), "body": u(0.45, 0.66)}
    if family == "tin":
        return {"above_m": u(0.024, 0.045), "height_m": u(0.04, 0.12)}
    if family == "vase":
        return {"radii_m": [u(0.014, 0.045) for _ in range(int(rng.integers(4, 7)))], "height_m": u(0.06, 0.17)}
    if family == "ball":
        return {"radius_m": u(0.018, 0.05), "flatten": 1.0 if rng.random() < 0.6 else u(0.7, 1.3)}
    if family == "cone":
        return {"below_m": u(0.022, 0.042), "above_m": u(0.001, 0.016), "height_m": u(0.06, 0.14),
                "foot": bool(rng.random() < 0.5)}  # fmt: skip
    if family == "carton":
        return {"size_m": [u(0.03, 0.1), u(0.025, 0.07), u(0.025, 0.15)], "bevel_m": u(0.0004, 0.004)}
    if family == "book":
        return {"size_m": [u(0.1, 0.17), u(0.08, 0.12), u(0.012, 0.04)], "standing": bool(rng.random() < 0.6)}
    if family == "blocks":
        return {"pieces": [_piece(rng, number) for number in range(int(rng.integers(2, 5)))]}
    if family == "animal":
        return {"size_m": u(0.07, 0.13), "lean": u(-0.1, 0.6), "ears": u(0.06, 0.2)}
    if family == "figure":
        return {"height_m": u(0.07, 0.16), "arm_deg": u(-80, 80), "other_arm_deg": u(-80, 80)}
    if family == "car":
        return {"size_m": [u(0.07, 0.14), u(0.035, 0.055), u(0.03, 0.06)], "cabin": u(0.4, 0.65)}
    if family == "plant":
        return {"pot_m": u(0.025, 0.04), "leaves": int(rng.integers(9, 30)), "leaf_m": u(0.05, 0.1),
                "leaf_width": u(0.14, 0.45), "seed": int(rng.integers(1 << 30))}  # fmt: skip
    if family == "heap":
        return {"radius_m": u(0.04, 0.075), "height_m": u(0.03, 0.07), "steep": u(0.8, 1.8),
                "seed": int(rng.integers(1 << 30))}  # fmt: skip
    if family == "ell":
        return {"size_m": [u(0.05, 0.1), u(0.02, 0.05), u(0.05, 0.12)], "low": u(0.2, 0.6)}
    if family == "monkey":
        return {"size_m": u(0.06, 0.12)}
    if family == "hand":
        return {"size_m": u(0.055, 0.08), "spread": u(0.02, 0.25), "bend": u(0, 0.8)}
    if family == "tape_roll":
        return {"radius_m": u(0.03, 0.055), "width_m": u(0.015, 0.05), "standing": bool(rng.random() < 0.6)}
    if family == "chair":
        return {"size_m": u(0.08, 0.16)}
    if family == "teapot":
        return {"radius_m": u(0.03, 0.055)}
    return {
        "sides": int(rng.integers(3, 7)),
        "radius_m": u(0.03, 0.055),
        "height_m": u(0.05, 0.12),
        "lean": u(-0.5, 0.5),
    }


def _piece(rng: Rng, number: int) -> Params:
    wide = between(rng, 0.028, 0.07) if number == 0 else between(rng, 0.018, 0.055)
    return {
        "kind": str(rng.choice(["box", "box", "post", "roll"])),
        "size_m": [wide, between(rng, 0.5, 1.0) * wide, between(rng, 0.014, 0.05)],
        "at_m": [0.0, 0.0] if number == 0 else [between(rng, -0.012, 0.012), between(rng, -0.008, 0.008)],
        "yaw_deg": between(rng, -40, 40),
        "taper": between(rng, 0.3, 1.0),
    }


def material(rng: Rng, ground: Params, dark: bool = False, family: str | None = None) -> Params:
    """An object's material; `dark`: nearly black. Something made of the ground's own colour is drawn from `ground`."""
    name = family or pick(rng, MATERIALS)
    base = colour(rng, (0.05, 0.25), 0.5) if dark else colour(rng)
    white = [round(c, 4) for c in np.array([0.80, 0.77, 0.70]) * rng.uniform(0.8, 1.05) * rng.uniform(0.94, 1.0, 3)]
    pale = not dark and rng.random() < {"porcelain": 0.75, "paper": 0.75, "thin_plastic": 0.65, "speckled": 0.7}.get(
        name, 0.12
    )
    if pale:
        base = white
    if name == "ground_coloured":
        base = [round(c, 4) for c in np.clip(np.array(ground["colour"]) * rng.uniform(0.8, 1.35), 0.01, 0.85)]
    return {
        "family": name,
        "colour": base,
        "second": colour(rng, (0.05, 0.9)) if rng.random() < 0.6 else [round(0.75 * c, 4) for c in base],
        "roughness": between(rng, 0.12, 0.4)
        if name in ("plastic", "thin_plastic", "metal")
        else between(rng, 0.4, 0.85),
        "translucent": between(rng, 0.1, 0.45) if name in ("thin_plastic", "paper") else 0.0,
        "scale": log_between(rng, 25, 140),
        "pattern": str(rng.choice(["bands", "checks", "label", "dots"])),
        "seed": between(rng, 0, 100),
    }


PRINTED_GROUNDS = ("print", "stripes", "leaf_print")
GROUND_COLOURS = {
    "wood": [(0.40, 0.25, 0.13), (0.27, 0.14, 0.06), (0.55, 0.40, 0.24), (0.12, 0.06, 0.03)],
    "worn_wood": [(0.33, 0.27, 0.21), (0.24, 0.18, 0.13), (0.42, 0.36, 0.28)],
    "concrete": [(0.33, 0.32, 0.30), (0.45, 0.43, 0.40), (0.22, 0.22, 0.21)],
    "cracked_concrete": [(0.36, 0.34, 0.31), (0.28, 0.27, 0.25)],
    "tiles": [(0.36, 0.40, 0.38), (0.62, 0.60, 0.55), (0.18, 0.20, 0.24), (0.50, 0.40, 0.28)],
    "terracotta": [(0.45, 0.16, 0.055), (0.36, 0.13, 0.06), (0.50, 0.22, 0.09)],
    "brick": [(0.30, 0.085, 0.055), (0.36, 0.16, 0.10), (0.26, 0.20, 0.17)],
    "stone": [(0.42, 0.34, 0.19), (0.34, 0.33, 0.31), (0.52, 0.47, 0.40)],
    "asphalt": [(0.09, 0.09, 0.09), (0.15, 0.145, 0.14)],
    "gravel": [(0.33, 0.29, 0.24), (0.28, 0.28, 0.28)],
    "herringbone": [(0.42, 0.24, 0.11), (0.25, 0.12, 0.05)],
}


def ground(rng: Rng, family: str, dark: bool = False) -> Params:
    """A ground's parameters; `colour` is its usual albedo."""
    if family in GROUND_COLOURS:
        choices = GROUND_COLOURS[family]
        base = np.array(choices[int(rng.integers(len(choices)))]) * rng.uniform(0.8, 1.2) * rng.uniform(0.93, 1.07, 3)
    else:
        base = np.array(colour(rng, (0.35, 0.88), 0.4))
    if dark:
        base = base * (0.07 / max(base.mean(), 0.07))
    shiny = family in ("tiles", "wood") and rng.random() < 0.45
    mossy = family in ("brick", "cracked_concrete", "stone") and rng.random() < 0.5
    pale = np.clip(base * rng.uniform(0.35, 0.75), 0.01, 0.8)
    return {
        "family": family,
        "colour": [round(float(c), 4) for c in np.clip(base, 0.012, 0.8)],
        "second": colour(rng, (0.1, 0.9)) if family in PRINTED_GROUNDS else [round(float(c), 4) for c in pale],
        "contrast": between(rng, 0.3, 1.0),
        "scale": log_between(rng, 0.6, 1.7),
        "yaw_deg": between(rng, 0, 360),
        "offset": [between(rng, -5, 5), between(rng, -5, 5)],
        "gloss": between(rng, 0.12, 0.35) if shiny else between(rng, 0.45, 0.9),
        "relief": between(rng, 0.3, 1.0),
        "dirt": between(rng, 0.0, 0.6),
        "moss": between(rng, 0.2, 0.8) if mossy else 0.0,
        "edge_m": between(rng, 0.35, 0.9) if rng.random() < 0.2 else None,
        "round": bool(rng.random() < 0.4),
    }  # fmt: skip


def surroundings(rng: Rng, family: str) -> Params:
    return {
        "family": family,
        "azimuth_deg": between(rng, 0, 360),
        "lopsided": between(rng, 0.0, 1.0),
        "warmth": between(rng, -0.5, 1.0) if family.endswith("room") else between(rng, -0.8, 0.3),
        "seed": int(rng.integers(1 << 30)),
    }
