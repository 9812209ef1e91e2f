"""Copies patches of visible ground into a hole in its picture.

The hole is filled from the outside inwards by those patches that continue what is known already (Criminisi, Perez,
Toyama, "Region filling and object removal by exemplar-based image inpainting", IEEE Trans. Image Processing 2004):
chosen in a coarse picture, copied in the fine one.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask

PATCH = 15  # side of a patch, in coarse pixels
STEP = 7  # distance between the patches of the hole, which overlap, in coarse pixels
SHARPER = 4  # patches are blended by soft weights; their fine detail, by this power of them
STANDS_OUT = 3.0  # contrast over the ground's median beyond which detail is a line or a speck, and not texture
TINY = 1e-9  # smaller weights count as 0


def chosen_patches(
    coarse: Float32, shading: Float32, unknown: Mask, known: Mask, sources: Mask
) -> list[tuple[Float, Float]]:
    """Middles (row, column) of coarse patches to fill and of those to copy, in the order of filling.

    coarse: (m, m, 3) detail, from which the shading (m, m) was subtracted. Patches of the same shading are preferred:
    otherwise the inside of an object's shadow, whose detail is like the ground's, would be copied with a piece of its
    border. known: (m, m) where `coarse` shows the ground; in the unknown part, where lines were drawn.
    """
    reach = PATCH // 2
    usual = float(np.median(np.square(coarse[sources]).sum(axis=1)))
    standing_out = _standing_out(coarse, usual)
    picture, known, left = coarse.copy(), known.copy(), unknown.copy()
    found: list[tuple[Float, Float]] = []
    size = len(unknown)
    places = [
        (row, column)
        for row in range(reach, size - reach, STEP)
        for column in range(reach, size - reach, STEP)
        if unknown[_window(row, column)].any()
    ]
    while places and left.any():
        place = max(places, key=lambda each: known[_window(*each)].sum())
        places.remove(place)
        window = _window(*place)
        mask = known[window]
        if mask.any():
            masked = np.repeat(mask[..., None].astype(np.float32), 3, axis=2)
            misfit = cv2.matchTemplate(picture, picture[window], cv2.TM_SQDIFF, mask=masked)
            misfit += masked.sum() * np.square(shading[reach:-reach, reach:-reach] - shading[place])
            # A piece of a joint would be cut off at its ends: no more lines are copied than the known ground here has.
            brought = cv2.matchTemplate(standing_out, (~mask).astype(np.float32), cv2.TM_CCORR)
            misfit = misfit + np.maximum(brought - _standing_out(picture[window], usual)[mask].sum(), 0.0)
            misfit = np.where(sources[reach:-reach, reach:-reach], misfit, np.inf)
            at = np.unravel_index(int(np.argmin(misfit)), misfit.shape)
            source = (int(at[0]) + reach, int(at[1]) + reach)
        else:
            rows, columns = np.nonzero(sources)
            source = int(rows[len(rows) // 2]), int(columns[len(rows) // 2])
        new = ~mask
        picture[window][new] = coarse[_window(*source)][new]
        known[window] = True
        left[window] = False
        found.append((np.array(place, float), np.array(source, float)))
    return found


def _standing_out(detail: Float32, usual: float) -> Float32:
    """(m, m) excess of the squared detail (m, m, 3) over that of texture, whose median is `usual`: lines and specks."""
    return np.maximum(np.square(detail).sum(axis=2) - STANDS_OUT**2 * usual, 0.0).astype(np.float32)


def _window(row: int, column: int) -> tuple[slice, slice]:
    """A coarse patch by its middle."""
    reach = PATCH // 2
    return slice(row - reach, row + reach + 1), slice(column - reach, column + reach + 1)


class CopiedPatches:
    """Patches of a picture (n, n, 3), copied over one another.

    Coarse detail is blended softly, fine detail hardly at all (Burt, Adelson, "A multiresolution spline with
    application to image mosaics", ACM Trans. Graphics 1983): a mean of textures would be smoother than they are.
    """

    def __init__(self, picture: Float32, is_known: Mask, scale: float) -> None:
        """`is_known` (n, n): where patches must fit. `scale`: pixels of the picture for one coarse pixel."""
        self._picture, self._known, self._scale = picture, is_known.astype(np.float32), scale
        self._sum, self._sharp = np.zeros_like(picture), np.zeros_like(picture)
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
        share = np.outer(rows, columns).astype(np.float32)
        patch = region[at[0] : at[0] + size[0], at[1] : at[1] + size[1]]
        for sums, weights, each in (
            (self._sum, self._weight, share),
            (self._sharp, self._sharp_weight, share**SHARPER),
        ):
            sums[to] += each[..., None] * patch
            weights[to] += each

    def blended(self, band_px: float) -> Float32:
        """(n, n, 3) all patches blended; detail finer than `band_px` comes from hardly more than one at a place."""
        soft = self._mean((slice(None), slice(None)))
        sharp = self._sharp / np.maximum(self._sharp_weight, TINY)[..., None]
        finer = np.where(self._sharp_weight[..., None] > TINY, sharp - soft, 0)
        return np.asarray(soft + finer - cv2.GaussianBlur(finer, (0, 0), band_px), np.float32)

    def _mean(self, of: tuple[slice, slice]) -> Float32:
        return np.asarray(self._sum[of] / np.maximum(self._weight[of], TINY)[..., None], np.float32)
