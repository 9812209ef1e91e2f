"""Compares a set made again with a stored one, by tolerance: path tracing differs a little between machines.

    env/bin/python -m scenes.compare sets/training /tmp/again/training

Pictures that only one of them has are passed over, so that a few made again stand for all. Says what differs too much
and ends with exit status 1 if anything does.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

MEAN_LEVELS = 1.5  # mean difference of pixels, of 255: noise is the same, what lies under it nearly
WORST_SHARE = 0.01  # of pixels may differ by more than WORST_LEVELS
WORST_LEVELS = 24
LEAST_MASK_IOU = 0.97
SMALL_MASK_PX = 60  # of a mask this small, a row of border pixels is a large share
NUMBERS = 2e-3  # absolute and relative, of every number of the truth


def numbers_differ(one: Any, other: Any, path: str = "") -> list[str]:
    """Where two JSON values differ: other keys, lengths, words, or numbers beyond the tolerance."""
    if isinstance(one, dict) and isinstance(other, dict):
        if one.keys() != other.keys():
            return [f"{path}: other keys"]
        return [found for key in one for found in numbers_differ(one[key], other[key], f"{path}.{key}")]
    if isinstance(one, list) and isinstance(other, list):
        if len(one) != len(other):
            return [f"{path}: another length"]
        pairs = zip(one, other, strict=True)
        return [found for k, (a, b) in enumerate(pairs) for found in numbers_differ(a, b, f"{path}[{k}]")]
    if isinstance(one, float | int) and isinstance(other, float | int):
        close = bool(np.isclose(one, other, rtol=NUMBERS, atol=NUMBERS))
        return [] if close else [f"{path}: {one} and {other}"]
    return [] if one == other else [f"{path}: {one!r} and {other!r}"]


def pictures_differ(one: Any, other: Any) -> list[str]:
    """What is beyond the tolerance between two pictures (h, w, 3) of 8 bits."""
    if one is None or other is None or one.shape != other.shape:
        return ["no picture, or another size"]
    apart = np.abs(one.astype(np.int16) - other.astype(np.int16))
    mean, worst = float(apart.mean()), float((apart.max(axis=2) > WORST_LEVELS).mean())
    found = [f"differs by {mean:.2f} levels on average"] if mean > MEAN_LEVELS else []
    return [*found, f"{100 * worst:.1f} % of it differ by {WORST_LEVELS} levels"] if worst > WORST_SHARE else found


def masks_differ(one: Any, other: Any) -> list[str]:
    """The same for two masks (h, w)."""
    if one is None or other is None or one.shape != other.shape:
        return ["no mask, or another size"]
    either, both = int(((one | other) > 0).sum()), int(((one & other) > 0).sum())
    if either < SMALL_MASK_PX or both >= LEAST_MASK_IOU * either:
        return []
    return [f"intersection over union {both / either:.3f}"]


def compare(stored: Path, again: Path) -> tuple[int, list[str]]:
    """The number of pictures compared, and what differs too much."""
    first, second = (_entries(folder) for folder in (stored, again))
    differing = []
    for name in first.keys() & second.keys():
        one, other = first[name], second[name]
        found = numbers_differ({**one, "visibility": None}, {**other, "visibility": None})  # counts of pixels
        if "image" in one:
            found += pictures_differ(*(cv2.imread(str(folder / one["image"])) for folder in (stored, again)))
            for kind, file in one["masks"].items():
                pair = (cv2.imread(str(folder / file), cv2.IMREAD_GRAYSCALE) for folder in (stored, again))
                found += [f"{kind}: {each}" for each in masks_differ(*pair)]
        differing += [f"{name}: {each}" for each in found]
    return len(first.keys() & second.keys()), sorted(differing)


def _entries(folder: Path) -> dict[str, Any]:
    content = json.loads((folder / "ground_truth.json").read_text())
    return {entry["id"]: entry for key in ("scenes", "takes") for entry in content.get(key, [])}


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("stored", type=Path)
    ask.add_argument("again", type=Path)
    asked = ask.parse_args()
    count, differing = compare(asked.stored, asked.again)
    print("\n".join([*differing, f"{count} compared, {len(differing)} differences"]))
    raise SystemExit(1 if differing or not count else 0)


if __name__ == "__main__":
    main()
