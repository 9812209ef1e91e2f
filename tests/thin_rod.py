"""A model of half a pixel's width, which one sample a pixel breaks into dashes."""

from pathlib import Path

import numpy as np

ENDS = np.array([(-0.04, -0.01, 0.03), (0.04, 0.012, 0.05)])
HALF_WIDTH_M = 0.00025
QUADS = ((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (3, 2, 1, 0), (4, 5, 6, 7))


def write_rod(path: Path) -> Path:
    """An OBJ file with z up."""
    corners = HALF_WIDTH_M * np.array([(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)])
    points = (ENDS[:, None] + corners).reshape(-1, 3)
    lines = [f"v {x} {y} {z}" for x, y, z in points.tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in quad) for quad in QUADS]
    path.write_text("\n".join(lines) + "\n")
    return path


def unevenness(alpha: np.ndarray) -> float:
    """The coefficient of variation of (h, w) alpha along a rod that lies across the picture, without its ends."""
    (columns,) = np.nonzero((alpha > 60).any(axis=0))
    along = alpha[:, columns[0] + 3 : columns[-1] - 3].max(axis=0).astype(float)
    return float(along.std() / along.mean())
