"""How much light a shadow leaves on the ground: what the renderer multiplies the video by."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT

RING_SHARE = 0.03  # of the picture's width: how far around the shadow its lit ground is looked for
PENUMBRA_SHARE = 0.006  # of the picture's width: neither lit nor shadowed, left out on both sides
MIN_PIXELS = 50  # of shadow and of ground, for their colours to be compared


def shadow_rgb_ratio(image_bgr: Image, shadow: Mask, not_ground: Mask) -> Float | None:
    """(3,) linear RGB, shadowed over lit ground: the median inside `shadow` over that of a ring of ground around it.

    `image_bgr` (h, w, 3) sRGB; `shadow` and `not_ground` (object, marker) (h, w). None when one of the two has too
    few pixels or the ring is not the brighter one, as then it is not lit ground or the mask no shadow.
    """
    width = image_bgr.shape[1]
    gap, reach = (max(1, round(width * share)) for share in (PENUMBRA_SHARE, RING_SHARE))
    umbra = _grown(shadow, -gap) & ~not_ground
    ring = _grown(shadow, gap + reach) & ~_grown(shadow, gap) & ~_grown(not_ground, gap)
    if min(np.count_nonzero(umbra), np.count_nonzero(ring)) < MIN_PIXELS:
        return None
    dark, lit = (LINEAR_FROM_SRGB_8BIT[np.median(image_bgr[mask], axis=0).astype(np.uint8)] for mask in (umbra, ring))
    if (lit <= 0).any() or (dark >= lit).all():
        return None
    ratio_bgr = np.clip(dark / lit, 1e-3, 1.0)
    return np.asarray(ratio_bgr[::-1].copy())


def _grown(mask: Mask, by_px: int) -> Mask:
    """The mask dilated by `by_px`, or eroded when that is negative."""
    side = 2 * abs(by_px) + 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))
    change = cv2.dilate if by_px > 0 else cv2.erode
    return np.asarray(change(mask.astype(np.uint8), kernel)) > 0
