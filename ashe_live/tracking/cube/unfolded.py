"""Whether the cube's sheet lies in view before it is folded. Of a folded cube no more than three printed faces show."""

from collections.abc import Mapping

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.tracking.cube.faces import FACES, TAG_SHARE, Face

UNFOLDED = "the paper cube's sheet lies flat: cut it out, fold it, and stand the cube on the table"
MOST_FACES = 3  # of the folded cube that a camera sees at once
# Largest distance of corners (RMS) from a flat sheet's, over the side of a square. Those of three faces around a corner
# are off by as much as the side itself.
FLAT_SHARE = 0.1


def lies_unfolded(corners_px: Mapping[int, Float]) -> bool:
    """Whether the faces' squares, corners (4, 2) in picture pixels by number, lie as in the printed net, on a plane."""
    if len(corners_px) <= MOST_FACES:
        return False
    net = np.concatenate([_in_net(FACES[number]) for number in corners_px])
    seen = np.concatenate(list(corners_px.values())).astype(np.float64)
    homography, _ = cv2.findHomography(net, seen)
    if homography is None:
        return False
    off = np.linalg.norm(cv2.perspectiveTransform(net[:, None], homography)[:, 0] - seen, axis=1)
    side = np.mean([np.linalg.norm(np.diff(each, axis=0), axis=1).mean() for each in corners_px.values()])
    return bool(np.sqrt(np.square(off).mean()) < FLAT_SHARE * side)


def _in_net(face: Face) -> Float:
    """(4, 2) corners of the face's square in the net, edges, y down, in the order of `Face.corners`."""
    quarter = np.array([(0.0, 1.0), (-1.0, 0.0)])  # counter-clockwise as seen, y down
    upright = 0.5 * TAG_SHARE * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    turned = upright @ np.linalg.matrix_power(quarter, face.turns).T
    middle = np.array((face.column + 0.5, face.row + 0.5))
    return np.asarray(turned + middle)
