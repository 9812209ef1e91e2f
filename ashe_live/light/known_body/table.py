"""The table around a known body, seen from straight above, and what light falls on it."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.pixels.view import View

# Cells to the body's height, and how far the map reaches from its foot: a shadow in a light of 12 degrees is within it.
CELLS_A_HEIGHT, REACH_HEIGHTS = 6, 5.3
SIDE = 2 * round(CELLS_A_HEIGHT * REACH_HEIGHTS) + 1
LEAST_CELLS = 150
LEAST_SHARE = 0.5  # of a cell that must be bare table in the picture
# Light of a cell over the lit table's: brighter ones are things that lie there, or gloss.
BRIGHTEST = 1.4
LINEAR = LINEAR_FROM_SRGB_8BIT.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A map of cells, `places` metres from the marker's centre."""

    light_rgb: Float32  # (n, n, 3) linear, R, G, B
    seen: Mask  # (n, n) cells of which half is bare table in the picture


def linear_picture(view: View) -> Float32:
    """(h, w, 3) linear light, B, G, R."""
    return np.asarray(cv2.LUT(view.image_bgr, LINEAR), dtype=np.float32)


def height_of(body: Proxy) -> float:
    """Metres."""
    return float((body.spheroids_marker[:, 2] + body.spheroids_marker[:, 4]).max())


def places(body: Proxy) -> Float:
    """(n,) metres along x and along y from the body's foot, of the map's columns and of its rows."""
    return np.asarray((np.arange(SIDE) - SIDE // 2) * (height_of(body) / CELLS_A_HEIGHT))


def table_around(view: View, body: Proxy, picture: Float32) -> Table | None:
    """The map of the view's `picture`, averaged over cells; None where next to nothing of the table is in it."""
    along = places(body)
    foot = body.foot_marker
    cell = float(along[1] - along[0])
    marker_from_cell = np.array([(cell, 0, foot[0] + along[0]), (0, cell, foot[1] + along[0]), (0, 0, 1)])
    H = image_from_plane(view.camera, view.T_cam_marker) @ marker_from_cell
    index = np.arange(SIDE)
    depth = H[2, 0] * index[None] + H[2, 1] * index[:, None] + H[2, 2]
    middle = depth[SIDE // 2, SIDE // 2]
    if middle <= 0:
        return None
    # A cell's extent in the picture, as if it were seen from the front.
    cell_px = float(view.camera.K[0, 0]) * cell / middle
    width = max(1, round(cell_px)) | 1
    size = (SIDE, SIDE)

    def seen_from_above(values: Float32) -> Float32:
        averaged = cv2.blur(values, (width, width)) if width > 1 else values
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        return np.asarray(cv2.warpPerspective(averaged, H, size, flags=flags), dtype=np.float32)

    ground = view.is_ground.astype(np.float32)
    share = seen_from_above(ground)
    seen = (share > LEAST_SHARE) & (depth > 0.1 * middle)
    if np.count_nonzero(seen) < LEAST_CELLS:
        return None
    light = seen_from_above(picture * ground[..., None])[..., ::-1] / np.maximum(share, LEAST_SHARE)[..., None]
    return Table(light.astype(np.float32), seen)
