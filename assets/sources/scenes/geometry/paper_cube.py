"""The folded paper cube: five printed faces as they lie, bulged, and the folds that join them (NumPy alone).

A face is given by its corners as it lies, in the print's order: top-left, top-right, bottom-right, bottom-left. Where
two faces were one edge before they were folded badly, a strip of paper joins them: no light falls through a fold.
"""

from typing import Any

import numpy as np
from mesh_grids import grid_faces

from scenes.geometry.parts import Floats, Part

Params = dict[str, Any]
NET = "cube_net.png"  # beside the specifications: the printed page, cut to the squares of its net
CELLS = 8  # of a face's grid, along each side
ADJOINING = 0.15  # of an edge: how near the ends of two faces' sides lie that are one fold
INWARDS = 0.06  # of the way from a face's side to its middle, where it is white: lines are printed along the sides
LOWEST_M = 0.0002  # of what stands on the table


def paper_cube(p: Params) -> list[Part]:
    """All of it, as `sheets` has it."""
    return [Part(points, grid_faces(*(count - 1 for count in shape)), 0, True) for points, shape, _ in sheets(p)]


def sheets(p: Params) -> list[tuple[Floats, tuple[int, int], Floats]]:
    """Of each face, each fold and the plain bottom: (rows * columns, 3) points, rows and columns, and their places
    (rows * columns, 2) in the printed net, both from 0 to 1, downwards.
    """
    grids = [_face(np.asarray(each["corners_m"]), each["bulge_m"]) for each in p["faces"]]
    nets = [_between(np.asarray(each["net"])) for each in p["faces"]]
    made = [*zip(grids, nets, strict=True), *_folds(p["edge_m"], grids, nets), _bottom(p)]
    for grid, _ in made:
        grid[..., 2] = np.maximum(grid[..., 2], LOWEST_M)
    return [(grid.reshape(-1, 3), grid.shape[:2], net.reshape(-1, 2)) for grid, net in made]


def _between(corners: Floats) -> Floats:
    """(n, n, d) places between four corners (4, d)."""
    u = np.linspace(0, 1, CELLS + 1)[None, :, None]
    v = np.linspace(0, 1, CELLS + 1)[:, None, None]
    return np.asarray((1 - v) * ((1 - u) * corners[0] + u * corners[1]) + v * ((1 - u) * corners[3] + u * corners[2]))


def _face(corners: Floats, bulge_m: float) -> Floats:
    outwards = np.cross(corners[1] - corners[0], corners[0] - corners[3])
    across = np.linspace(-1, 1, CELLS + 1)
    bulged = bulge_m * (1 - across[:, None] ** 2) * (1 - across[None] ** 2)
    return np.asarray(_between(corners) + bulged[..., None] * outwards / np.linalg.norm(outwards))


def _folds(edge_m: float, grids: list[Floats], nets: list[Floats]) -> list[tuple[Floats, Floats]]:
    """A strip of two rows between the sides of two faces that were one edge."""
    sides = [
        (number, grid[at], net[at] + INWARDS * (net.mean(axis=(0, 1)) - net[at]))
        for number, (grid, net) in enumerate(zip(grids, nets, strict=True))
        for at in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1])
    ]
    found = []
    for k, (one, side, net) in enumerate(sides):
        for other, facing, _ in sides[k + 1 :]:
            for there in (facing, facing[::-1]):
                away = np.linalg.norm(side[[0, -1]] - there[[0, -1]], axis=1).max()
                if other != one and away < ADJOINING * edge_m:
                    found.append((np.stack([side, there]), np.stack([net, net])))
    return found


def _bottom(p: Params) -> tuple[Floats, Floats]:
    """The plain face, on the table, from the sides' lower edges."""
    h = 0.49 * p["edge_m"]
    corners = np.array([(-h, h, 0.0), (h, h, 0.0), (h, -h, 0.0), (-h, -h, 0.0)])
    return _between(corners), np.full((CELLS + 1, CELLS + 1, 2), 0.01)
