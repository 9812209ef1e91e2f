"""The cube's faces: where each stands on the table, and where it lies in the net that is printed.

The cube stands on its plain face, the sixth. Its frame is the marker frame of everything else: the origin on the table
under the cube's centre, z up, x and y along the cube's edges, as the print on its top is read. Lengths are in edges.
"""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float

USUAL_EDGE_M = 0.06
# Side of the black square on each face, over the edge. The white around it is where shading is measured, and is wide
# enough for the square to be found on a dark table.
TAG_SHARE = 0.7
CUBE = "cube"  # as it is named where other markers are named by dictionary and number
DICTIONARY, FIRST_ID = "aruco:4x4_50", 18


@dataclass(frozen=True, slots=True)
class Face:
    """A printed face of the cube, and its place in the net, a cross of four rows and three columns."""

    name: str
    right: tuple[int, int, int]  # along the upright print, seen from outside
    up: tuple[int, int, int]
    row: int  # in the net, from the top
    column: int
    turns: int  # of the print on the page, quarter turns counter-clockwise

    @property
    def outwards(self) -> Float:
        """(3,) unit normal."""
        # By hand: the tracker asks many times a frame, and NumPy's product takes a hundred times as long.
        (a, b, c), (d, e, f) = self.right, self.up
        return np.array((b * f - c * e, c * d - a * f, a * e - b * d), np.float64)

    @property
    def centre(self) -> Float:
        """(3,) of the cube that stands on the table, edges."""
        return np.array((0.0, 0.0, 0.5)) + 0.5 * self.outwards

    def corners(self, side: float = 1.0) -> Float:
        """(4, 3) of a square of `side` edges in its middle: top-left, top-right, bottom-right, bottom-left."""
        half_right, half_up = 0.5 * side * np.array(self.right), 0.5 * side * np.array(self.up)
        corners = [half_up - half_right, half_up + half_right, half_right - half_up, -half_right - half_up]
        return np.asarray(self.centre + np.array(corners))


# In the order of their numbers. In the net all others adjoin the first, the top, so that the error of each depends on
# one fold alone.
FACES = (
    Face("top", (1, 0, 0), (0, 1, 0), 1, 1, 0),
    Face("front", (1, 0, 0), (0, 0, 1), 2, 1, 0),
    Face("right", (0, 1, 0), (0, 0, 1), 1, 2, 1),
    Face("back", (-1, 0, 0), (0, 0, 1), 0, 1, 2),
    Face("left", (0, -1, 0), (0, 0, 1), 1, 0, 3),
)
CUBE_SPECS = tuple(f"{DICTIONARY}:{FIRST_ID + number}" for number in range(len(FACES)))
# (8, 3) corners of the cube that stands on the table, edges: those below first.
CORNERS: Float = np.array([(x, y, z) for z in (0.0, 1.0) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
CORNERS.flags.writeable = False
