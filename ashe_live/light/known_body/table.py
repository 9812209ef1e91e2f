"""The table around a known body, seen from straight above, and what light falls on it."""

from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, upper_quantile
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import image_from_plane
from ashe_live.light.pixels.view import View

# Cells to the body's height, and how far the map reaches from its foot: a shadow in a light of 12 degrees is within it.
CELLS_A_HEIGHT, REACH_HEIGHTS = 6, 5.3
SIDE = 2 * round(CELLS_A_HEIGHT * REACH_HEIGHTS) + 1
LEAST_CELLS = 150  # of bare table in view, of the map's SIDE**2: with fewer, nothing is said of lights
FINER = 3  # a cell is averaged over so many places in each direction
LEAST_SHARE = 0.95  # of a cell that must be bare table in the picture: all places of it
GROUND = 255  # value of the ground in a mask
# Light of a cell over the lit table's: brighter ones are things that lie there, or gloss.
BRIGHTEST = 1.4
LINEAR = LINEAR_FROM_SRGB_8BIT.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class TableMap:
    """A map of cells, at `places` around the body's foot."""

    light_rgb: Float32  # (n, n, 3) linear, R, G, B
    seen: Mask  # (n, n) cells that are bare table in the picture


def linear_picture(view: View) -> Float32:
    """(h, w, 3) linear light, B, G, R."""
    return np.asarray(cv2.LUT(view.image_bgr, LINEAR), dtype=np.float32)


def height_px(body: Proxy, view: View) -> float:
    """Of the body in the picture, as if seen from the side."""
    return float(view.camera.K[0, 0]) * body.height_m / float(np.linalg.norm(view.T_cam_marker[:3, 3]))


def cell_m(body: Proxy) -> float:
    """Metres along a cell of the map."""
    return body.height_m / CELLS_A_HEIGHT


def places(body: Proxy) -> Float:
    """(n,) metres along x and along y from the body's foot, of the map's columns and of its rows."""
    return np.asarray((np.arange(SIDE) - SIDE // 2) * cell_m(body))


def pixel_from_cell(view: View, body: Proxy) -> Float:
    """(3, 3) homography from the map's cells (column, row, 1), whose centres are integers, to pixels and depth."""
    along, foot = places(body), body.foot_marker
    cell = cell_m(body)
    marker_from_cell = np.array([(cell, 0, foot[0] + along[0]), (0, cell, foot[1] + along[0]), (0, 0, 1)])
    return np.asarray(image_from_plane(view.camera, view.T_cam_marker) @ marker_from_cell)


def table_around(view: View, body: Proxy, picture: Float32) -> TableMap | None:
    """The map of the view's `picture`, averaged over cells; None where next to nothing of the table is in it."""
    H = pixel_from_cell(view, body)
    index = np.arange(SIDE)
    depth = H[2, 0] * index[None] + H[2, 1] * index[:, None] + H[2, 2]
    middle = depth[SIDE // 2, SIDE // 2]
    if middle <= 0:
        return None
    to_finer = np.array([(1 / FINER, 0, 0.5 / FINER - 0.5), (0, 1 / FINER, 0.5 / FINER - 0.5), (0, 0, 1)])

    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    finer = cv2.warpPerspective(picture, H @ to_finer, (FINER * SIDE, FINER * SIDE), flags=flags)
    ground = view.is_ground.view(np.uint8) * np.uint8(GROUND)
    # A place is bare table if all pixels around it are.
    bare = cv2.warpPerspective(ground, H @ to_finer, (FINER * SIDE, FINER * SIDE), flags=flags) == GROUND
    share = _by_cells(bare.astype(np.float32))
    seen = (share > LEAST_SHARE) & (depth > 0.1 * middle)
    if np.count_nonzero(seen) < LEAST_CELLS:
        return None
    light = _by_cells(np.asarray(cv2.copyTo(finer, bare.view(np.uint8)), dtype=np.float32))[..., ::-1]
    return TableMap((light / np.maximum(share, LEAST_SHARE)[..., None]).astype(np.float32), seen)


def _by_cells(finer: Float32) -> Float32:
    """(n, n) or (n, n, 3) means over the places of each cell."""
    return np.asarray(cv2.resize(finer, (SIDE, SIDE), interpolation=cv2.INTER_AREA), dtype=np.float32)


def relative_light(table: TableMap) -> tuple[Float32, Float]:
    """(n, n, 3) light over the lit table's, where cells that are not seen have 1; and (3,) the lit table's."""
    seen = table.light_rgb[table.seen].T
    # Most of the table is lit, and what is not is darker.
    lit = np.maximum([upper_quantile(channel, 0.65) for channel in seen], 1e-4)
    return np.where(table.seen[..., None], table.light_rgb / lit.astype(np.float32), np.float32(1)), lit


def sent_by_table(body: Proxy, table: TableMap, relative: Float32, normals: Float, centres: Float) -> Float:
    """(m, 3) light that the table sends to facets at `centres` (m, 3), over what it would send, all lit, to one above.

    relative: (n, n, 3) as by `relative_light`. The table is as lit as its map says, and beyond it as the open table is.
    """
    along, foot = places(body), body.foot_marker
    missing = (1 - np.minimum(relative, 1.0)) * table.seen[..., None]
    missing = np.asarray(missing.reshape(-1, 3))
    sent = np.empty((len(normals), 3))
    for number, (normal, centre) in enumerate(zip(normals, centres, strict=True)):
        x, y = along[None] + foot[0] - centre[0], along[:, None] + foot[1] - centre[1]
        squared = x * x + y * y + centre[2] ** 2
        facing = np.maximum(x * normal[0] + y * normal[1] - centre[2] * normal[2], 0.0)
        form = facing * centre[2] / (np.pi * squared**2) * cell_m(body) ** 2
        sent[number] = 0.5 * (1 - float(normal[2])) - form.reshape(-1) @ missing
    return sent
