"""Colours of HDR clips and photos, and of others with wide primaries, as those of any other picture: sRGB.

Rec. ITU-R BT.2100 has two ways to encode HDR, both with the wide primaries of BT.2020. HLG is made to be shown as it
is by a screen that knows no HDR, but for its primaries; PQ states nits, and becomes HLG as BT.2100 and BT.2408 bridge
the two, by a screen of 1000 nits. Computers, which record their own screens, have PQ with other primaries too. Cameras
that are set to Adobe RGB, of which no number of a clip tells, say so in the EXIF data of their photos.
"""

from collections.abc import Callable

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear

# FFmpeg's numbers, of ISO/IEC 23091-2.
BT709_PRIMARIES, UNSPECIFIED, BT2020_PRIMARIES, DISPLAY_P3_PRIMARIES = 1, 2, 9, 12
PQ_TRANSFER, HLG_TRANSFER = 16, 18

# Linear R, G, B of BT.709 from those of BT.2020: ITU-R BT.2407, 2.
RGB_709_FROM_2020: Float = np.array([
    [1.6605, -0.5876, -0.0728],
    [-0.1246, 1.1329, -0.0083],
    [-0.0182, -0.1006, 1.1187],
])  # fmt: skip
# From those of P3 with the white D65, by the chromaticities of SMPTE EG 432-1.
RGB_709_FROM_P3: Float = np.array([
    [1.2249, -0.2249, 0.0],
    [-0.0421, 1.0421, 0.0],
    [-0.0196, -0.0786, 1.0983],
])  # fmt: skip
# From those of Adobe RGB (1998), whose curve is a power: its Color Image Encoding of 2005, 4.3.1 and 4.3.4.
RGB_709_FROM_ADOBE: Float = np.array([
    [1.3984, -0.3984, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -0.0429, 1.0429],
])  # fmt: skip
ADOBE_GAMMA = 563 / 256
BY_PRIMARIES = {BT2020_PRIMARIES: RGB_709_FROM_2020, DISPLAY_P3_PRIMARIES: RGB_709_FROM_P3}

SCREEN_NITS = 1000.0
SYSTEM_GAMMA = 1.2  # of HLG on such a screen
SRGB_STEPS = 4096  # of the root of linear light


def srgb_converter(primaries: int, transfer: int) -> Callable[[Image], Image] | None:
    """Makes sRGB of a picture (h, w, 3) uint8 BGR with these colours; None where it is that already."""
    is_pq = transfer == PQ_TRANSFER
    if primaries == UNSPECIFIED and (is_pq or transfer == HLG_TRANSFER):
        primaries = BT2020_PRIMARIES  # BT.2100 has no others
    if primaries not in BY_PRIMARIES and not is_pq:
        return None
    coded = np.arange(256) / 255
    linear = linear_from_srgb(hlg_from_pq(coded) if is_pq else coded)
    return _converter(linear, BY_PRIMARIES.get(primaries, np.eye(3)))


def srgb_from_adobe_rgb() -> Callable[[Image], Image]:
    """As `srgb_converter`, of a picture in Adobe RGB."""
    return _converter((np.arange(256) / 255) ** ADOBE_GAMMA, RGB_709_FROM_ADOBE)


def _converter(linear: Float, rgb_709: Float) -> Callable[[Image], Image]:
    """Of pictures whose values stand for `linear` (256,) light of primaries that `rgb_709` (3, 3) makes BT.709's."""
    linear_table = linear.astype(np.float32)
    bgr_709 = np.ascontiguousarray(rgb_709[::-1, ::-1], dtype=np.float32)
    # By the root, of which equal steps are nearly as fine as sRGB's own; the table itself is sRGB's.
    encoded = np.round(255 * srgb_from_linear((np.arange(SRGB_STEPS) / (SRGB_STEPS - 1)) ** 2)).astype(np.uint8)

    def converted(image_bgr: Image) -> Image:
        wide = cv2.transform(cv2.LUT(image_bgr, linear_table), bgr_709)
        roots = np.sqrt(np.clip(wide, 0.0, 1.0, out=wide), out=wide)
        return encoded[np.rint(np.multiply(roots, SRGB_STEPS - 1, out=roots), out=roots).astype(np.uint16)]

    return converted


def hlg_from_pq(coded: Float) -> Float:
    """HLG's signal from that of PQ, both [0, 1] of any shape, where a screen of SCREEN_NITS shows the same.

    BT.2100: PQ's EOTF (table 4), HLG's inverse OOTF, of each channel by itself, and OETF (table 5).
    """
    root = coded ** (1 / 78.84375)
    nits = 10_000 * (np.maximum(root - 0.8359375, 0.0) / (18.8515625 - 18.6875 * root)) ** (1 / 0.1593017578125)
    scene = np.minimum(nits / SCREEN_NITS, 1.0) ** (1 / SYSTEM_GAMMA)
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    bright = a * np.log(np.maximum(12 * scene - b, 1e-9)) + c
    return np.where(scene <= 1 / 12, np.sqrt(3 * scene), bright)
