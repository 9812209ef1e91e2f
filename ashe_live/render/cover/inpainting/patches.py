"""Copies patches of visible ground into a hole in its picture.

The hole is filled from the outside inwards by those patches that continue what is known already (Criminisi, Perez,
Toyama, "Region filling and object removal by exemplar-based image inpainting", IEEE Trans. Image Processing 2004):
chosen in a coarse picture, copied in the fine one.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.render.cover.inpainting.masked import Box, blurred_within, box_around, distances_from

PATCH = 15  # side of a patch, in coarse pixels
STEP = 7  # distance between the patches of the hole, which overlap, in coarse pixels
SHARPER = 4  # gradients of overlapping patches are blended by this power of their soft weights
STANDS_OUT = 3.0  # contrast over the ground's median beyond which detail is a line or a speck, and not texture
LEAST_SHARE = 1e-3  # weight of a patch at its border, where it may be the only one
TINY = 1e-20  # smaller weights count as 0


@dataclass(frozen=True, slots=True, eq=False)
class CoarseGround:
    """The ground at the resolution at which patches are chosen."""

    detail: Float32  # (m, m, 3) without the shading
    shading: Float32  # (m, m)
    outstanding: Float32  # (m, m) means of `standing_out` of the fine picture
    unknown: Mask  # (m, m) what is filled
    known: Mask  # (m, m) where `detail` is the ground's
    sources: Mask  # (m, m) middles of patches that may be copied


def chosen_patches(coarse: CoarseGround) -> list[tuple[Float, Float]]:
    """Middles (row, column) of coarse patches to fill and of those to copy, in the order of filling."""
    picture, outstanding = coarse.detail.copy(), coarse.outstanding.copy()
    known, left = coarse.known.copy(), coarse.unknown.copy()
    found: list[tuple[Float, Float]] = []
    reach, size = PATCH // 2, len(left)
    places = [
        (row, column)
        for row in range(reach, size - reach, STEP)
        for column in range(reach, size - reach, STEP)
        if left[_window(row, column)].any()
    ]
    while places and left.any():
        place = max(places, key=lambda each: known[_window(*each)].sum())
        places.remove(place)
        window = _window(*place)
        is_new = ~known[window]
        if is_new.all():
            rows, columns = np.nonzero(coarse.sources)
            source = int(rows[len(rows) // 2]), int(columns[len(rows) // 2])
        else:
            source = _best_source(coarse, place, picture, known[window], outstanding[window])
        for copy, original in ((picture, coarse.detail), (outstanding, coarse.outstanding)):
            copy[window][is_new] = original[_window(*source)][is_new]
        known[window] = True
        left[window] = False
        found.append((np.array(place, float), np.array(source, float)))
    return found


def _best_source(
    coarse: CoarseGround, place: tuple[int, int], picture: Float32, is_known: Mask, outstanding: Float32
) -> tuple[int, int]:
    """The middle of the patch that continues the known part (PATCH, PATCH) of the patch at `place` best.

    picture: (m, m, 3) with the patches so far. outstanding: (PATCH, PATCH) of the patch.
    """
    inner = slice(PATCH // 2, -(PATCH // 2))
    mask = np.repeat(is_known[..., None].astype(np.float32), 3, axis=2)
    misfit = cv2.matchTemplate(picture, picture[_window(*place)], cv2.TM_SQDIFF, mask=mask)
    # Otherwise the inside of an object's shadow, whose detail is like the ground's, would be copied with a piece of its
    # border.
    misfit += mask.sum() * np.square(coarse.shading[inner, inner] - coarse.shading[place])
    # A piece of a joint would be cut off at its ends: no more lines are copied than the known ground here has.
    brought = cv2.matchTemplate(coarse.outstanding, (~is_known).astype(np.float32), cv2.TM_CCORR)
    misfit = misfit + np.maximum(brought - outstanding[is_known].sum(), 0.0)
    misfit = np.where(coarse.sources[inner, inner], misfit, np.inf)
    row, column = np.unravel_index(int(np.argmin(misfit)), misfit.shape)
    return int(row) + PATCH // 2, int(column) + PATCH // 2


def standing_out(detail: Float32, is_ground: Mask) -> Float32:
    """(n, n) excess of the squared detail (n, n, 3) of visible ground over that of texture: lines and specks."""
    squares = np.square(detail).sum(axis=2)
    usual = float(np.median(squares[is_ground]))
    return np.where(is_ground, np.maximum(squares - STANDS_OUT**2 * usual, 0.0), 0.0).astype(np.float32)


def _window(row: int, column: int) -> Box:
    """A coarse patch by its middle."""
    reach = PATCH // 2
    return slice(row - reach, row + reach + 1), slice(column - reach, column + reach + 1)


class CopiedPatches:
    """Patches of a picture (n, n, 3), copied over one another and beside known ground, without seams between them.

    Their gradients are blended by sharp weights, as a mean of textures would be smoother than they are, and the picture
    with these gradients is found whose coarse shape is that of softly blended patches (Perez, Gangnet, Blake, "Poisson
    image editing", SIGGRAPH 2003; screened as in Bhat, Curless, Cohen, Zitnick, "Fourier analysis of the 2D screened
    Poisson equation for gradient domain problems", ECCV 2008).
    """

    def __init__(self, picture: Float32, is_known: Mask, scale: float) -> None:
        """`is_known` (n, n): where patches must fit. `scale`: pixels of the picture for one coarse pixel."""
        self._picture, self._known, self._scale = picture, is_known.astype(np.float32), scale
        self._gradients = _gradients(picture)
        self._sum, self._gradient_sum = np.zeros_like(picture), np.zeros_like(self._gradients)
        self._weight, self._sharp_weight = np.zeros(is_known.shape, np.float32), np.zeros(is_known.shape, np.float32)

    @property
    def is_there(self) -> Mask:
        """(n, n) where something was copied to."""
        return self._weight > 0

    def paste(self, place: Float, source: Float) -> None:
        """Adds the patch about `source` at `place` (row, column; coarse), moved to where it fits best."""
        n, reach, play = len(self._weight), round(PATCH / 2 * self._scale), round(self._scale)
        middle, origin = (np.round((each + 0.5) * self._scale).astype(int) for each in (place, source))
        low, high = np.maximum(middle - reach, 0), np.minimum(middle + reach, n)
        to = (slice(low[0], high[0]), slice(low[1], high[1]))
        begin = np.maximum(origin - (middle - low) - play, 0)
        end = np.minimum(origin + (high - middle) + play, n)
        region, size = self._picture[begin[0] : end[0], begin[1] : end[1]], high - low
        if (np.array(region.shape[:2]) < size).any():
            return
        there = np.where(self.is_there[to][..., None], self._mean(to), self._picture[to])
        mask = np.maximum(self.is_there[to].astype(np.float32), self._known[to])
        at = origin - (middle - low) - begin
        if mask.any():
            misfit = cv2.matchTemplate(region, there, cv2.TM_SQDIFF, mask=np.repeat(mask[..., None], 3, axis=2))
            at = np.array(np.unravel_index(int(np.argmin(misfit)), misfit.shape))
        rows, columns = (
            np.cos((np.arange(low[k], high[k]) - middle[k] + 0.5) / reach * (np.pi / 2) * 0.98) ** 4 for k in (0, 1)
        )
        share = np.maximum(np.outer(rows, columns), LEAST_SHARE).astype(np.float32)
        first = begin + at
        copied = (slice(first[0], first[0] + size[0]), slice(first[1], first[1] + size[1]))
        for sums, weights, each, values in (
            (self._sum, self._weight, share, self._picture),
            (self._gradient_sum, self._sharp_weight, share**SHARPER, self._gradients),
        ):
            sums[to] += each[..., None] * values[copied]
            weights[to] += each

    def keep(self, where: Mask) -> None:
        """Keeps the picture itself where (n, n), as far as it also has its neighbours there, in place of patches."""
        within = cv2.erode(where.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        self._sum[within], self._gradient_sum[within] = self._picture[within], self._gradients[within]
        self._weight[within] = self._sharp_weight[within] = 1

    def blended(self, hole: Mask, coarser_px: float) -> Float32:
        """(n, n, 3) the picture with patches in the hole (n, n). Detail coarser than `coarser_px` is blended softly."""
        window = box_around(hole, round(4 * coarser_px))
        inside = hole[window]
        soft = np.where(inside[..., None], self._mean(window), self._picture[window])
        sharp = self._gradient_sum[window] / np.maximum(self._sharp_weight[window], TINY)[..., None]
        # Also those of ground beside the hole, whose neighbour lies in it.
        beside = cv2.dilate(inside.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        found, ground = self._picture.copy(), self._picture[window]
        there = _with_gradients(soft, np.where(beside[..., None], sharp, self._gradients[window]), coarser_px)
        # Gradients that do not meet moved the ground beside the hole as well; but that is shown as it was.
        rim = cv2.dilate(inside.astype(np.uint8), np.ones((5, 5), np.uint8)) * self._known[window] * ~inside
        found[window] = there + _carried_in(ground - there, rim, inside, 2 * coarser_px)
        return found

    def _mean(self, of: Box) -> Float32:
        return np.asarray(self._sum[of] / np.maximum(self._weight[of], TINY)[..., None], np.float32)


def _gradients(picture: Float32) -> Float32:
    """(h, w, 6) the differences of each pixel of a picture (h, w, 3) from its left and from its upper neighbour."""
    return np.concatenate(
        [np.diff(picture, axis=axis, prepend=picture.take([0], axis=axis)) for axis in (1, 0)], axis=2
    )


def _carried_in(difference: Float32, rim: Float32, hole: Mask, reach_px: float) -> Float32:
    """(h, w, 3) in the hole (h, w) the difference (h, w, 3) beside it, where `rim` (h, w) is 1.

    Within reach_px of the rim it fades, and becomes a mean over twice the distance from there.
    """
    away = distances_from(~hole)
    carried = np.zeros_like(difference)
    for octave in range(math.ceil(math.log2(max(reach_px, 2.0))) + 1):
        share = np.clip(1 - np.abs(np.log2(np.maximum(away, 1.0)) - octave), 0, 1) * np.clip(1 - away / reach_px, 0, 1)
        carried += share[..., None] * blurred_within(difference, rim, 0.5 * 2.0**octave)
    return np.where(hole[..., None], carried, 0).astype(np.float32)


def _with_gradients(soft: Float32, gradients: Float32, coarser_px: float) -> Float32:
    """(h, w, 3) the picture that has the gradients (h, w, 6) in fine detail, and in coarse is like `soft` (h, w, 3).

    It minimises the squares of the gradients' errors and, over coarser_px², of its differences from `soft`, by cosine
    transforms.
    """
    across, down = gradients[..., :3].copy(), gradients[..., 3:].copy()
    across[:, 0], down[0] = 0, 0
    padded = [(0, size % 2) for size in soft.shape[:2]]
    screen = 1 / coarser_px**2
    right = screen * soft - np.diff(across, axis=1, append=0) - np.diff(down, axis=0, append=0)
    height, width = (size + more for size, (_, more) in zip(soft.shape, padded, strict=False))
    y, x = (2 - 2 * np.cos(np.pi * np.arange(size) / size) for size in (height, width))
    stiffness = (screen + y[:, None] + x).astype(np.float32)
    found = [
        cv2.idct(cv2.dct(np.pad(right[..., k], padded, mode="edge")) / stiffness)[: soft.shape[0], : soft.shape[1]]
        for k in range(3)
    ]
    return np.dstack(found)
