"""The visual hull of an object: all of space that its silhouettes in several views, and its shadow, allow it.

A grid of voxels above the plane loses those that some view sees as no object (Laurentini, "The visual hull concept",
1994), and, for a light, those whose shadow would fall on ground that is surely lit. The truth survives both, so that in
the right light what is left fills every silhouette and its shadow darkens every place in shadow; in a wrong one it does
not (silhouette coherence: Hernandez, Schmitt and Cipolla, 2007, with the light as another camera).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.hull.labelled import Labelled
from ashe_live.light.pixels.areas import distance_to
from ashe_live.light.shape.directions import displacement_of
from ashe_live.light.shape.predicted import Predicted

VOXELS = 48  # along the longest side of the box: about a pixel of the region each
CLOSE_PX = 1.25  # of a silhouette's border, or a lit area's: nearer to it labels and voxels are not certain
SEEN_BY = 0.5  # least share of the views that a voxel must be in, and two at least
LIT_IN = 2  # number of views that must show ground as lit where no shadow may fall
MARGIN = 6  # of the plane around the box, in its longest sides: shadows of lights lower than 10 degrees leave it
COARSER = 8  # of the plane's cells in which it is found out whether pictures show them
CLOSING = np.ones((3, 3), np.uint8)  # closes gaps between the images of neighbouring voxels


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """A box on the plane, its sides along the marker's axes, and the grid of cubic voxels in it."""

    low: Float  # (3,) metres
    voxel_m: float
    shape: tuple[int, int, int]  # voxels along x, y, z

    @staticmethod
    def around(points: Float, share: float) -> "Box":
        """Around points (n, 3) above the plane, widened by a share of their size."""
        low, high = points.min(axis=0), points.max(axis=0)
        half = 0.5 * float(max(high[0] - low[0], high[1] - low[1], 0.5 * high[2])) * (1 + share)
        middle = 0.5 * (low + high)[:2]
        size = np.array([2 * half, 2 * half, float(high[2]) * (1 + share)])
        voxel_m = float(size.max()) / VOXELS
        x, y, z = np.ceil(size / voxel_m).astype(int).tolist()
        return Box(np.array([*(middle - half), 0.0]), voxel_m, (x, y, z))

    def centres(self) -> Float:
        """(n, 3) the voxels' centres."""
        axes = [self.low[i] + (np.arange(self.shape[i]) + 0.5) * self.voxel_m for i in range(3)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True, slots=True, eq=False)
class InLight:
    """What the hull explains in a light."""

    cost: float  # of the pixels of all views, over their cheapest labels
    kept: Mask  # (n,) the voxels that cast no shadow onto lit ground
    masks: list[Predicted]  # in each view


@dataclass(frozen=True, slots=True, eq=False)
class Carved:
    """Voxels that all silhouettes allow, where each view sees them, and the plane that their shadows fall on."""

    views: Sequence[Labelled]
    box: Box
    flat: NDArray[np.intp]  # (n,) indices of the voxels in the box
    centres: Float  # (n, 3) metres, marker frame
    pixels: list[NDArray[np.intp]]  # (n,) of each view: index of the pixel that shows a voxel; h w for none
    plane_low: Float  # (2,) metres
    plane_shape: tuple[int, int]
    # (h, w) of each view: index of the plane's cell that a pixel shows; the number of cells for none.
    cells: list[NDArray[np.intp]]
    lit: Mask  # (cells + 1,) where no shadow may fall: neither on lit ground nor, last, beyond the plane's cells

    @property
    def middle(self) -> Float:
        """(3,) the middle of the voxels; of the box where there are none."""
        if len(self.centres):
            return np.asarray(0.5 * (self.centres.min(axis=0) + self.centres.max(axis=0)))
        return self.box.low + 0.5 * self.box.voxel_m * np.array(self.box.shape)

    def in_light(self, to_light: Float) -> InLight:
        """What the voxels explain in the light from direction (3,), marker frame."""
        shadows = self.centres[:, :2] - self.centres[:, 2:] * displacement_of(to_light)
        at = _cells_of(shadows, self.plane_low, self.box.voxel_m, self.plane_shape)
        kept = ~self.lit[at]
        darkened = np.append(_filled(at[kept], self.plane_shape), False)
        cost, masks = 0.0, []
        for view, pixels, cells in zip(self.views, self.pixels, self.cells, strict=True):
            body = _filled(pixels[kept], view.as_lit.shape)
            shadow = darkened[cells] & ~body
            cost += view.cost(body, shadow)
            masks.append(Predicted(body, shadow))
        return InLight(cost, kept, masks)


def carved(views: Sequence[Labelled], box: Box) -> Carved:
    """The voxels of `box` that no view refutes and enough views see, and the plane around them."""
    centres = box.centres()
    refuted, seen, pixels = np.zeros(len(centres), np.bool_), np.zeros(len(centres), np.intp), []
    for view in views:
        at = _pixels_of(centres, view)
        pixels.append(at)
        seen += at < view.as_lit.size
        inside = distance_to(~view.never_body) > CLOSE_PX
        refuted |= np.append(inside.ravel(), False)[at]
    allowed = np.flatnonzero(~refuted & (seen >= max(2, SEEN_BY * len(views))))
    low, shape = _plane_around(box)
    cells = [_cells_of(view.plane_xy, low, box.voxel_m, shape) for view in views]
    return Carved(
        views=views,
        box=box,
        flat=allowed,
        centres=centres[allowed],
        pixels=[at[allowed] for at in pixels],
        plane_low=low,
        plane_shape=shape,
        cells=cells,
        lit=np.append(_lit_cells(views, low, box.voxel_m, shape), True),
    )


def _pixels_of(points: Float, view: Labelled) -> NDArray[np.intp]:
    """(n,) index of the pixel that shows each point (n, 3); the number of pixels where none does."""
    height, width = view.as_lit.shape
    seen = points @ view.P[:, :3].T + view.P[:, 3]
    depth = np.where(seen[:, 2] > 0, seen[:, 2], np.inf)
    u, v = np.rint(np.clip(seen[:, :2] / depth[:, None], -1, 1e6)).astype(np.intp).T
    inside = (seen[:, 2] > 0) & (u >= 0) & (u < width) & (v >= 0) & (v < height)
    return np.asarray(np.where(inside, v * width + u, height * width))


def _plane_around(box: Box) -> tuple[Float, tuple[int, int]]:
    """The corner (2,) and the cells along x and y of the plane that shadows may fall on, each as large as a voxel."""
    x, y, _ = box.shape
    margin = MARGIN * VOXELS
    return box.low[:2] - margin * box.voxel_m, (x + 2 * margin, y + 2 * margin)


def _cells_of(places: Float, low: Float, cell_m: float, shape: tuple[int, int]) -> NDArray[np.intp]:
    """(...) index of the cell of the plane at places (..., 2); the number of cells for those outside."""
    along = np.clip((places - low) / cell_m, -1, max(shape))
    x, y = np.floor(along[..., 0]).astype(np.intp), np.floor(along[..., 1]).astype(np.intp)
    inside = (x >= 0) & (x < shape[0]) & (y >= 0) & (y < shape[1])
    return np.asarray(np.where(inside, x * shape[1] + y, shape[0] * shape[1]))


def _lit_cells(views: Sequence[Labelled], low: Float, cell_m: float, shape: tuple[int, int]) -> Mask:
    """(cells,) where LIT_IN views show lit ground, or ground outside of their regions, which hold all that is unlit."""
    # From cells, columns along y, to metres; rows are along x.
    plane_from_cells = np.array(
        [[0.0, cell_m, low[0] + cell_m / 2], [cell_m, 0.0, low[1] + cell_m / 2], [0.0, 0.0, 1.0]]
    )
    count = np.zeros(shape, np.uint8)
    for view in views:
        H = view.P[:, [0, 1, 3]] @ plane_from_cells
        lit = (distance_to(~view.surely_lit) > CLOSE_PX).astype(np.uint8)
        flags = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
        seen = cv2.warpPerspective(lit, H, shape[::-1], flags=flags, borderMode=cv2.BORDER_CONSTANT, borderValue=2)
        count += np.where(np.asarray(seen) == 2, _in_frame(view, H, shape), seen).astype(np.uint8)
    return np.asarray(count >= LIT_IN).ravel()


def _in_frame(view: Labelled, H: Float, shape: tuple[int, int]) -> Mask:
    """Whether the view's whole frame shows each cell of the plane, every COARSERth of which is looked at."""
    y, x = np.meshgrid(*(np.arange(0, side, COARSER) + COARSER // 2 for side in shape[::-1]))
    at = np.stack([y, x, np.ones_like(x)], axis=-1) @ H.T
    depth = np.where(at[..., 2] > 0, at[..., 2], np.inf)
    u, v = at[..., 0] / depth, at[..., 1] / depth
    left, top, right, bottom = view.frame_px
    inside = (at[..., 2] > 0) & (u > left) & (u < right) & (v > top) & (v < bottom)
    return np.kron(inside, np.ones((COARSER, COARSER), np.bool_))[: shape[0], : shape[1]]


def _filled(pixels: NDArray[np.intp], shape: tuple[int, ...]) -> Mask:
    """(h, w) the pixels or cells of these indices, the last of which stands for none, without gaps."""
    mask = np.zeros(shape[0] * shape[1] + 1, np.uint8)
    mask[pixels] = 1
    return np.asarray(cv2.morphologyEx(mask[:-1].reshape(shape), cv2.MORPH_CLOSE, CLOSING) > 0)
