"""Notes what a model's polished metal mirrors: the ground is seen, but not its own parts, and the sky is made up.

The model is a grid of cells, a point on its surface in each that it fills; rays are looked up in it in steps.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.assembly.shading_normals import unit_rows
from ashe_live.models.mesh import Mesh, spread_over_triangle

ITSELF = "its polished metal mirrors ground and sky, and not the model's other parts"
SKY = "its polished metal mirrors a sky that is made up, as the picture shows the ground alone"
BOTH = "its polished metal mirrors the ground and a sky that is made up, and not the model's other parts"
POLISHED = 0.6  # above this roughness, a reflection is a mere tone
# Above this roughness the pattern of the made-up sky is blurred away: half of the reflected light comes from within an
# angle of 2 roughness^2, and a texel of the pattern is 15 degrees wide (render/reflections/surroundings.py).
CLEAR_AS_MIRRORS = 0.36
CELLS = 48  # along the longest side
POINTS, LOOKED_AT = 20_000, 1_000  # points on the surface that fill the cells; points of these that are examined
LOOKED_FROM_RAD, WAYS = np.radians(35.0), 6  # elevation of the views, as on a table, and their number all around
LEAST_FACING = 0.1  # least cosine between a normal and the view
START_CELLS = 1.5  # distance from its own surface, in cells, at which a ray begins
LEAST_SHARE = 0.05  # least share of the surface that is seen for a note: about what is noticed at a glance


def words_on_mirrors(parts: Sequence[Mesh]) -> str | None:
    """ITSELF, SKY or BOTH: what would be seen in metal on more than LEAST_SHARE of what is seen of the surface."""
    roughness = np.array([_roughness_of_metal(part) for part in parts])
    if not (roughness < POLISHED).any():
        return None
    part, places, normals = _points_on(parts)
    cells = _Cells(places)
    some = slice(None, None, max(1, len(part) // LOOKED_AT))
    part, places, normals = part[some], places[some], normals[some]
    both_sides = np.array([each.material.double_sided for each in parts])[part]
    seen = itself = sky = 0
    for turn in range(WAYS):
        azimuth = 2 * np.pi * turn / WAYS
        flat = np.cos(LOOKED_FROM_RAD)
        view = np.array((flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(LOOKED_FROM_RAD)))
        facing = np.where((normals @ view < 0)[:, None] & both_sides[:, None], -normals, normals)
        starts = places + START_CELLS * cells.size * facing
        ahead = facing @ view > LEAST_FACING
        starts, facing, rough = starts[ahead], facing[ahead], roughness[part[ahead]]
        is_seen = ~cells.filled_along(starts, np.broadcast_to(view, starts.shape))
        seen += int(is_seen.sum())
        mirrors = is_seen & (rough < POLISHED)
        starts, facing, rough = starts[mirrors], facing[mirrors], rough[mirrors]
        towards = 2 * (facing @ view)[:, None] * facing - view
        is_itself = cells.filled_along(starts, towards)
        itself += int(is_itself.sum())
        sky += int((~is_itself & (towards[:, 2] > 0) & (rough < CLEAR_AS_MIRRORS)).sum())
    shows_itself, shows_sky = itself > LEAST_SHARE * seen, sky > LEAST_SHARE * seen
    return {(True, True): BOTH, (True, False): ITSELF, (False, True): SKY}.get((shows_itself, shows_sky))


def _roughness_of_metal(part: Mesh) -> float:
    """1 for what is none."""
    metal, roughness = part.material.metallic, part.material.roughness
    texels = part.material.metallic_roughness_map
    if texels is not None:
        roughness *= float(texels[..., 1].mean()) / 255
        metal *= float(texels[..., 2].mean()) / 255
    return roughness if metal > 0.5 else 1.0


def _points_on(parts: Sequence[Mesh]) -> tuple[NDArray[np.int64], Float, Float]:
    """Points spread evenly over the surface: (n,) their parts, (n, 3) their places and unit normals."""
    areas = [part.areas for part in parts]
    before, total = 0.0, sum(float(each.sum()) for each in areas)
    numbers, places, normals = [], [], []
    for number, (part, each) in enumerate(zip(parts, areas, strict=True)):
        reached = np.floor((before + np.concatenate([[0.0], np.cumsum(each)])) / total * POINTS).astype(int)
        before += float(each.sum())
        triangle = np.repeat(np.arange(len(each)), np.diff(reached))
        shares = spread_over_triangle(np.arange(len(triangle)))
        corners = part.triangles[triangle]
        numbers.append(np.full(len(triangle), number))
        places.append(np.einsum("ij,ijk->ik", shares, part.vertices[corners]))
        normals.append(unit_rows(np.einsum("ij,ijk->ik", shares, part.normals[corners])))
    return np.concatenate(numbers), np.concatenate(places), np.concatenate(normals)


class _Cells:
    """The box around all places (n, 3), in cubes that hold some of them or none."""

    def __init__(self, places: Float) -> None:
        self._lower = places.min(axis=0)
        self.size = max(float(np.ptp(places, axis=0).max()) / CELLS, 1e-30)
        self._filled = np.zeros((CELLS + 1,) * 3, np.bool_)
        self._filled[tuple(((places - self._lower) / self.size).astype(int).T)] = True

    def filled_along(self, starts: Float, directions: Float) -> NDArray[np.bool_]:
        """(n,) whether the ray from a place along a unit direction comes through a cell that is filled."""
        found = np.zeros(len(starts), np.bool_)
        at, step = (starts - self._lower) / self.size, directions / 2
        for number in range(2, round(2 * CELLS * 3**0.5)):
            cells = np.floor(at + number * step).astype(int)
            inside = ((cells >= 0) & (cells <= CELLS)).all(axis=1)
            found |= inside & self._filled[tuple(np.clip(cells, 0, CELLS).T)]
        return found
