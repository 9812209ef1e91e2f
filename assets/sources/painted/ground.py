"""The ground: plain, concrete, wood or tiles, with the marker's sheet on it."""

import math

import cv2
import numpy as np

from painted.bodies import Floats

SIDE_M = 0.06
SHEET_SIDES = 1.4
DICTIONARY, MARKER_ID = "DICT_4X4_50", 7
INK, PAPER = 0.04, 0.8


def ground_albedo(kind: str, points: Floats, rng: np.random.Generator) -> Floats:
    """(n, 3), with the marker's sheet on it."""
    x, y = points[:, 0], points[:, 1]
    grain = waves(x, y, rng, 40, 0.004, 0.02) + waves(x, y, rng, 20, 0.05, 0.3)
    if kind == "wood":
        rings = np.sin(2 * math.pi * (y + 0.006 * np.sin(11 * x)) / 0.013 + 2 * waves(x, y, rng, 12, 0.05, 0.2))
        albedo = np.array([0.36, 0.24, 0.14]) * (1 + 0.12 * rings + 0.06 * grain)[:, None]
    elif kind == "tiles":
        joint = (np.abs((x % 0.07) - 0.035) > 0.033) | (np.abs((y % 0.07) - 0.035) > 0.033)
        tone = 1 + 0.1 * np.sin(37 * np.floor(x / 0.07) + 91 * np.floor(y / 0.07))
        albedo = np.where(joint[:, None], 0.2, np.array([0.45, 0.38, 0.32]) * (tone + 0.05 * grain)[:, None])
    elif kind == "concrete":
        albedo = np.array([0.36, 0.35, 0.33]) * (1 + 0.12 * grain)[:, None]
    else:
        albedo = np.array([0.42, 0.4, 0.37]) * (1 + 0.03 * grain)[:, None]
    sheet = (np.abs(x) < SHEET_SIDES * SIDE_M / 2) & (np.abs(y) < SHEET_SIDES * SIDE_M / 2)
    albedo[sheet] = PAPER
    inside = (np.abs(x) < SIDE_M / 2) & (np.abs(y) < SIDE_M / 2)
    cells = cv2.aruco.generateImageMarker(
        cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, DICTIONARY)), MARKER_ID, 6, borderBits=1
    )
    column = np.clip(((x[inside] / SIDE_M + 0.5) * 6).astype(int), 0, 5)
    row = np.clip(((0.5 - y[inside] / SIDE_M) * 6).astype(int), 0, 5)
    albedo[inside] = np.where(cells[row, column] > 127, PAPER, INK)[:, None]
    return albedo


def waves(x: Floats, y: Floats, rng: np.random.Generator, count: int, shortest_m: float, longest_m: float) -> Floats:
    """(n,) a random field of unit deviation with wavelengths in a range."""
    total = np.zeros(len(x))
    for _ in range(count):
        length = math.exp(rng.uniform(math.log(shortest_m), math.log(longest_m)))
        turn, phase = rng.uniform(0, 2 * math.pi, 2)
        total += np.sin(2 * math.pi * (x * math.cos(turn) + y * math.sin(turn)) / length + phase)
    return total / math.sqrt(count / 2)
