"""Seams where two shadows meet: lines that are darker or brighter than the ground on both sides."""

import cv2
import numpy as np

from ashe_live.core.arrays import Image, Mask

LEVELS = 10  # of 255, by which a seam differs from both sides
ASIDE_PX = 3
STRAY_PX = 2  # distance within which a similar line in the photo, of joints or noise, excuses one


def seam_pixels(picture: Image, photos: tuple[Image, ...], where: Mask) -> int:
    """How many pixels of `where` (h, w) are a seam in the picture, but in none of the photos (h, w, 3) of the place."""
    kernel = np.ones((2 * STRAY_PX + 1,) * 2, np.uint8)
    seen = np.logical_or.reduce([_lines(photo, LEVELS / 2) for photo in photos])
    known = cv2.dilate(seen.astype(np.uint8), kernel) > 0
    return int((_lines(picture, LEVELS) & ~known & where).sum())


def _lines(image: Image, levels: float) -> Mask:
    grey = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), (3, 3), 0).astype(np.float32)
    found = np.zeros(grey.shape, bool)
    for across, down in ((ASIDE_PX, 0), (0, ASIDE_PX), (ASIDE_PX - 1, ASIDE_PX - 1), (ASIDE_PX - 1, 1 - ASIDE_PX)):
        sides = [
            cv2.warpAffine(
                grey, np.array([[1.0, 0.0, sign * across], [0.0, 1.0, sign * down]]), grey.shape[::-1],
                borderMode=cv2.BORDER_REPLICATE,
            )
            for sign in (-1, 1)
        ]  # fmt: skip
        found |= (grey > np.maximum(*sides) + levels) | (grey < np.minimum(*sides) - levels)
    return found
