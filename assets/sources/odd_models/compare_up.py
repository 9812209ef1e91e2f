"""Which way up is a file's model taken to stand, of the things that the scenes are furnished with?

python compare_up.py [--seed 1] [--count 200] [--fit]        in an environment with ashe-live

Things of everyday shapes, each in a random turn about its own up, with its foot, its middle or nothing in particular at
the origin, as OBJ, PLY and STL, with y and with z up. --fit prints the weights of up.py by logistic regression.
"""

import argparse
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from scenes.drawing.families import HELD_OUT, OBJECTS, object_params
from scenes.geometry.parts import turned_z
from scenes.geometry.shapes import built

from ashe_live.models.assembly.up import evidence, guessed_up, z_up_from

SUFFIXES, UPS, ORIGINS = (".obj", ".ply", ".stl"), ("y", "z"), ("foot", "middle", "anywhere")


def thing(rng: np.random.Generator, family: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """Parts' places (n, 3), z up, on the ground z = 0, and triangles."""
    yaw_deg = rng.uniform(0, 360)
    return [(turned_z(part.points, yaw_deg), part.faces) for part in built(family, object_params(rng, family))]


def put(parts: list, origin: str, up: str, rng: np.random.Generator) -> list[SimpleNamespace]:
    """As meshes of a file in which `up` is."""
    places = np.concatenate([points for points, _ in parts])
    lower, upper = places.min(axis=0), places.max(axis=0)
    if origin == "foot":
        offset = np.array([*(lower + upper)[:2] / 2, lower[2]])
    else:
        offset = (lower + upper) / 2 + (origin == "anywhere") * rng.uniform(-2, 2, 3) * np.ptp(places, axis=0)
    turn = z_up_from(up)[:3, :3]  # rows in the file's axes: its inverse is its transpose
    return [SimpleNamespace(vertices=(points - offset) @ turn, triangles=faces) for points, faces in parts]


def fitted(evidence: np.ndarray) -> np.ndarray:
    """(k,) for which evidence (n, k) of what is true is the likeliest, by Newton's method, with a weak prior."""
    weights = np.zeros(evidence.shape[1])
    for _ in range(50):
        wrong = 1 / (1 + np.exp(evidence @ weights))
        curvature = (evidence * (wrong * (1 - wrong))[:, None]).T @ evidence + np.eye(len(weights))
        weights += np.linalg.solve(curvature, wrong @ evidence - weights)
    return np.round(weights, 2)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--rare", action="store_true", help="things of other kinds, on which nothing was fitted")
    parser.add_argument("--fit", action="store_true")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    families = HELD_OUT["object"] if options.rare else list(OBJECTS)
    told, signs = [], []
    right: dict[tuple[str, ...], list[bool]] = {}
    for number in range(options.count):
        family = families[number % len(families)]
        parts = thing(rng, family)
        for origin in ORIGINS:
            for up in UPS:
                meshes = put(parts, origin, up, rng)
                told.append(evidence(meshes))
                signs.append(1 if up == "y" else -1)
                for suffix in SUFFIXES:
                    is_right = guessed_up(suffix, meshes) == up
                    for key in ((suffix, up), (origin,), (family,)):
                        right.setdefault(key, []).append(is_right)
    if options.fit:
        print("weights:", fitted(np.array(told) * np.array(signs)[:, None]))
    for key, answers in right.items():
        print(f"{np.mean(answers):4.0%}  {' '.join(key)}")


if __name__ == "__main__":
    main()
